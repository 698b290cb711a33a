"""Agreement: whether observers prefer the same items, by Kendall's coefficient u.

u is the share of agreeing pairs of observers, over all pairs of items, stretched so that full
agreement is 1 and the agreement of coins is 0 on average. Below that there is little room: n
observers cannot all disagree with each other about two items.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import CONFIDENCE, Estimate, seed_of, software_version
from analysis.paired.item_permutations import PERMUTATIONS, monte_carlo_p_value, permuted_pair_wins
from analysis.paired.pair_data import Tournaments, tournaments

_MOST_WORK_EXACT = 5e8  # multiplications; about a second
PairCounts = NDArray[np.int64]


@dataclass(frozen=True)
class Agreement:
    """Kendall's coefficient of agreement u with its tests.

    Attributes
    ----------
    agreeing
        Kendall's Sigma: pairs of observers that agree, summed over pairs of items.
    u
        2 agreeing / (all of them) - 1, with a 95 % interval over observers.
    minimum
        The smallest possible u: -1 / (n - 1) for even n, -1 / n for odd n.
    p_value, p_method
        The probability that coins agree as much, and how it was computed.
    kendall_chi_square, kendall_freedom, kendall_p_value
        Kendall's approximation, continuity corrected; NaN for two observers.
    chi_square, freedom, chi_square_p_value
        The large-sample test: u (n - 1) + 1 times the pairs of items.
    permutation_p_value
        The same question for observers who may each be consistent: the items' names are shuffled
        within each observer. NaN if no generator was given.
    n, items, conditions
        The number of observers, of items, and of conditions in which they were compared.
    permutations, seed, version
        Of the shuffling, its generator, and Trompe.
    """

    agreeing: int
    u: Estimate
    minimum: float
    p_value: float
    p_method: str
    kendall_chi_square: float
    kendall_freedom: float
    kendall_p_value: float
    chi_square: float
    freedom: int
    chi_square_p_value: float
    permutation_p_value: float
    n: int
    items: int
    conditions: int
    permutations: int
    seed: int | None
    version: str
    method: str = "Kendall's u; interval: jackknife over observers, Student's t"

    def to_frame(self) -> pd.DataFrame:
        """Return one row."""
        row = {name: value for name, value in vars(self).items() if name != "u"}
        return pd.DataFrame([self.u.columns("u") | row])


@dataclass(frozen=True)
class ChiSquare:
    """A chi-square statistic, its degrees of freedom and its upper tail."""

    statistic: float
    freedom: float
    p_value: float


def agreement(
    wins: ArrayLike,
    generator: np.random.Generator | None = None,
    permutations: int = PERMUTATIONS,
) -> Agreement:
    """Return the coefficient of agreement between observers.

    Parameters
    ----------
    wins
        Shape (n, t, t), n and t of 2 or more: 1 where the row's item was preferred to the
        column's, 0 elsewhere; every pair exactly once.
    generator
        Shuffles items within observers; None: that test is left out.
    permutations
        How many shuffles, 1 or more.

    Raises
    ------
    InputError
        If shape or entries are impossible, a pair is missing, repeated or tied, or there is one
        observer only.

    Notes
    -----
    Kendall and Babington Smith 1940, Biometrika 31. The interval is a jackknife's: u is a mean
    over pairs of observers. It holds the population's u 93 to 99 times in 100
    (`benchmarks/paired.py`); whether there is any agreement is for the p-value to say.

    Examples
    --------
    >>> str(agreement([[[0, 1], [0, 0]]] * 3).u)
    '1.0 [nan, nan]'
    """
    return agreement_over([wins], generator, permutations)


def agreement_over(
    conditions: Sequence[ArrayLike],
    generator: np.random.Generator | None = None,
    permutations: int = PERMUTATIONS,
) -> Agreement:
    """Return the agreement of the same observers over several conditions.

    A pair of items in another condition is another pair: u is the mean of the conditions' u, and
    the tests count all pairs.

    Parameters
    ----------
    conditions
        The wins in each condition, as in `agreement`, observers in the same order.
    generator, permutations
        As in `agreement`; an observer's items are shuffled alike in all conditions.

    Raises
    ------
    InputError
        As `agreement`, or if conditions differ in their shape or there is none.
    """
    each = [tournaments(wins) for wins in conditions]
    if not each or len({choices.shape for choices in each}) > 1:
        shapes = sorted({choices.shape for choices in each})
        raise InputError(f"conditions: shapes {shapes} given, one or more of one shape accepted")
    choices = np.stack(each)
    observers, items = choices.shape[1:3]
    if observers < 2:
        raise InputError("wins: one observer given, agreement needs two or more")
    counts = pair_wins(choices.sum(axis=1))
    sigma = agreeing_pairs(counts, observers)
    p_value, p_method = agreement_p_value(sigma, observers, counts.size)
    kendall = kendall_chi_square(sigma, observers, counts.size)
    large = large_sample_chi_square(sigma, observers, counts.size)
    return Agreement(
        agreeing=sigma,
        u=_jackknife(choices, sigma),
        minimum=smallest_agreement(observers),
        p_value=p_value,
        p_method=p_method,
        kendall_chi_square=kendall.statistic,
        kendall_freedom=kendall.freedom,
        kendall_p_value=kendall.p_value,
        chi_square=large.statistic,
        freedom=int(large.freedom),
        chi_square_p_value=large.p_value,
        permutation_p_value=_permutation_p_value(choices, sigma, generator, permutations),
        n=observers,
        items=items,
        conditions=len(each),
        permutations=permutations if generator is not None else 0,
        seed=seed_of(generator) if generator is not None else None,
        version=software_version(),
    )


def pair_wins(counts: NDArray[np.int64]) -> PairCounts:
    """Return the wins of the first of each pair of items, shape (..., pairs)."""
    return np.asarray(counts[..., *np.triu_indices(counts.shape[-1], k=1)])


def agreeing_pairs(counts: PairCounts, observers: int) -> int:
    """Return Kendall's Sigma from the wins of the first of each pair of items."""
    others = observers - counts
    return int((counts * (counts - 1) + others * (others - 1)).sum() // 2)


def coefficient(sigma: float, observers: int, pairs: int) -> float:
    """Return u from Sigma over a number of pairs of items."""
    return 2 * sigma / (math.comb(observers, 2) * pairs) - 1


def smallest_agreement(observers: int) -> float:
    """Return the smallest possible u of n observers."""
    return -1 / (observers if observers % 2 else observers - 1)


def kendall_chi_square(sigma: float, observers: int, pairs: int) -> ChiSquare:
    """Return Kendall's approximation to the distribution of Sigma under coins.

    Parameters
    ----------
    sigma
        As from `agreeing_pairs`; 1 is taken off for continuity.
    observers
        3 or more; NaN for two.
    pairs
        The number of pairs of items, t (t - 1) / 2.

    Notes
    -----
    Kendall 1962, Rank Correlation Methods, ch. 11: degrees of freedom pairs n (n - 1) / (n - 2)^2.
    """
    if observers < 3:
        return ChiSquare(math.nan, math.nan, math.nan)
    freedom = pairs * observers * (observers - 1) / (observers - 2) ** 2
    expected = pairs * math.comb(observers, 2) * (observers - 3) / (observers - 2) / 2
    statistic = 4 / (observers - 2) * (sigma - 1 - expected)
    return ChiSquare(statistic, freedom, float(stats.chi2.sf(statistic, freedom)))


def large_sample_chi_square(sigma: float, observers: int, pairs: int) -> ChiSquare:
    """Return the test for many observers: each pair's wins as a normal variable.

    Siegel and Castellan 1988, ch. 9: pairs (1 + u (n - 1)) with `pairs` degrees of freedom.
    """
    statistic = pairs * (1 + coefficient(sigma, observers, pairs) * (observers - 1))
    return ChiSquare(statistic, pairs, float(stats.chi2.sf(statistic, pairs)))


def agreement_p_value(sigma: int, observers: int, pairs: int) -> tuple[float, str]:
    """Return the probability that coins agree as much, and how it was computed.

    It is exact where that takes about a second at most (n = 50, t = 10: 0.04 s), and Kendall's
    chi-square beyond, where the two differ by less than 0.002.
    """
    kernel, steps = observers // 2 + 1, pairs**2 / 2
    if steps * kernel * (observers / 2) ** 2 > _MOST_WORK_EXACT:
        return kendall_chi_square(sigma, observers, pairs).p_value, "Kendall's chi-square"
    least, tail = agreement_tail(observers, pairs)
    return float(tail[max(0, sigma - least)]), "exact"


@cache
def agreement_tail(observers: int, pairs: int) -> tuple[int, Matrix]:
    """Return the smallest Sigma, and P(Sigma or more) from there on.

    The wins of each pair are binomial and independent: a convolution over pairs, of positive
    terms only, so that the relative error stays below 1e-12 even far in the tail.
    """
    wins = np.arange(observers + 1)
    agreeing = (wins * (wins - 1) + (observers - wins) * (observers - wins - 1)) // 2
    extra, group = np.unique(agreeing - agreeing.min(), return_inverse=True)
    probability = np.bincount(group, stats.binom.pmf(wins, observers, 0.5))
    distribution = np.ones(1)
    for _ in range(pairs):
        size = distribution.size
        total = np.zeros(size + int(extra[-1]))
        for shift, share in zip(extra, probability, strict=True):
            total[shift : shift + size] += share * distribution
        distribution = total
    tail = np.cumsum(distribution[::-1])[::-1]
    return int(agreeing.min()) * pairs, np.minimum(tail, 1)


def _jackknife(choices: Tournaments, sigma: int) -> Estimate:
    """Return u with the interval from leaving each observer out."""
    conditions, observers, items = choices.shape[:3]
    pairs = conditions * math.comb(items, 2)
    u = coefficient(sigma, observers, pairs)
    if observers < 3:
        return Estimate(u, math.nan, math.nan)
    agreeing = (choices * (choices.sum(axis=1, keepdims=True) - 1)).sum(axis=(0, 2, 3))
    without = 2 * (sigma - agreeing) / (math.comb(observers - 1, 2) * pairs) - 1
    error = math.sqrt((observers - 1) ** 2 / observers * float(without.var(ddof=1)))
    if error == 0:
        return Estimate(u, math.nan, math.nan)
    reach = float(stats.t.ppf((1 + CONFIDENCE) / 2, observers - 1)) * error
    return Estimate(u, max(u - reach, smallest_agreement(observers)), min(u + reach, 1.0))


def _permutation_p_value(
    choices: Tournaments, sigma: int, generator: np.random.Generator | None, permutations: int
) -> float:
    if generator is None:
        return math.nan
    observers = choices.shape[1]
    as_much = 0
    for first in permuted_pair_wins(choices, generator, permutations):
        others = observers - first
        agreeing = (first * (first - 1) + others * (others - 1)).sum(axis=(1, 2)) // 2
        as_much += int((agreeing >= sigma).sum())
    return monte_carlo_p_value(as_much, permutations)
