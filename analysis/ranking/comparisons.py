"""Which items are ranked differently: all pairs after Friedman's test, and groups of items."""

import itertools
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.multiplicity import holm
from analysis.ranking.friedman import concordance
from analysis.ranking.ranks import Rankings

PostHoc = Literal["nemenyi", "conover"]
ALPHA = 0.05


@dataclass(frozen=True)
class RankComparisons:
    """All pairs of items compared.

    Attributes
    ----------
    table
        One row a pair: `item`, `other`, `difference` (of mean ranks, item minus other),
        `low`, `high` (the difference with Nemenyi's critical difference to both sides: an interval
        for all pairs at once), `p_nemenyi`, `p_conover` (Holm-adjusted).
    critical_difference
        Nemenyi's: pairs whose mean ranks differ by that or more are significantly different.
    groups
        Items in order of their mean rank, best first; each group is a longest run in which no pair
        differs by the test `posthoc`, so groups may overlap.
    posthoc, alpha
        The test that makes the groups, and its significance for the whole family of pairs.
    """

    table: pd.DataFrame
    critical_difference: float
    groups: tuple[tuple[str, ...], ...]
    posthoc: PostHoc
    alpha: float

    def differ(self, item: str, other: str) -> bool:
        """Return whether two items are ranked differently by the test that makes the groups."""
        both = self.table[self.table["item"].isin([item, other])]
        both = both[both["other"].isin([item, other])]
        if item == other or both.empty:
            raise InputError(f"item, other: {item!r} and {other!r} given, two items accepted")
        return bool(both[f"p_{self.posthoc}"].iloc[0] < self.alpha)


def compare_ranks(
    rankings: Rankings, posthoc: PostHoc = "nemenyi", alpha: float = ALPHA
) -> RankComparisons:
    """Compare all pairs of items.

    Parameters
    ----------
    rankings
        As from `analysis.ranking.ranks.check_ranks`.
    posthoc
        `nemenyi`: the range of mean ranks (Nemenyi 1963; Demsar 2006), which takes no account of
        ties; `conover`: t-tests with the variance of ranks left by Friedman's test (Conover 1999,
        sec. 5.8), adjusted by Holm 1979, which finds more where participants agree.
    alpha
        The significance for the family of all pairs, above 0 and below 1.

    Raises
    ------
    InputError
        If `posthoc` or `alpha` is none of these.
    """
    if posthoc not in ("nemenyi", "conover"):
        raise InputError(f"posthoc: {posthoc!r} given, 'nemenyi' or 'conover' accepted")
    if not 0 < alpha < 1:
        raise InputError(f"alpha: {alpha} given, above 0 and below 1 accepted")
    means = rankings.ranks.mean(axis=0)
    order = np.argsort(means, kind="stable")
    p_values = {"nemenyi": p_nemenyi(rankings.ranks), "conover": p_conover(rankings.ranks)}
    critical = critical_difference(len(rankings.ranks), len(means), alpha)
    rows = [
        {
            "item": rankings.items[one],
            "other": rankings.items[other],
            "difference": means[one] - means[other],
            "low": means[one] - means[other] - critical,
            "high": means[one] - means[other] + critical,
            "p_nemenyi": p_values["nemenyi"][one, other],
            "p_conover": p_values["conover"][one, other],
        }
        for one, other in itertools.combinations(order, 2)
    ]
    differs = p_values[posthoc][np.ix_(order, order)] < alpha
    return RankComparisons(
        table=pd.DataFrame(rows),
        critical_difference=critical,
        groups=tuple(
            tuple(rankings.items[order[place]] for place in run) for run in maximal_runs(differs)
        ),
        posthoc=posthoc,
        alpha=alpha,
    )


def critical_difference(participants: int, items: int, alpha: float = ALPHA) -> float:
    """Return Nemenyi's critical difference of mean ranks.

    Examples
    --------
    >>> round(critical_difference(14, 4), 2)  # Demsar 2006, sec. 3.2.2
    1.25
    """
    reach = stats.studentized_range.ppf(1 - alpha, items, np.inf)
    return float(reach * np.sqrt(items * (items + 1) / (12 * participants)))


def p_nemenyi(ranks: Matrix) -> Matrix:
    """Return Nemenyi's p-values, shape (k, k), of ranks (n, k) with ties averaged."""
    from scikit_posthocs import posthoc_nemenyi_friedman  # seconds

    return np.asarray(posthoc_nemenyi_friedman(ranks), dtype=float)


def p_conover(ranks: Matrix) -> Matrix:
    """Return Conover's p-values, Holm-adjusted, shape (k, k), of ranks (n, k) with ties averaged.

    Where all participants give the same ranking no variance is left: items of different ranks
    differ with p = 0.
    """
    if np.isclose(concordance(ranks), 1):
        means = ranks.mean(axis=0)
        return np.asarray(means[:, None] == means, dtype=float)
    from scikit_posthocs import posthoc_conover_friedman

    p_values = np.array(posthoc_conover_friedman(ranks), dtype=float)
    one, other = np.triu_indices(len(p_values), k=1)
    p_values[one, other] = p_values[other, one] = holm(p_values[one, other])
    return p_values


def maximal_runs(differs: ArrayLike) -> tuple[range, ...]:
    """Return the longest runs of neighbours in which no two differ.

    Parameters
    ----------
    differs
        Shape (k, k), symmetric: whether two places of an order differ significantly.

    Returns
    -------
    tuple of range
        The places of each run; a run inside another one is left out, others may overlap.

    Examples
    --------
    >>> maximal_runs([[False, False, True], [False, False, False], [True, False, False]])
    (range(0, 2), range(1, 3))
    """
    table: NDArray[np.bool_] = np.asarray(differs, dtype=bool)
    size = len(table)
    runs: list[range] = []
    for first in range(size):
        last = first
        while last + 1 < size and not table[first : last + 1, last + 1].any():
            last += 1
        if not runs or last >= runs[-1].stop:
            runs.append(range(first, last + 1))
    return tuple(runs)
