"""One presentation of a study, what is answered to it, and what a session is told beforehand."""

from dataclasses import dataclass
from typing import Literal

from algorithms.errors import InputError

Phase = Literal["practice", "main", "catch"]
Pool = tuple[tuple[str, str, int], ...]
Answer = int | tuple[int, ...] | None
"""By task: the label of the chosen region (odd-one-out), the place of the chosen image from 1
(two-alternative), 1 for yes and 0 for no (yes-no), the rank of each image in the order shown, 1 for
the best (ranking), the labels of the chosen regions from the smallest on (pick); None where the
time limit passed, and where nothing is asked (free-viewing)."""


@dataclass(frozen=True)
class Assignment:
    """What distinguishes one participant's run of a study from another's.

    Attributes
    ----------
    participant_number
        1 or more; with the study's seed it fixes the order of the trials.
    pool
        Of `active-pairs`: what others had answered when the session began, as the ids of the
        better and the worse image, and how often; each pair in either direction once.
    """

    participant_number: int
    pool: Pool = ()

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
