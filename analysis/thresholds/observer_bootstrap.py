"""A threshold by maximum likelihood with its interval from resampled observers."""

from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, expanded_percentiles, resample
from analysis.estimates import INSIDE, Estimate, seed_of, software_version
from analysis.thresholds.counts import count_rows
from analysis.thresholds.maximum_likelihood import METHOD, LikelihoodFits, maximum_likelihood
from analysis.thresholds.sigmoid import Floats, check_share
from analysis.thresholds.stated_threshold import StatedThreshold, place

BOOTSTRAP = "expanded percentile bootstrap over observers"


@dataclass(frozen=True)
class ObserverFit:
    """A psychometric function of several observers, each as often as they answered.

    Attributes
    ----------
    threshold, width, slope, lapse_rate
        As in `analysis.ThresholdFit`, with 95 % intervals over observers.
    guess_rate
        The share of right answers by chance: fixed by the task.
    correct_at_threshold
        The share of right answers at the threshold.
    reached
        Whether the threshold lies `within` the levels tested, `above` or `below` them.
    levels, correct, total
        What was fitted, one entry a level.
    participants, n
        How many observers gave how many answers.
    resamples, seed
        Of the bootstrap and its generator.
    definition, method, version
        What is meant by threshold here, how it was computed, and by which Trompe.
    fit, drawn
        The fit and those of the resamples: what other results are computed from; in no table.
    """

    threshold: Estimate
    width: Estimate
    slope: Estimate
    lapse_rate: Estimate
    guess_rate: float
    correct_at_threshold: float
    reached: str
    levels: tuple[float, ...]
    correct: tuple[int, ...]
    total: tuple[int, ...]
    participants: int
    n: int
    resamples: int
    seed: int | None
    definition: str = "mid-point of a psychometric function"
    method: str = f"{METHOD}; {BOOTSTRAP}"
    version: str = ""
    fit: LikelihoodFits | None = field(default=None, repr=False, compare=False, metadata=INSIDE)
    drawn: LikelihoodFits | None = field(default=None, repr=False, compare=False, metadata=INSIDE)

    def threshold_at(self, correct: float) -> StatedThreshold:
        """Return the level at which a stated share of the answers is right.

        Parameters
        ----------
        correct
            The share, above the guess rate and below 1: 0.75 for 75 %.

        Raises
        ------
        InputError
            If the share is impossible, or the result has lost its resamples.
        """
        check_share(correct, self.guess_rate)
        if self.fit is None or self.drawn is None:
            raise InputError("threshold_at: a fit as `fit_observers` returns it accepted")
        value, reached = place(float(self.fit.thresholds_at(correct)[0]), self.levels)
        low, high = interval_of(self.drawn.thresholds_at(correct), self.participants)
        return StatedThreshold(
            Estimate(value, low, high),
            correct,
            reached,
            self.guess_rate,
            self.n,
            self.method,
            self.version,
        )

    def to_frame(self) -> pd.DataFrame:
        """Return one row: the estimates with their intervals, and what they mean."""
        row: dict[str, object] = {}
        for name, value in vars(self).items():
            if isinstance(value, Estimate):
                row |= value.columns(name)
            elif isinstance(value, float | int | str):
                row[name] = value
        return pd.DataFrame([row])


def fit_observers(
    levels: ArrayLike,
    correct: ArrayLike,
    total: ArrayLike,
    guess_rate: float,
    generator: np.random.Generator,
    resamples: int = RESAMPLES,
) -> ObserverFit:
    """Fit one psychometric function to several observers, with intervals over them.

    Parameters
    ----------
    levels
        Different levels in rising order, shape (l,), two or more.
    correct, total
        Right answers and all answers, shape (observers, l); two observers or more.
    guess_rate
        The share of right answers by chance, 0 to 0.5.
    generator
        Draws the observers.
    resamples
        How many times.

    Raises
    ------
    InputError
        If shapes, counts or rates are impossible.

    Notes
    -----
    The sums over observers are fitted (`analysis.maximum_likelihood`), and again for observers
    drawn with replacement. The interval is expanded for few observers
    (`analysis.bootstrap.expanded_percentiles`); a resample whose threshold lies beyond the levels
    counts as infinite, so that an end of the interval may be.
    """
    at, right, answers = count_rows(levels, correct, total, guess_rate, "participant")
    observers = check_observers(answers)
    chosen = resample(observers, generator, resamples)
    right_sums, sums = right.sum(axis=0), answers.sum(axis=0)
    fit = maximum_likelihood(at, right_sums[None], sums[None], guess_rate)
    drawn = maximum_likelihood(at, chosen @ right, chosen @ answers, guess_rate)

    def estimate(name: str) -> Estimate:
        value = float(getattr(fit, name)[0])
        return Estimate(value, *interval_of(getattr(drawn, name), observers))

    threshold = estimate("threshold")
    return ObserverFit(
        threshold=threshold,
        width=estimate("width"),
        slope=estimate("slope"),
        lapse_rate=estimate("lapse_rate"),
        guess_rate=guess_rate,
        correct_at_threshold=(1 + guess_rate - float(fit.lapse_rate[0])) / 2,
        reached=place(threshold.value, tuple(at))[1],
        levels=tuple(at.tolist()),
        correct=tuple(right_sums.astype(int).tolist()),
        total=tuple(sums.astype(int).tolist()),
        participants=observers,
        n=int(sums.sum()),
        resamples=resamples,
        seed=seed_of(generator),
        version=software_version(),
        fit=fit,
        drawn=drawn,
    )


def check_observers(
    total: Floats, name: str = "correct, total", *, every_level: bool = True
) -> int:
    """Return the number of observers, refusing fewer than two and levels without an answer.

    Without `every_level` answers at two levels are enough.
    """
    if len(total) < 2:
        raise InputError(f"{name}: {len(total)} participants given, two or more accepted")
    answered = total.sum(axis=0) > 0
    if every_level and not answered.all():
        raise InputError(f"{name}: a level without any answer given, levels with answers accepted")
    if answered.sum() < 2:
        raise InputError(f"{name}: answers at {answered.sum()} level given, two or more accepted")
    return len(total)


def interval_of(drawn: Floats, participants: float) -> tuple[float, float]:
    """Return the ends of the expanded percentile interval of resampled values.

    Parameters
    ----------
    drawn
        Shape (resamples,); infinite values count as such, and NaN, of which nothing is known, as
        whatever makes the interval wider.
    participants
        How many were resampled; more than one.
    """
    low, high = expanded_percentiles(participants)
    unknown = np.isnan(drawn)
    below, above = np.where(unknown, -np.inf, drawn), np.where(unknown, np.inf, drawn)
    return (
        float(np.percentile(below, low, method="inverted_cdf")),
        float(np.percentile(above, high, method="inverted_cdf")),
    )
