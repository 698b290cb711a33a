"""The difference of two conditions' thresholds: over the same people, other people, or answers."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, expanded_p_value, resample
from analysis.estimates import Estimate, seed_of, software_version
from analysis.thresholds.bayesian_fit import ThresholdFit
from analysis.thresholds.counts import count_rows
from analysis.thresholds.maximum_likelihood import METHOD, maximum_likelihood
from analysis.thresholds.observer_bootstrap import BOOTSTRAP, check_observers, interval_of
from analysis.thresholds.sigmoid import Floats, check_share

POSTERIOR_TEST = "twice the smaller tail of the posterior"
BOOTSTRAP_TEST = "the confidence at which the interval would just reach 0"


@dataclass(frozen=True)
class ThresholdDifference:
    """How far one threshold lies above another.

    Attributes
    ----------
    difference
        First minus second, in the unit of the levels, with its 95 % interval; all NaN where one
        of the two lies beyond the levels tested, an end infinite where the answers set none.
    p_value, test
        Of no difference, two-sided, and how it was made.
    first, second
        The two thresholds; infinite beyond the levels.
    correct
        The share of right answers at both; None for mid-points.
    paired
        Whether the same participants gave both.
    participants, n
        How many gave how many answers; None where the answers do not say who gave them.
    resamples, seed
        Of the bootstrap and its generator; None without one.
    definition, method, version
        What is meant by threshold here, how the difference was computed, and by which Trompe.
    """

    difference: Estimate
    p_value: float
    test: str
    first: float
    second: float
    correct: float | None
    paired: bool
    participants: int | None
    n: int
    resamples: int | None
    seed: int | None
    definition: str
    method: str
    version: str

    def to_frame(self) -> pd.DataFrame:
        """Return one row: the difference with its interval and test, and what it means."""
        rest = {name: value for name, value in vars(self).items() if name != "difference"}
        return pd.DataFrame([self.difference.columns("difference") | rest])


def posterior_difference(
    first: ThresholdFit, second: ThresholdFit, correct: float | None = None
) -> ThresholdDifference:
    """Return the difference of two fitted thresholds from their posteriors.

    Parameters
    ----------
    first, second
        As from `analysis.fit_threshold`; with one guess rate.
    correct
        The share of right answers at the thresholds, or None for the mid-points.

    Raises
    ------
    InputError
        If the guess rates differ, the share is impossible or a fit has lost its posterior.

    Notes
    -----
    Takes the two fits, and the answers in each, as independent. Where the same people gave both,
    or people differ, `threshold_difference` is the one to quote.
    """
    if first.guess_rate != second.guess_rate:
        raise InputError(
            f"first, second: guess rates {first.guess_rate:g} and {second.guess_rate:g} given,"
            " one accepted"
        )
    if first.posterior is None or second.posterior is None:
        raise InputError("first, second: fits as `fit_threshold` returns them accepted")
    values = (first.threshold.value, second.threshold.value)
    if correct is not None:
        values = (
            first.threshold_at(correct).threshold.value,
            second.threshold_at(correct).threshold.value,
        )
    found = first.posterior.level_of(correct).minus(second.posterior.level_of(correct))
    below = found.below(0.0)
    about = _About(
        correct, f"{first.method}; independent posteriors", POSTERIOR_TEST, n=first.n + second.n
    )
    return about.result(values, found.interval, 2 * min(below, 1 - below))


def threshold_difference(
    levels: ArrayLike,
    first: tuple[ArrayLike, ArrayLike],
    second: tuple[ArrayLike, ArrayLike],
    guess_rate: float,
    generator: np.random.Generator,
    resamples: int = RESAMPLES,
    *,
    paired: bool,
    correct: float | None = None,
) -> ThresholdDifference:
    """Return the difference of two conditions' thresholds, with participants as the sample.

    Parameters
    ----------
    levels
        Different levels in rising order, shape (l,), two or more.
    first, second
        The right answers and all answers in each condition, both of shape (participants, l); two
        participants or more. A level may have no answers in one condition, as where the answers
        chose the levels; each condition needs answers at two.
    guess_rate
        The share of right answers by chance, 0 to 0.5.
    generator
        Draws the participants.
    resamples
        How many times.
    paired
        Whether the same participants, in the same order, gave both; else all are different.
    correct
        The share of right answers at the thresholds, or None for the mid-points.

    Raises
    ------
    InputError
        If shapes, counts, the guess rate or the share are impossible.

    Notes
    -----
    Penalised maximum likelihood (`analysis.maximum_likelihood`) of the sums over participants, and
    again of participants drawn with replacement. If paired, one draw serves both conditions: what
    is common to a participant's answers drops out. The interval is expanded for few participants
    (`analysis.bootstrap.expanded_percentiles`), for two groups by the degrees of freedom of Welch
    (1947); the p-value is the one that agrees with it.
    """
    at, right, answers = _checked(levels, first, second, guess_rate, correct)
    people = [len(counts) for counts in right]
    if paired and people[0] != people[1]:
        raise InputError(
            f"first, second: {people[0]} and {people[1]} participants given, the same participants"
            " in both accepted"
        )
    draws = [resample(number, generator, resamples) for number in people[: 1 if paired else 2]]
    values = _thresholds(
        at,
        [counts.sum(axis=0, keepdims=True) for counts in right],
        [counts.sum(axis=0, keepdims=True) for counts in answers],
        guess_rate,
        correct,
    )
    drawn = _thresholds(
        at,
        [draw @ counts for draw, counts in zip([draws[0], draws[-1]], right, strict=True)],
        [draw @ counts for draw, counts in zip([draws[0], draws[-1]], answers, strict=True)],
        guess_rate,
        correct,
    )
    about = _About(
        correct,
        f"{METHOD}; {'paired ' if paired else ''}{BOOTSTRAP}",
        BOOTSTRAP_TEST,
        n=int(sum(counts.sum() for counts in answers)),
        paired=paired,
        participants=people[0] if paired else sum(people),
        resamples=resamples,
        seed=seed_of(generator),
    )
    with np.errstate(invalid="ignore"):  # two thresholds beyond the same end: unknown
        differences = drawn[0] - drawn[1]
    effective = people[0] if paired else 1 + _welch(drawn, np.array(people, float))
    return about.result(
        (float(values[0, 0]), float(values[1, 0])),
        interval_of(differences, effective),
        expanded_p_value(_share_beyond(differences), effective),
    )


def _checked(
    levels: ArrayLike,
    first: tuple[ArrayLike, ArrayLike],
    second: tuple[ArrayLike, ArrayLike],
    guess_rate: float,
    correct: float | None,
) -> tuple[Floats, list[Floats], list[Floats]]:
    """Check both conditions' counts and return levels, right answers and all answers."""
    if correct is not None:
        check_share(correct, guess_rate)
    right, answers = [], []
    for name, counts in (("first", first), ("second", second)):
        at, hits, total = count_rows(levels, *counts, guess_rate, "participant")
        check_observers(total, name, every_level=False)
        right.append(hits)
        answers.append(total)
    return at, right, answers


