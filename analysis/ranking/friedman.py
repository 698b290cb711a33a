"""Do participants rank items alike? Friedman's test and Kendall's coefficient of concordance."""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats

from analysis.bootstrap import Matrix
from analysis.ranking.ranks import check_ranks

Integers = NDArray[np.int64]

MOST_SUMS = 4_000_000  # rank sums to look at: about a second
_MOST_ITEMS = 8  # 8! = 40,320 orders of one participant's ranks
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Concordance:
    """How far participants agree about the order of items, and the test of no agreement.

    Attributes
    ----------
    w
        Kendall's coefficient of concordance, 0 (rank sums all equal) to 1 (all rankings the same),
        corrected for ties.
    mean_spearman
        The mean rank correlation of all pairs of participants, ``(n W - 1) / (n - 1)``.
    chi_square, degrees_of_freedom, p_chi_square
        Friedman's statistic ``n (k - 1) W`` and its large-sample p-value.
    f, p_f
        The F form of Iman and Davenport (1980) with k - 1 and (k - 1) (n - 1) degrees of freedom;
        infinite where all rankings are the same.
    p_exact
        The exact p-value; None where it takes too long.
    participants, items
        How many ranked how many.
    """

    w: float
    mean_spearman: float
    chi_square: float
    degrees_of_freedom: int
    p_chi_square: float
    f: float
    p_f: float
    p_exact: float | None
    participants: int
    items: int

    @property
    def p_value(self) -> float:
        """The exact p-value where there is one, else that of chi-square."""
        return self.p_chi_square if self.p_exact is None else self.p_exact

    @property
    def method(self) -> str:
        """How the p-value was computed."""
        return "Friedman's test, " + ("chi-square" if self.p_exact is None else "exact")


def friedman(ranks: ArrayLike, *, ties: bool = False, exact: bool = True) -> Concordance:
    """Test whether participants' rankings have nothing in common.

    Parameters
    ----------
    ranks
        Shape (n, k), 1 = best, as in `analysis.rank_summary`.
    ties
        Whether a participant may give items the same rank.
    exact
        Whether to compute the exact p-value where that takes a few seconds at most.

    Raises
    ------
    InputError
        If these are no complete rankings.

    Notes
    -----
    Friedman 1937; with ties, Kendall and Gibbons 1990, ch. 6. The null hypothesis is that every
    order of a participant's ranks is equally likely, independently of other participants.

    Examples
    --------
    >>> friedman([[1, 2, 3], [1, 2, 3], [1, 2, 3]]).p_exact  # 3! / (3!)**3
    0.0277...
    """
    table = check_ranks(ranks, ties=ties).ranks
    participants, items = table.shape
    w = float(concordance(table))
    chi_square = participants * (items - 1) * w
    freedom = items - 1
    f = (participants - 1) * w / (1 - w) if 1 - w > _ROUNDING else math.inf
    return Concordance(
        w=w,
        mean_spearman=(participants * w - 1) / (participants - 1),
        chi_square=chi_square,
        degrees_of_freedom=freedom,
        p_chi_square=float(stats.chi2.sf(chi_square, freedom)),
        f=f,
        p_f=float(stats.f.sf(f, freedom, freedom * (participants - 1))),
        p_exact=exact_p_value(table) if exact else None,
        participants=participants,
        items=items,
    )


def concordance(ranks: Matrix) -> Matrix:
    """Return Kendall's W of rankings, shape (..., n, k), ties averaged.

    The sum of squares of the rank sums over the largest that these ranks, ties and all, allow.
    """
    participants, items = ranks.shape[-2:]
    centred = ranks - (items + 1) / 2
    largest = participants * (centred**2).sum(axis=(-2, -1))
    return np.asarray((centred.sum(axis=-2) ** 2).sum(axis=-1) / largest)


def exact_p_value(ranks: Matrix, most_sums: int = MOST_SUMS) -> float | None:
    """Return the probability of rank sums at least as unequal, given each participant's ties.

    Parameters
    ----------
    ranks
        Shape (n, k), ties averaged.
    most_sums
        Give up where more rank sums than that would surely have to be looked at.

    Returns
    -------
    float or None
        None where it was given up.

    Notes
    -----
    Participants are added one by one to the distribution of the rank sums. The items are
    exchangeable, so sums that are reorderings of each other are one state.
    """
    items = ranks.shape[1]
    if items > _MOST_ITEMS:
        return None
    doubled = np.rint(2 * ranks).astype(np.int64)  # averages of ties are halves
    states, chances = np.sort(doubled[:1], axis=1), np.ones(1)
    for added, row in enumerate(doubled[1:], start=1):
        if len(states) * _sums_to_come(added, len(doubled), items) > most_sums:
            return None
        orders = np.array(list(itertools.permutations(row.tolist())), dtype=np.int64)
        states, chances = _add(states, chances, orders)
    squares = (states**2).sum(axis=1)
    observed = (doubled.sum(axis=0) ** 2).sum()
    return float(min(chances[squares >= observed].sum(), 1.0))


def _sums_to_come(added: int, participants: int, items: int) -> float:
    """Return how many sums there are still to look at for each state, at least.

    The number of states grows like that of points in a lattice of k - 1 dimensions, or up to half
    as fast where there are few.
    """
    growth = (np.arange(added, participants) / added) ** (items - 1)
    return float(growth.sum()) * math.factorial(items) / 2


def _add(states: Integers, chances: Matrix, orders: Integers) -> tuple[Integers, Matrix]:
    """Return the distribution of the sorted rank sums after one more participant."""
    sums: Integers = np.sort((states[:, None] + orders).reshape(-1, orders.shape[1]), axis=1)
    base = int(sums.max()) + 1
    keys = np.zeros(len(sums), dtype=np.int64)
    for column in sums.T[:-1]:  # the last sum follows from the others
        keys = keys * base + column
    _, first, state = np.unique(keys, return_index=True, return_inverse=True)
    weights = np.repeat(chances / len(orders), len(orders))
    return sums[first], np.asarray(np.bincount(state, weights), dtype=float)
