"""The largest level not distinguishable from chance: the other meaning of a threshold."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import software_version
from analysis.thresholds.counts import level_counts

Test = Literal["exact binomial", "t over participants"]
ALPHA = 0.05


@dataclass(frozen=True)
class ChanceLimit:
    """The largest level whose hit rate cannot be told from guessing.

    It depends on the number of answers: more of them tell smaller differences from chance. It is
    not a mid-point of a psychometric function and must not be compared with one.

    Attributes
    ----------
    level
        In the unit of the levels; NaN if the rate is above chance at every level tested.
    at_largest_level
        Whether that is the largest level tested, so that no limit was reached.
    levels, rates, p_values
        One entry a level: the hit rate and the one-sided p-value of "no better than chance".
    guess_rate, alpha
        The chance rate, and the p-value below which a rate is told from it.
    n
        The number of answers.
    test, definition, version
        How it was tested, what is meant, and by which Trompe.
    """

    level: float
    at_largest_level: bool
    levels: tuple[float, ...]
    rates: tuple[float, ...]
    p_values: tuple[float, ...]
    guess_rate: float
    alpha: float
    n: int
    test: Test
    definition: str = "largest level not distinguishable from chance"
    version: str = ""

    def to_frame(self) -> pd.DataFrame:
        """Return one row a level, each with the limit and its test."""
        return pd.DataFrame(
            {
                "level": self.levels,
                "rate": self.rates,
                "p_value": self.p_values,
                "above_chance": [p < self.alpha for p in self.p_values],
                "limit": self.level,
                "test": self.test,
                "alpha": self.alpha,
                "definition": self.definition,
                "version": self.version,
            }
        )


def largest_level_at_chance(
    levels: ArrayLike,
    correct: ArrayLike,
    total: ArrayLike,
    guess_rate: float,
    alpha: float = ALPHA,
) -> ChanceLimit:
    """Return the largest level whose hit rate an exact binomial test cannot tell from chance.

    Parameters
    ----------
    levels, correct, total, guess_rate
        As in `analysis.fit_threshold`.
    alpha
        The significance of each level's one-sided test, above 0 and below 1.

    Raises
    ------
    InputError
        If an argument is impossible.

    Notes
    -----
    The kind of threshold that Lopez-Moreno 2011, sec. 2.3.1 states. It is the default because it
    is exact: if everybody guesses, answers are independent however many come from one participant.
    `largest_level_at_chance_by_participant` asks instead whether the mean participant is better
    than chance when participants differ.

    That all larger levels are better than chance needs no correction for their number. They are a
    fixed sequence, from the largest down to the first that cannot be told from chance, and such a
    sequence errs with a probability of at most alpha (Maurer, Hothorn and Lehmacher 1995).

    Examples
    --------
    >>> largest_level_at_chance([10, 20, 30], [5, 9, 30], [40, 40, 40], 1 / 8).level
    10.0
    """
    _check_alpha(alpha)
    counts = level_counts(levels, correct, total, guess_rate)
    p_values = [
        float(stats.binomtest(right, answers, guess_rate, alternative="greater").pvalue)
        for right, answers in zip(counts.correct, counts.total, strict=True)
    ]
    rates = np.divide(counts.correct, counts.total)
    return _limit(
        counts.levels, rates, p_values, guess_rate, alpha, sum(counts.total), "exact binomial"
    )


def largest_level_at_chance_by_participant(
    levels: ArrayLike, correct: ArrayLike, total: ArrayLike, guess_rate: float, alpha: float = ALPHA
) -> ChanceLimit:
    """Return the largest level at which the mean participant cannot be told from chance.

    Parameters
    ----------
    levels
        Different levels in rising order, shape (n,).
    correct, total
        Right answers and all answers, shape (participants, n); two participants or more.
    guess_rate, alpha
        As in `largest_level_at_chance`.

    Raises
    ------
    InputError
        If an argument is impossible.

    Notes
    -----
    At each level a one-sided t-test of the participants' excess of right answers over chance,
    weighted by their number of answers (a ratio estimator, Cochran 1977, sec. 2.11). With equally
    many answers each it is the one-sample t-test of the participants' rates.
    """
    _check_alpha(alpha)
    right, answers = np.asarray(correct, float), np.asarray(total, float)
    if right.shape != answers.shape or right.ndim != 2 or len(right) < 2:
        raise InputError(
            f"correct, total: shapes {right.shape} and {answers.shape} given,"
            " one shape (participants, levels) with two participants or more accepted"
        )
    counts = level_counts(levels, right.sum(axis=0), answers.sum(axis=0), guess_rate)
    if not np.array_equal(counts.levels, np.asarray(levels, float)):
        raise InputError("levels: different levels in rising order, all with answers, accepted")
    rates = right.sum(axis=0) / answers.sum(axis=0)
    p_values = [_mean_above(k, n, guess_rate) for k, n in zip(right.T, answers.T, strict=True)]
    return _limit(
        counts.levels, rates, p_values, guess_rate, alpha, sum(counts.total), "t over participants"
    )


def _check_alpha(alpha: float) -> None:
    if not 0 < alpha < 1:
        raise InputError(f"alpha: {alpha} given, above 0 and below 1 accepted")


def _mean_above(correct: Matrix, total: Matrix, guess_rate: float) -> float:
    """Return the one-sided p-value of a mean rate above chance over participants."""
    answered = total > 0
    participants = int(answered.sum())
    if participants < 2:
        return float("nan")
    rate = correct.sum() / total.sum()
    residuals = (correct - rate * total)[answered]
    error = np.sqrt((residuals**2).sum() * participants / (participants - 1)) / total.sum()
    if error == 0:  # alike: each counts as one who could as well be at either end
        return float((guess_rate / rate) ** participants) if rate > guess_rate else 1.0
    return float(stats.t.sf((rate - guess_rate) / error, participants - 1))


def _limit(
    levels: tuple[float, ...],
    rates: Matrix,
    p_values: list[float],
    guess_rate: float,
    alpha: float,
    n: int,
    test: Test,
) -> ChanceLimit:
    at_chance = [
        level
        for level, p in zip(levels, p_values, strict=True)
        if not p < alpha  # NaN: untold
    ]
    return ChanceLimit(
        level=max(at_chance, default=float("nan")),
        at_largest_level=bool(at_chance) and max(at_chance) == levels[-1],
        levels=levels,
        rates=tuple(float(rate) for rate in rates),
        p_values=tuple(p_values),
        guess_rate=guess_rate,
        alpha=alpha,
        n=n,
        test=test,
        version=software_version(),
    )