def _thresholds(
    levels: Floats,
    right: list[Floats],
    answers: list[Floats],
    guess_rate: float,
    correct: float | None,
) -> Floats:
    """Return the thresholds of both conditions, shape (2, fits)."""
    fits = maximum_likelihood(levels, np.concatenate(right), np.concatenate(answers), guess_rate)
    return fits.thresholds_at(correct).reshape(2, -1)


def _share_beyond(differences: Floats) -> float:
    """Return the share of resamples at or beyond 0 on the smaller side, never quite 0."""
    unknown = np.isnan(differences)
    tails = (np.sum((differences <= 0) | unknown), np.sum((differences >= 0) | unknown))
    return (int(min(tails)) + 1) / (len(differences) + 1)


def _welch(drawn: Floats, participants: Floats) -> float:
    """Return Welch's degrees of freedom from the variances of two groups' thresholds."""
    finite = np.where(np.isfinite(drawn), drawn, np.nan)
    bounded = np.isfinite(finite).sum(axis=1) > 1
    if not bounded.all():
        return float(participants.min() - 1)
    spread = np.nanvar(finite, axis=1) * participants / (participants - 1) + np.finfo(float).tiny
    return float(spread.sum() ** 2 / np.sum(spread**2 / (participants - 1)))


@dataclass(frozen=True)
class _About:
    """What a difference says besides its numbers."""

    correct: float | None
    method: str
    test: str
    n: int
    paired: bool = False
    participants: int | None = None
    resamples: int | None = None
    seed: int | None = None

    def result(
        self, values: tuple[float, float], interval: tuple[float, float], p_value: float
    ) -> ThresholdDifference:
        """Return the difference; without numbers where a threshold is beyond the levels."""
        what = "mid-points" if self.correct is None else f"levels at {100 * self.correct:g} % right"
        there = all(np.isfinite(values))
        return ThresholdDifference(
            Estimate(values[0] - values[1], *interval) if there else Estimate(*[np.nan] * 3),
            min(p_value, 1.0) if there else float("nan"),
            first=values[0],
            second=values[1],
            definition=f"difference of {what} of psychometric functions",
            version=software_version(),
            **vars(self),
        )
