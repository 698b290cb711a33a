import re
from typing import Any

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.ranking.ranks import check_ranks, ranks_of_orders

NAN = float("nan")


def test_items_are_named_by_the_columns_or_numbered() -> None:
    table = pd.DataFrame({"ours": [1, 2], "artist": [2, 1]})
    assert check_ranks(table).items == ("ours", "artist")
    assert check_ranks(table.to_numpy()).items == ("1", "2")
    assert check_ranks(table.to_numpy(), ("a", "b")).items == ("a", "b")


@pytest.mark.parametrize("written", [[1, 1, 2], [1, 1, 3], [1.5, 1.5, 3]])
def test_tied_ranks_are_averaged_however_written(written: list[float]) -> None:
    rankings = check_ranks([written, [1.0, 2.0, 3.0]], ties=True)
    np.testing.assert_array_equal(rankings.ranks, [[1.5, 1.5, 3], [1, 2, 3]])
    assert rankings.tied
    assert not check_ranks([[1, 2, 3], [3, 2, 1]], ties=True).tied


def test_orders_become_ranks() -> None:
    table = ranks_of_orders([["a", "b", "c"], ["c", "a", "b"]])
    assert table.columns.tolist() == ["a", "b", "c"]
    assert table.to_numpy().tolist() == [[1, 2, 3], [2, 3, 1]]


@pytest.mark.parametrize(
    ("ranks", "message"),
    [
        ([[1, 2, 3]], "ranks: shape (1, 3) given, (participants, items) with two or more of both"),
        ([[1], [1]], "ranks: shape (2, 1) given, (participants, items) with two or more of both"),
        ([1, 2, 3], "ranks: shape (3,) given, (participants, items) with two or more of both"),
        ([[1, 2], [1]], "ranks: not a table of numbers with as many in each row"),
        ([["a", "b"], ["b", "a"]], "ranks: not a table of numbers with as many in each row"),
        ([[1, 2], [NAN, 1]], "ranks: row 1 has missing ranks, complete rankings accepted"),
        ([[1, 2, 3], [1, 2, 4]], "ranks: row 1 is no ranking, each rank from 1 to 3 accepted"),
        ([[0, 1, 2], [1, 2, 3]], "ranks: row 0 is no ranking, each rank from 1 to 3 accepted"),
        ([[1, 2, 3], [1, 1, 2]], "ranks: row 1 has tied ranks, accepted with ties=True only"),
    ],
)
def test_refuses_what_is_no_complete_ranking(ranks: Any, message: str) -> None:  # noqa: ANN401
    with pytest.raises(InputError, match=re.escape(message)):
        check_ranks(ranks)


@pytest.mark.parametrize(
    ("ranks", "message"),
    [
        ([[1, 1], [1, 1]], "ranks: all items tied by all participants, nothing to compare"),
        ([[1, 2, 4], [1, 2, 3]], "ranks: row 0 is no ranking, each rank from 1 to 3 accepted"),
        ([[4, 4, 1], [1, 2, 3]], "ranks: row 0 is no ranking, each rank from 1 to 3 accepted"),
    ],
)
def test_refuses_with_ties_too(ranks: list[list[float]], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        check_ranks(ranks, ties=True)


def test_refuses_names_and_orders_that_do_not_fit() -> None:
    with pytest.raises(InputError, match=r"items: .* given, 2 different names accepted"):
        check_ranks([[1, 2], [2, 1]], ("a", "a"))
    with pytest.raises(InputError, match="orders: none given"):
        ranks_of_orders([])
    for second in (["a", "a"], ["a"], ["a", "x"]):
        with pytest.raises(InputError, match="orders: entry 1 does not name each of the first"):
            ranks_of_orders([["a", "b"], second])
