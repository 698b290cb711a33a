"""Simulated observers of comparisons: each item has a quality, and is seen with noise."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.special import ndtri

from algorithms.errors import InputError
from experiments.planning.presentations import Answer
from experiments.study import Study

NOISE_OF_A_DIFFERENCE: Final = float(1 / ndtri(0.75))
"""Standard deviation of the difference of two perceived qualities, in just-objectionable
differences: at one of them 75 % prefer the better item."""


@dataclass(frozen=True)
class ItemObserver:
    """An observer who perceives the quality of every item anew in each trial.

    Perceived qualities are normal around the item's own, independent and of equal spread
    (Thurstone's case V); the better of two is chosen, several are ranked, and one by itself is
    judged real if it is perceived above a criterion.

    Attributes
    ----------
    qualities
        By item, in just-objectionable differences (JOD).
    spread
        The standard deviation, in JOD, of participants' own qualities around these; 0 or more.
    position_bias
        What the first place, left in a pair, adds to an item's quality, in JOD.
    criterion
        The perceived quality from which an image is called real, in JOD.
    lapse_rate
        The share of answers that are pure guesses, 0 to 1.
    fatigue
        By how much that grows over a hundred trials, 0 or more.
    median_time_s, time_spread
        Of an answer, and the standard deviation of its logarithm.

    Raises
    ------
    InputError
        If one of them is out of its range.

    References
    ----------
    Thurstone 1927, Psychological Review 34; the unit as by Perez-Ortiz and Mantiuk 2017.
    """

    qualities: Mapping[str, float]
    spread: float = 0.0
    position_bias: float = 0.0
    criterion: float = 0.0
    lapse_rate: float = 0.02
    fatigue: float = 0.0
    median_time_s: float = 4.0
    time_spread: float = 0.5

    def __post_init__(self) -> None:
        for name, low, high in (
            ("spread", 0.0, np.inf),
            ("lapse_rate", 0.0, 1.0),
            ("fatigue", 0.0, np.inf),
            ("time_spread", 0.0, np.inf),
        ):
            if not low <= getattr(self, name) <= high:
                raise InputError(
                    f"{name}: {getattr(self, name)} given, {low:g} to {high:g} accepted"
                )
        if not self.median_time_s > 0:
            raise InputError(f"median_time_s: {self.median_time_s} given, more than 0 accepted")

    def participant(self, generator: np.random.Generator) -> "ItemObserver":
        """Return one participant, whose qualities are drawn around the common ones."""
        return replace(
            self,
            qualities={
                item: quality + self.spread * float(generator.normal())
                for item, quality in self.qualities.items()
            },
        )

    def after(self, trials: int) -> "ItemObserver":
        """Return the observer as they are after so many trials."""
        if self.fatigue == 0:
            return self
        return replace(self, lapse_rate=min(self.lapse_rate + self.fatigue * trials / 100, 1.0))

    def answer(
        self, study: Study, items: Sequence[str], generator: np.random.Generator
    ) -> tuple[Answer, float]:
        """Return the answer to a trial and the time in seconds that it took.

        Parameters
        ----------
        study
            Its task: `two-alternative`, `ranking` or `yes-no`.
        items
            What is shown, in its places.
        generator
            Where chance comes from.

        Raises
        ------
        InputError
            If the study's task is none of these, or an item has no quality.
        """
        if study.task not in _ANSWERS:
            raise InputError(f"task: {study.task} given, {', '.join(_ANSWERS)} accepted")
        missing = [item for item in items if item not in self.qualities]
        if missing:
            raise InputError(f"qualities: none is given for {study.stimuli.item} {missing[0]!r}")
        noise = generator.normal(0, NOISE_OF_A_DIFFERENCE / np.sqrt(2), len(items))
        guess = generator.normal(size=len(items))
        perceived = np.array([self.qualities[item] for item in items]) + noise
        perceived[0] += self.position_bias if len(items) > 1 else 0.0
        if generator.random() < self.lapse_rate:
            perceived = self.criterion + guess
        time_s = self.median_time_s * float(generator.lognormal(0, self.time_spread))
        return _ANSWERS[study.task](self, perceived), time_s

    def describe(self) -> str:
        """Return the observer's parameters in one line, as the answers' `device` keeps them."""
        qualities = ", ".join(f"{item} {quality:g}" for item, quality in self.qualities.items())
        tired = f"; fatigue {self.fatigue:g}" if self.fatigue else ""
        return (
            f"simulated observer: qualities in JOD {qualities}; spread {self.spread:g}; position"
            f" bias {self.position_bias:g}; lapse rate {self.lapse_rate:g}{tired}"
        )


def _choose(_: ItemObserver, perceived: np.ndarray) -> Answer:
    return int(np.argmax(perceived)) + 1


def _rank(_: ItemObserver, perceived: np.ndarray) -> Answer:
    ranks = np.argsort(np.argsort(-perceived)) + 1
    return tuple(int(rank) for rank in ranks)


def _judge(observer: ItemObserver, perceived: np.ndarray) -> Answer:
    return int(perceived[0] > observer.criterion)


_ANSWERS: Mapping[str, Callable[[ItemObserver, np.ndarray], Answer]] = {
    "two-alternative": _choose,
    "ranking": _rank,
    "yes-no": _judge,
}
