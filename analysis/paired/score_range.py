"""The range of scores when every answer is a coin's: formula, exact distribution, simulation.

An item's score is how often it was preferred, over all pairs and observers. The range, largest
minus smallest score, decides which differences are significant.
"""

import math
from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
import scipy.fft
from scipy import stats

from analysis.bootstrap import Matrix

SIMULATIONS = 100_000
_MOST_CELLS_EXACT = 2**22
_NUMBERS_AT_ONCE = 2_000_000
_BITS = 64


@dataclass(frozen=True)
class RangeDistribution:
    """P(range >= r) for r = 0, 1, ..., and where it is from.

    Attributes
    ----------
    tail
        Shape (largest range + 1,).
    method
        `exact`, `simulated` or `permuted`, with the number of draws.
    draws
        How many; 0 if exact.
    """

    tail: Matrix
    method: str
    draws: int = 0

    def critical(self, alpha: float) -> int | None:
        """Return the smallest range as rare as alpha; None if the largest is not."""
        rare = np.flatnonzero(self._p_values() <= alpha)
        return int(rare[0]) if rare.size else None

    def p_value(self, observed: int) -> float:
        """Return the probability of a range as large as the observed one."""
        return float(self._p_values()[observed])

    def _p_values(self) -> Matrix:
        """Return the tail; from draws, with what was observed counted among them."""
        return (self.tail * self.draws + 1) / (self.draws + 1) if self.draws else self.tail


def critical_difference(items: int, observers: int, alpha: float) -> float:
    """Return R_c of the large-sample formula, before rounding up.

    Parameters
    ----------
    items, observers
        t of 2 or more, n of 1 or more.
    alpha
        The probability of a larger range if all items are alike.

    Notes
    -----
    David 1988, The Method of Paired Comparisons, ch. 3; Setyawan and Lagendijk 2004; as in
    Lopez-Moreno 2011, eq. 7.5: R_c = (W sqrt(n t) + 1/2) / 2 with W the upper alpha point of the
    range of t standard normals.

    Examples
    --------
    >>> round(critical_difference(3, 44, 0.01), 2)
    23.92
    """
    range_point = float(stats.studentized_range.ppf(1 - alpha, items, np.inf))
    return (range_point * math.sqrt(observers * items) + 0.5) / 2


def exact_is_feasible(items: int, observers: int) -> bool:
    """Return whether the exact distribution takes less than a second or so."""
    cells: int = (observers * (items - 1) + 1) ** (items - 1)
    return cells <= _MOST_CELLS_EXACT


@cache
def exact_range(items: int, observers: int) -> RangeDistribution:
    """Return the exact distribution of the range of scores.

    Parameters
    ----------
    items, observers
        t of 2 or more, n of 1 or more. Time and memory grow as (n (t - 1) + 1)^(t - 1): four
        million cells take a second and 0.3 GB.

    Notes
    -----
    The scores' generating function is the product over pairs of ((x_i + x_j) / 2)^n. On a grid of
    roots of unity it is the Fourier transform of their distribution (the last score follows from
    the others). Rounding leaves an absolute error below 1e-12.
    """
    size = observers * (items - 1) + 1
    roots = np.exp(-2j * np.pi * np.arange(size) / size)
    variables = [*np.meshgrid(*[roots] * (items - 1), indexing="ij", sparse=True), np.ones(1)]
    transform = np.ones((size,) * (items - 1), dtype=complex)
    for one, other in combinations(variables, 2):
        transform *= ((one + other) / 2) ** observers
    probability = np.maximum(scipy.fft.ifftn(transform, overwrite_x=True).real, 0).ravel()
    scores = np.indices((size,) * (items - 1), dtype=np.int32).reshape(items - 1, -1)
    last = observers * math.comb(items, 2) - scores.sum(axis=0)
    spread = np.maximum(scores.max(axis=0), last) - np.minimum(scores.min(axis=0), last)
    possible = (last >= 0) & (last < size)
    return RangeDistribution(_tail(spread[possible], size, probability[possible]), "exact")


def simulated_range(
    items: int, observers: int, generator: np.random.Generator, simulations: int = SIMULATIONS
) -> RangeDistribution:
    """Return the distribution of the range of scores over simulated coins.

    Parameters
    ----------
    items, observers
        As in `exact_range`.
    generator, simulations
        Tosses, so many times. At alpha = 0.05 the default's standard error is 0.0007.
    """
    first, second = np.triu_indices(items, k=1)
    sign = np.eye(items)[first] - np.eye(items)[second]  # a win of the first is not the second's
    lost = observers * np.eye(items)[second].sum(axis=0)
    at_once = max(1, _NUMBERS_AT_ONCE // first.size)
    counted = np.zeros(observers * (items - 1) + 1)
    for start in range(0, simulations, at_once):
        some = min(at_once, simulations - start)
        scores = toss(generator, observers, (some, first.size)) @ sign + lost
        counted += np.bincount(np.ptp(scores, axis=1).astype(np.int64), minlength=counted.size)
    tail = np.cumsum(counted[::-1])[::-1] / simulations
    return RangeDistribution(tail, f"simulated, {simulations} times", simulations)


def toss(generator: np.random.Generator, coins: int, shape: tuple[int, ...]) -> Matrix:
    """Return how many of so many coins show heads; each is a random bit."""
    heads = np.zeros(shape)
    for start in range(0, coins, _BITS):
        bits = generator.integers(0, 2**_BITS, size=shape, dtype=np.uint64)
        heads += np.bitwise_count(bits >> np.uint64(max(0, start + _BITS - coins)))
    return heads


def _tail(spread: Matrix, size: int, probability: Matrix) -> Matrix:
    counted = np.bincount(spread, probability, minlength=size)
    return np.minimum(np.cumsum(counted[::-1])[::-1], 1)
