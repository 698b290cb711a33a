"""Rankings of the same items by several participants, checked; orders turned into ranks."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.paired.pair_data import item_names


@dataclass(frozen=True)
class Rankings:
    """Complete rankings.

    Attributes
    ----------
    ranks
        Shape (participants, items), 1 = best; tied items share the mean of their ranks, so that
        every row sums to k (k + 1) / 2.
    items
        The names of the items.
    """

    ranks: Matrix
    items: tuple[str, ...]

    @property
    def tied(self) -> bool:
        """Whether some participant gave two items the same rank."""
        return bool(np.any(np.diff(np.sort(self.ranks, axis=1), axis=1) == 0))


def check_ranks(
    ranks: ArrayLike, items: Sequence[str] | None = None, *, ties: bool = False
) -> Rankings:
    """Check complete rankings of k items by n participants.

    Parameters
    ----------
    ranks
        Shape (n, k), 1 = best, one row a participant; a data frame names its items by its columns.
    items
        The names of the items, if `ranks` does not name them; else they are numbered from 1.
    ties
        Whether a participant may give items the same rank. Equal ranks may be written in any way
        (1, 1, 2 or 1, 1, 3 or 1.5, 1.5, 3); their mean is used.

    Raises
    ------
    InputError
        If a ranking is incomplete or is none, or if there are fewer than two participants or items.
    """
    table = _numbers(ranks)
    columns = list(map(str, ranks.columns)) if isinstance(ranks, pd.DataFrame) else None
    names = item_names(items or columns, table.shape[1])
    for row, ranking in enumerate(table):
        _check_ranking(ranking, row, ties)
    averaged = np.asarray(stats.rankdata(table, axis=1), dtype=float)
    if np.all(averaged == averaged[:, :1]):
        raise InputError("ranks: all items tied by all participants, nothing to compare")
    return Rankings(averaged, names)


def ranks_of_orders(orders: Sequence[Sequence[Hashable]]) -> pd.DataFrame:
    """Turn orders of items, best first, into ranks.

    Parameters
    ----------
    orders
        One a participant, each naming all the items once.

    Returns
    -------
    pandas.DataFrame
        One row a participant, one column an item, as `analysis.rank_summary` takes it.

    Raises
    ------
    InputError
        If an order names an item twice, or other items than the first one does.

    Examples
    --------
    >>> ranks_of_orders([["fog", "haze", "clear"], ["haze", "fog", "clear"]]).to_numpy().tolist()
    [[1, 2, 3], [2, 1, 3]]
    """
    if not orders:
        raise InputError("orders: none given, one for each participant accepted")
    items = list(orders[0])
    for row, order in enumerate(orders):
        if len(set(order)) != len(order) or set(order) != set(items):
            raise InputError(
                f"orders: entry {row} does not name each of the first order's items once"
            )
    places = [{item: place for place, item in enumerate(order, 1)} for order in orders]
    return pd.DataFrame([[place[item] for item in items] for place in places], columns=items)


def _numbers(ranks: ArrayLike) -> Matrix:
    try:
        table = np.asarray(ranks, dtype=float)
    except (TypeError, ValueError):
        raise InputError("ranks: not a table of numbers with as many in each row") from None
    if table.ndim != 2 or min(table.shape) < 2:
        raise InputError(
            f"ranks: shape {table.shape} given, (participants, items) with two or more of both"
            " accepted"
        )
    return table


def _check_ranking(ranking: Matrix, row: int, ties: bool) -> None:
    items = len(ranking)
    if not np.all(np.isfinite(ranking)):
        raise InputError(f"ranks: row {row} has missing ranks, complete rankings accepted")
    if np.array_equal(np.sort(ranking), np.arange(1, items + 1)):
        return
    tied = len(set(ranking.tolist())) < items
    if tied and not ties:
        raise InputError(f"ranks: row {row} has tied ranks, accepted with ties=True only")
    if not tied or ranking.min() < 1 or ranking.max() > items:
        raise InputError(f"ranks: row {row} is no ranking, each rank from 1 to {items} accepted")
