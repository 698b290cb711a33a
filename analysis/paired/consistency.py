"""Consistency: how far one observer's choices are from an order, by circular triads.

A triad is circular where A is preferred to B, B to C, and C to A. Their number d gives Kendall's
coefficient zeta: 1 without any, 0 with as many as there can be. Chance does not give 0: with three
items a coin is consistent three times in four.
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import groupby, product

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import CONFIDENCE, Estimate, software_version
from analysis.paired.pair_data import Tournaments, tournaments

MOST_ITEMS_EXACT = 10
_MOST_WORK_EXACT = 1e8  # multiplications of a convolution; a second or so


@dataclass(frozen=True)
class Consistency:
    """One observer's circular triads.

    Attributes
    ----------
    triads, most_triads
        How many are circular, and how many can be.
    zeta
        The coefficient of consistency, 1 - triads / most_triads.
    chance_zeta
        Its mean if every answer is a coin's.
    p_value
        The probability that coins give no more circular triads: small for a consistent observer.
    items
        How many were compared.
    method, version
        How the p-value was computed, and by which Trompe.
    """

    triads: int
    most_triads: int
    zeta: float
    chance_zeta: float
    p_value: float
    items: int
    method: str
    version: str

    def to_frame(self) -> pd.DataFrame:
        """Return one row."""
        return pd.DataFrame([vars(self)])


@dataclass(frozen=True)
class GroupConsistency:
    """Several observers' circular triads.

    Attributes
    ----------
    table
        One row a tournament: `participant`, `triads`, `zeta`, `p_value`.
    mean_zeta
        The mean over participants with a 95 % interval; NaN ends where there is one, or all are
        alike.
    chance_zeta
        The mean if every answer is a coin's.
    p_value
        The probability that coins give no more circular triads in all.
    n, tournaments, items
        The number of participants, of tournaments and of items.
    method, version
        How, and by which Trompe.
    """

    table: pd.DataFrame
    mean_zeta: Estimate
    chance_zeta: float
    p_value: float
    n: int
    tournaments: int
    items: int
    method: str
    version: str

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def consistency(wins: ArrayLike) -> Consistency:
    """Return one observer's circular triads and coefficient of consistency.

    Parameters
    ----------
    wins
        Shape (t, t), t of 3 or more: 1 where the row's item was preferred to the column's, 0
        elsewhere; every pair exactly once.

    Raises
    ------
    InputError
        If shape or entries are impossible, a pair is missing, repeated or tied, or two items only
        were compared (two make no triad).

    Notes
    -----
    Kendall and Babington Smith 1940, Biometrika 31: zeta = 1 - 24 d / (t^3 - t) for odd t and
    1 - 24 d / (t^3 - 4 t) for even t. The p-value is exact up to 10 items and comes from their
    chi-square beyond (`triads_p_value`). With 5 items or fewer it is never below 0.11: a single
    observer cannot be told from coins there, a group can.

    Examples
    --------
    >>> consistency([[0, 1, 0], [0, 0, 1], [1, 0, 0]]).zeta
    0.0
    """
    if np.ndim(wins) == 3:
        raise InputError(
            f"wins: shape {np.shape(wins)} given, one observer's (items, items) accepted"
            " (of several: group_consistency)"
        )
    choices = tournaments(wins)
    items = _three_or_more(choices)
    triads = int(circular_triads(choices)[0])
    return Consistency(
        triads=triads,
        most_triads=most_circular_triads(items),
        zeta=1 - triads / most_circular_triads(items),
        chance_zeta=chance_zeta(items),
        p_value=triads_p_value(triads, items),
        items=items,
        method=_method(items, 1),
        version=software_version(),
    )


def group_consistency(
    wins: ArrayLike, participants: Sequence[object] | None = None
) -> GroupConsistency:
    """Return the circular triads and coefficients of consistency of several observers.

    Parameters
    ----------
    wins
        Shape (n, t, t), each as in `consistency`.
    participants
        Who made each tournament; someone who made several counts once in mean and interval. None:
        1, 2, ...

    Raises
    ------
    InputError
        As `consistency`, or if there are not as many participants as tournaments.

    Notes
    -----
    The interval is Student's over participants, cut at 0 and 1. The p-value is that of the sum of
    all circular triads, whose distribution under coins is a convolution.
    """
    choices = tournaments(wins)
    number, items = len(choices), _three_or_more(choices)
    names = list(participants) if participants is not None else list(range(1, number + 1))
    if len(names) != number:
        raise InputError(
            f"participants: {len(names)} given, one for each of {number} tournaments accepted"
        )
    triads = circular_triads(choices)
    table = pd.DataFrame(
        {
            "participant": names,
            "triads": triads,
            "zeta": 1 - triads / most_circular_triads(items),
            "p_value": [triads_p_value(int(d), items) for d in triads],
        }
    )
    by_participant = table.groupby("participant", sort=False)["zeta"].mean().to_numpy(float)
    return GroupConsistency(
        table,
        _mean(by_participant),
        chance_zeta(items),
        triads_p_value(int(triads.sum()), items, number),
        len(by_participant),
        number,
        items,
        f"{_method(items, number)}; interval: Student's t over participants",
        software_version(),
    )


def circular_triads(choices: Tournaments) -> NDArray[np.int64]:
    """Return the number of circular triads of each tournament, shape (n,).

    A triad that is not circular has one item that beats both others: d is the number of triads
    minus the pairs of wins of each item.
    """
    scores = choices.sum(axis=-1)
    items = choices.shape[-1]
    return np.asarray(math.comb(items, 3) - (scores * (scores - 1) // 2).sum(axis=-1))


def most_circular_triads(items: int) -> int:
    """Return the largest possible number of circular triads among t items."""
    return (items**3 - (items if items % 2 else 4 * items)) // 24


def chance_zeta(items: int) -> float:
    """Return the mean coefficient of consistency of coins: 0.75 at t = 3, 0.167 at t = 6.

    A quarter of all triads are then circular.
    """
    return 1 - math.comb(items, 3) / 4 / most_circular_triads(items)


@cache
def triad_counts(items: int) -> tuple[int, ...]:
    """Return how many of all tournaments have 0, 1, ... circular triads.

    Parameters
    ----------
    items
        3 to 10: the scores of all tournaments are enumerated, item by item, with equal scores
        taken together (Alway 1962, Biometrika 49). 10 items take about a second.
    """
    tournaments_by_scores: Counter[tuple[int, ...]] = Counter({(0,): 1})
    for present in range(1, items):
        grown: Counter[tuple[int, ...]] = Counter()
        for scores, number in tournaments_by_scores.items():
            _add_item(scores, number, present, grown)
        tournaments_by_scores = grown
    counts = [0] * (most_circular_triads(items) + 1)
    for scores, number in tournaments_by_scores.items():
        counts[math.comb(items, 3) - sum(math.comb(score, 2) for score in scores)] += number
    return tuple(counts)


def _add_item(
    scores: tuple[int, ...], number: int, present: int, grown: Counter[tuple[int, ...]]
) -> None:
    """Let a new item be beaten by every subset of those present."""
    alike = [(score, len(list(same))) for score, same in groupby(scores)]
    for winners in product(*(range(size + 1) for _, size in alike)):
        ways, new = number, [present - sum(winners)]
        for (score, size), won in zip(alike, winners, strict=True):
            ways *= math.comb(size, won)
            new += [score] * (size - won) + [score + 1] * won
        grown[tuple(sorted(new))] += ways


def triads_p_value(triads: int, items: int, observers: int = 1) -> float:
    """Return the probability that coins give no more circular triads.

    Parameters
    ----------
    triads
        Of all observers together.
    items
        3 or more: exact up to 10, by `triads_chi_square` beyond.
    observers
        1 or more: exact up to 250 at 10 items and more with fewer, by `triads_chi_square` beyond.
    """
    if exact_is_feasible(items, observers):
        return float(_cumulative_triads(items, observers)[triads])
    return triads_chi_square(triads, items, observers)


def exact_is_feasible(items: int, observers: int = 1) -> bool:
    """Return whether `triads_p_value` is exact for so many."""
    if items <= 4:  # the chi-square needs 5 or more
        return True
    work = (observers * most_circular_triads(items)) ** 2
    return items <= MOST_ITEMS_EXACT and work <= _MOST_WORK_EXACT


def triads_chi_square(triads: int, items: int, observers: int = 1) -> float:
    """Return that probability by the approximation of Kendall and Babington Smith 1940.

    Parameters
    ----------
    triads, items, observers
        As in `triads_p_value`, items 5 or more; chi-squares of several observers add up.

    Notes
    -----
    A step of 1/2 for continuity is taken in the direction that suits a small d. For 10 items the
    result is then within 0.011 of the exact one.
    """
    mean = observers * math.comb(items, 3) / 4
    freedom = observers * items * (items - 1) * (items - 2) / (items - 4) ** 2
    chi_square = 8 / (items - 4) * (mean - triads - 0.5) + freedom
    return float(stats.chi2.sf(chi_square, freedom))


@cache
def _cumulative_triads(items: int, observers: int) -> Matrix:
    """Return the cumulative distribution of the triads of all observers, by repeated squaring."""
    power = np.array(triad_counts(items), dtype=float) / 2.0 ** math.comb(items, 2)
    total = np.ones(1)
    remaining = observers
    while remaining:
        if remaining % 2:
            total = np.convolve(total, power)
        remaining //= 2
        if remaining:
            power = np.convolve(power, power)
    return np.minimum(np.cumsum(total), 1)


def _mean(zeta: Matrix) -> Estimate:
    mean, observers = float(zeta.mean()), len(zeta)
    spread = float(zeta.std(ddof=1)) if observers > 1 else 0.0
    if spread == 0:
        return Estimate(mean, math.nan, math.nan)
    quantile = float(stats.t.ppf((1 + CONFIDENCE) / 2, observers - 1))
    reach = quantile * spread / math.sqrt(observers)
    return Estimate(mean, max(0.0, mean - reach), min(1.0, mean + reach))


def _three_or_more(choices: Tournaments) -> int:
    items = int(choices.shape[-1])
    if items < 3:
        raise InputError(f"wins: {items} items given, 3 or more accepted (two make no triad)")
    return items


def _method(items: int, observers: int) -> str:
    if exact_is_feasible(items, observers):
        return "Kendall's zeta; p exact, by enumeration"
    return "Kendall's zeta; p by Kendall's chi-square"
