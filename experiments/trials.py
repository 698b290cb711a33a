"""What is shown next: a deterministic function of study, stimuli, assignment and answers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

import numpy as np

from algorithms.errors import InputError
from experiments.study import Study
from stimuli.manifest import Factor, Stimulus, StimulusSet

Phase = Literal["practice", "main"]
Shown = tuple[str, ...]
"""The ids of the images that are shown at once, in their places."""
Answer = int | tuple[int, ...] | None
"""By task: the label of the chosen region (odd-one-out), the place of the chosen image from 1
(two-alternative), 1 for yes and 0 for no (yes-no), the rank of each image in the order shown, 1 for
the best (ranking); None where the time limit passed."""


@dataclass(frozen=True)
class Assignment:
    """What distinguishes one participant's run of a study from another's.

    Attributes
    ----------
    participant_number
        1 or more; with the study's seed it fixes the order of the trials.
    """

    participant_number: int

    def __post_init__(self) -> None:
        if self.participant_number < 1:
            raise InputError(
                f"participant_number: {self.participant_number} given, 1 or more accepted"
            )


@dataclass(frozen=True)
class Trial:
    """One presentation.

    Attributes
    ----------
    index
        Its place in the session, from 0.
    phase
        `practice` trials are never analysed.
    stimuli
        The ids of the stimuli in the order shown: one, two for two-alternative (left, right), or
        all that are to be ranked.
    feedback
        Whether the right answer is told afterwards.
    """

    index: int
    phase: Phase
    stimuli: tuple[str, ...]
    feedback: bool = False


def planned_trials(study: Study, stimuli: StimulusSet, assignment: Assignment) -> tuple[Trial, ...]:
    """Return the whole list of a fixed design, practice first.

    Practice presents the first of the set's practice stimuli, the same for everybody; the main
    trials are drawn by the study's seed and the participant's number.
    """
    generator = np.random.default_rng([study.design.seed, assignment.participant_number])
    arrange = {"factorial": _single, "pairs": _pairs, "sets": _sets}[study.design.kind]
    practice = arrange(study, stimuli.with_role("practice"))[: study.practice.trials]
    main = ordered(arrange(study, stimuli.with_role("main")), study.design.repeats, generator)
    shown: list[tuple[Phase, Shown]] = [
        *(("practice", together) for together in practice),
        *(("main", together) for together in main),
    ]
    return tuple(
        Trial(index, phase, together, phase == "practice" and study.practice.feedback)
        for index, (phase, together) in enumerate(shown)
    )


def next_trial(
    study: Study,
    stimuli: StimulusSet,
    assignment: Assignment,
    answers_so_far: Mapping[int, Answer],
) -> Trial | None:
    """Return the trial to present now, or None when the session is complete.

    Parameters
    ----------
    study, stimuli, assignment
        What fixes the design.
    answers_so_far
        The stored answers by trial index; a trial with an answer is never shown again.
    """
    for trial in planned_trials(study, stimuli, assignment):
        if trial.index not in answers_so_far:
            return trial
    return None


def comparisons(
    study: Study, stimuli: Sequence[Stimulus]
) -> dict[tuple[Factor, ...], dict[str, Stimulus]]:
    """Group stimuli by the factors that are equal within a comparison.

    Returns
    -------
    By the levels of `stimuli.within`, the stimuli by the level of `stimuli.item`, as text.

    Raises
    ------
    InputError
        If two stimuli of a group are of the same item.
    """
    item, groups = study.stimuli.item, dict[tuple[Factor, ...], dict[str, Stimulus]]()
    assert item is not None
    for stimulus in stimuli:
        group = groups.setdefault(tuple(stimulus.factors[n] for n in study.stimuli.within), {})
        name = str(stimulus.factors[item])
        if name in group:
            raise InputError(
                f"stimuli.within: {stimulus.id!r} and {group[name].id!r} are both {item} {name}"
                " of one comparison; name the factor in which they differ"
            )
        group[name] = stimulus
    return groups


def _single(_: Study, stimuli: Sequence[Stimulus]) -> list[Shown]:
    return [(stimulus.id,) for stimulus in stimuli]


def _pairs(study: Study, stimuli: Sequence[Stimulus]) -> list[Shown]:
    return [
        (first.id, second.id)
        for group in comparisons(study, stimuli).values()
        for first, second in combinations(group.values(), 2)
    ]


def _sets(study: Study, stimuli: Sequence[Stimulus]) -> list[Shown]:
    return [
        tuple(stimulus.id for stimulus in group.values())
        for group in comparisons(study, stimuli).values()
    ]


def ordered(shown: Sequence[Shown], repeats: int, generator: np.random.Generator) -> list[Shown]:
    """Return presentations in random order and with random places, balanced over them.

    Parameters
    ----------
    shown
        The images of each presentation.
    repeats
        Rounds; each is shuffled on its own.
    generator
        Where chance comes from.

    Returns
    -------
    In each round half of the pairs (or one more) are turned around, in the next round the other
    half; sets of more images are shuffled. No image follows itself where another presentation is
    left; what is left at the end of a round may leave no choice.
    """
    order: list[Shown] = []
    turned = np.arange(len(shown)) % 2 == 1
    if any(len(together) == 2 for together in shown):
        turned = generator.permutation(turned)
    for _ in range(repeats):
        left = [
            _placed(together, bool(turn), generator)
            for together, turn in zip(shown, turned, strict=True)
        ]
        left = [left[i] for i in generator.permutation(len(left))]
        while left:
            fresh = (n for n, each in enumerate(left) if not order or not {*each} & {*order[-1]})
            order.append(left.pop(next(fresh, 0)))
        turned = ~turned
    return order


def _placed(together: Shown, turned: bool, generator: np.random.Generator) -> Shown:
    if len(together) <= 2:
        return together[::-1] if turned else together
    return tuple(together[i] for i in generator.permutation(len(together)))
