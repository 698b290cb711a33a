"""What is shown next: a deterministic function of study, stimuli, assignment and answers."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from algorithms.errors import InputError
from experiments.designs import (
    Shown,
    arrange,
    block_order,
    catch_comparisons,
    drawn_subset,
    in_blocks,
    ordered,
)
from experiments.study import Study, chosen
from stimuli.manifest import StimulusSet

Phase = Literal["practice", "main", "catch"]
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
        `practice` trials are never analysed; `catch` trials stand among the main ones, and only
        tell who pays attention.
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
    number = assignment.participant_number
    generator = np.random.default_rng([study.design.seed, number])
    practice = arrange(study, chosen(study, stimuli, "practice"))[: study.practice.trials]
    main = _main(study, stimuli, number, generator)
    caught = catch_comparisons(study, stimuli, generator)
    shown: list[tuple[Phase, Shown]] = [("main", together) for together in main]
    for together in caught:
        shown.insert(int(generator.integers(len(shown) + 1)), ("catch", together))
    shown = [*(("practice", together) for together in practice), *shown]
    return tuple(
        Trial(index, phase, together, phase == "practice" and study.practice.feedback)
        for index, (phase, together) in enumerate(shown)
    )


def _main(
    study: Study, stimuli: StimulusSet, number: int, generator: np.random.Generator
) -> list[Shown]:
    main, design = chosen(study, stimuli, "main"), study.design
    if design.one_of_each is not None:
        main = drawn_subset(design, main, generator)
    if design.blocks is None:
        return ordered(arrange(study, main), design.repeats, generator)
    blocks = in_blocks(design.blocks, main)
    order: list[Shown] = []
    for block in block_order(len(blocks), number):
        order += ordered(arrange(study, blocks[block]), design.repeats, generator, order)
    return order


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
