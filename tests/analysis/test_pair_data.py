import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.paired.pair_data import (
    complete_tournaments,
    item_names,
    pair_counts,
    pair_data,
    tournaments,
)

ORDER = [[0, 1, 1], [0, 0, 1], [0, 0, 0]]


def answers(*rows: tuple[object, ...]) -> pd.DataFrame:
    return pd.DataFrame(list(rows), columns=["participant", "item_a", "item_b", "chosen"])


def complete(participant: str) -> list[tuple[object, ...]]:
    pairs = (("a", "b"), ("b", "c"), ("c", "a"))
    return [(participant, one, other, min(one, other)) for one, other in pairs]


def test_one_observer_and_several_become_the_same_form() -> None:
    assert tournaments(ORDER).shape == (1, 3, 3)
    assert tournaments([ORDER, ORDER]).shape == (2, 3, 3)
    assert pair_counts(pd.DataFrame([[0, 2.5], [0.5, 0]])).tolist() == [[[0, 2.5], [0.5, 0]]]


@pytest.mark.parametrize(
    ("wins", "message"),
    [
        ([1, 2], r"wins: shape \(2,\) given, \(items, items\) or"),
        (np.zeros((2, 3)), r"wins: shape \(2, 3\) given"),
        (np.zeros((0, 3, 3)), r"wins: shape \(0, 3, 3\) given"),
        (np.zeros((0, 0)), r"wins: shape \(0, 0\) given"),
        ([["a", "b"], ["c", "d"]], "wins: an array of numbers accepted"),
        ([[0]], "wins: 1 item given, 2 or more accepted"),
        ([[0, np.nan], [1, 0]], r"wins: nan at \[0, 1\] given, whole numbers of 0 or more"),
        ([[0, np.inf], [1, 0]], r"wins: inf at \[0, 1\] given"),
        ([[0, -1], [1, 0]], r"wins: -1 at \[0, 1\] given"),
        ([[0, 0.3], [0.7, 0]], r"wins: 0.3 at \[0, 1\] given, whole numbers of 0 or more, or halv"),
        ([[0, 1], [0, 1]], r"wins: 1 at \[1, 1\] given, 0 accepted: an item is not compared with"),
        ([[0, 0], [0, 0]], "wins: no comparison given"),
    ],
)
def test_impossible_counts_are_refused(wins: object, message: str) -> None:
    for door in (pair_counts, tournaments):
        with pytest.raises(InputError, match=message):
            door(wins)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("wins", "message"),
    [
        ([[0, 2], [0, 0]], r"wins: 2 at \[0, 1\] given, 0 or 1 accepted: repeats and ties go"),
        ([[0, 0.5], [0.5, 0]], r"wins: 0.5 at \[0, 1\] given, 0 or 1 accepted"),
        ([[0, 1], [1, 0]], r"wins: entry \[0, 1\] and its mirror image are both 1, exactly one"),
        ([ORDER, [[0, 1, 1], [0, 0, 0], [0, 0, 0]]], r"wins: entry \[1, 1, 2\] .* are both 0"),
    ],
)
def test_incomplete_tournaments_are_refused(wins: object, message: str) -> None:
    pair_counts(wins)  # type: ignore[arg-type]  # good enough for a scale
    with pytest.raises(InputError, match=message):
        tournaments(wins)  # type: ignore[arg-type]


def test_items_have_different_names() -> None:
    assert item_names(None, 3) == ("1", "2", "3")
    for wrong in (["a", "b"], ["a", "b", "a"]):
        with pytest.raises(InputError, match=r"items: \[.*\] given, 3 different names accepted"):
            item_names(wrong, 3)


def test_table_is_counted_whatever_side_an_item_was_on() -> None:
    data = pair_data(
        answers(
            ("p2", "b", "a", "a"),
            ("p1", "a", "b", "b"),
            ("p1", "a", "b", "a"),
            ("p1", "c", "a", "neither"),
            ("p1", "c", "b", None),
        ),
        tie="neither",
    )
    assert (data.participants, data.items, data.unanswered) == (("p1", "p2"), ("a", "b", "c"), 1)
    assert data.wins.tolist() == [
        [[0, 1, 0.5], [1, 0, 0], [0.5, 0, 0]],
        [[0, 1, 0], [0, 0, 0], [0, 0, 0]],
    ]
    assert not data.complete.any()


def test_order_of_items_and_participants_is_as_given() -> None:
    data = pair_data(answers(("p", "a", "b", "b")), items=["c", "b", "a"], participants=["q", "p"])
    assert data.wins[1].tolist() == [[0, 0, 0], [0, 0, 1], [0, 0, 0]]
    assert not data.wins[0].any()


def test_numbered_items_survive_a_missing_answer() -> None:
    # A missing answer makes the column a float one: "1.0" is still item 1.
    data = pair_data(answers((7, 1, 2, 1), (7, 2, 3, None), (8, 1, 2, 2)))
    assert data.items == ("1", "2")
    assert data.wins.tolist() == [[[0, 1], [0, 0]], [[0, 0], [1, 0]]]


GOOD = ("p", "a", "b", "a")


@pytest.mark.parametrize(
    ("table", "options", "message"),
    [
        (answers(GOOD).drop(columns="chosen"), {}, "table: the column chosen is missing"),
        (answers(), {}, "table: nothing to analyse, there is no answer"),
        (answers(("p", "a", "b", None)), {}, "table: nothing to analyse"),
        (answers(("p", None, "b", "b")), {}, "table: participant, item_a and item_b accepted in"),
        (answers(("p", "a", "a", "a")), {}, "item_a, item_b: 'a' is compared with itself"),
        (answers(("p", "a", "b", "c")), {}, "chosen: 'c' given, 'a' or 'b' accepted$"),
        (answers(("p", "a", "b", "x")), {"tie": "tie"}, r"'a' or 'b' accepted \(or 'tie'\)"),
        (answers(GOOD), {"tie": "a"}, "tie: 'a' is the name of an item"),
        (answers(GOOD), {"items": ["a", "c"]}, r"items: 'b' found, one of \['a', 'c'\] accepted"),
        (answers(GOOD), {"items": ["a", "b", "b"]}, "items: .* given, different names accepted"),
        (answers(GOOD), {"participants": ["q"]}, r"participants: 'p' found, one of \['q'\]"),
    ],
)
def test_impossible_tables_are_refused(
    table: pd.DataFrame, options: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        pair_data(table, **options)  # type: ignore[arg-type]


def test_complete_tournaments_leave_out_who_missed_repeated_or_tied_a_pair() -> None:
    rows = [
        *complete("good"),
        *complete("missed")[:2],
        *complete("repeated"),
        *complete("repeated")[:1],
        *complete("tied")[:2],
        ("tied", "c", "a", "tie"),
    ]
    (wins,), left_out = complete_tournaments(answers(*rows), tie="tie")
    assert left_out == ("missed", "repeated", "tied")
    assert wins.tolist() == [ORDER]


def test_conditions_split_a_participants_answers() -> None:
    first = answers(*complete("p"), *complete("q")).assign(angle=0)
    second = answers(*complete("p"), *complete("q")[:2]).assign(angle=60)
    conditions, left_out = complete_tournaments(pd.concat([first, second]), ["angle"])
    assert [wins.tolist() for wins in conditions] == [[ORDER], [ORDER]]
    assert left_out == ("q",)
    with pytest.raises(InputError, match="table: the column scene is missing"):
        complete_tournaments(first, ["scene"])
