"""What is shown next: a deterministic function of study, stimuli, assignment and answers."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from algorithms.errors import InputError
from experiments.study import Study
from stimuli.manifest import StimulusSet

Phase = Literal["practice", "main"]
Answer = int | None


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
        The ids of the stimuli in the order shown; a single one for odd-one-out.
    feedback
        Whether the right answer is told afterwards.
    """

    index: int
    phase: Phase
    stimuli: tuple[str, ...]
    feedback: bool = False


def planned_trials(study: Study, stimuli: StimulusSet, assignment: Assignment) -> tuple[Trial, ...]:
    """Return the whole list of a fixed design, practice first.

    The practice trials are the same for everybody and in the set's order; the main ones are
    shuffled by the study's seed and the participant's number.
    """
    generator = np.random.default_rng([study.design.seed, assignment.participant_number])
    practice = [stimulus.id for stimulus in stimuli.with_role("practice")][: study.practice.trials]
    main = [stimulus.id for stimulus in stimuli.with_role("main")]
    order = _repeated_orders(main, study.design.repeats, generator)
    shown: list[tuple[Phase, str]] = [
        *(("practice", identifier) for identifier in practice),
        *(("main", identifier) for identifier in order),
    ]
    return tuple(
        Trial(index, phase, (identifier,), phase == "practice" and study.practice.feedback)
        for index, (phase, identifier) in enumerate(shown)
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


def _repeated_orders(
    identifiers: list[str], repeats: int, generator: np.random.Generator
) -> list[str]:
    """Shuffle each round on its own; no image follows itself across the border of two rounds."""
    order: list[str] = []
    for _ in range(repeats):
        round_ = [identifiers[i] for i in generator.permutation(len(identifiers))]
        if order and len(round_) > 1 and round_[0] == order[-1]:
            other = int(generator.integers(1, len(round_)))
            round_[0], round_[other] = round_[other], round_[0]
        order.extend(round_)
    return order
