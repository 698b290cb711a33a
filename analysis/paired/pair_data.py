"""Paired comparisons in canonical form: arrays of wins, and how a table of answers becomes one.

An observer's wins are a t x t array: entry [i, j] says how often item i was preferred to item j.
Several observers make an n x t x t array. Two kinds pass the door:

- a *tournament* has every pair once: exactly one of [i, j] and [j, i] is 1. Consistency, agreement
  and score groups need it (`tournaments`);
- *counts* may have missing pairs, repeats and ties (half a win each): scales and stochastic
  transitivity take them (`pair_counts`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError
from analysis.bootstrap import Matrix

Tournaments = NDArray[np.int64]


def pair_counts(wins: ArrayLike) -> Matrix:
    """Check win counts and return them by observer.

    Parameters
    ----------
    wins
        Shape (t, t) or (n, t, t), t of 2 or more: whole numbers of 0 or more, or halves for ties;
        zero on the diagonal.

    Returns
    -------
    numpy.ndarray
        Shape (n, t, t), n = 1 for a single array.

    Raises
    ------
    InputError
        If shape or counts are impossible, or there is no comparison at all.
    """
    try:
        counts = np.asarray(wins, dtype=float)
    except (TypeError, ValueError):
        raise InputError("wins: an array of numbers accepted") from None
    if counts.ndim not in (2, 3) or counts.shape[-1] != counts.shape[-2] or not len(counts):
        raise InputError(
            f"wins: shape {counts.shape} given, (items, items) or (observers, items, items)"
            " accepted"
        )
    if counts.shape[-1] < 2:
        raise InputError("wins: 1 item given, 2 or more accepted")
    possible = np.isfinite(counts) & (counts >= 0) & (np.rint(counts * 2) == counts * 2)
    _refuse(counts, ~possible, "whole numbers of 0 or more, or halves for ties, accepted")
    on_diagonal = np.eye(counts.shape[-1], dtype=bool) & (counts != 0)
    _refuse(counts, on_diagonal, "0 accepted: an item is not compared with itself")
    if not counts.any():
        raise InputError("wins: no comparison given, one or more accepted")
    return counts if counts.ndim == 3 else counts[None]


def tournaments(wins: ArrayLike) -> Tournaments:
    """Check complete paired comparisons and return them by observer.

    Parameters
    ----------
    wins
        Shape (t, t) or (n, t, t), t of 2 or more: 1 where the row's item was preferred to the
        column's, 0 elsewhere; every pair exactly once.

    Returns
    -------
    numpy.ndarray
        Shape (n, t, t), int64.

    Raises
    ------
    InputError
        If shape or entries are impossible, or a pair is missing, repeated or tied.
    """
    given = pair_counts(wins)
    by_observer = np.ndim(wins) == 3
    shown = given if by_observer else given[0]
    _refuse(
        shown,
        ~np.isin(shown, (0, 1)),
        "0 or 1 accepted: repeats and ties go into scales only (scale_pairs)",
    )
    answers = shown + np.swapaxes(shown, -1, -2)
    wrong = (answers != 1) & ~np.eye(given.shape[-1], dtype=bool)
    if wrong.any():
        place = _first(wrong)
        both = "both 1" if answers[place] == 2 else "both 0"
        raise InputError(
            f"wins: entry {_text(place)} and its mirror image are {both}, exactly one of them"
            " accepted as 1 (missing pairs go into scales only: scale_pairs)"
        )
    return given.astype(np.int64)


def item_names(items: Sequence[str] | None, number: int) -> tuple[str, ...]:
    """Check the items' names; without any they are called 1, 2, ...

    Raises
    ------
    InputError
        If there are not as many different names as items.
    """
    names = tuple(str(k + 1) for k in range(number)) if items is None else tuple(map(str, items))
    if len(names) != number or len(set(names)) != number:
        raise InputError(f"items: {list(names)} given, {number} different names accepted")
    return names


def _refuse(counts: Matrix, wrong: NDArray[np.bool_], accepted: str) -> None:
    if wrong.any():
        place = _first(wrong)
        raise InputError(f"wins: {counts[place]:g} at {_text(place)} given, {accepted}")


def _first(wrong: NDArray[np.bool_]) -> tuple[int, ...]:
    return tuple(int(k) for k in np.argwhere(wrong)[0])


def _text(place: tuple[int, ...]) -> str:
    return f"[{', '.join(map(str, place))}]"


@dataclass(frozen=True)
class PairData:
    """Wins by observer, from a table of answers.

    Attributes
    ----------
    wins
        Shape (n, t, t): how often the row's item was preferred to the column's; half a win each
        for a tie.
    participants, items
        Their names, in the order of the array.
    unanswered
        Rows without an answer, which count nowhere.
    """

    wins: Matrix
    participants: tuple[str, ...]
    items: tuple[str, ...]
    unanswered: int

    @property
    def complete(self) -> NDArray[np.bool_]:
        """Who compared every pair once and without a tie, shape (n,)."""
        answers = self.wins + np.swapaxes(self.wins, 1, 2)
        irregular = np.triu((answers != 1) | (self.wins % 1 != 0), k=1)
        return np.asarray(~irregular.any(axis=(1, 2)))


def pair_data(
    table: pd.DataFrame,
    *,
    participant: str = "participant",
    item_a: str = "item_a",
    item_b: str = "item_b",
    chosen: str = "chosen",
    tie: str | None = None,
    items: Sequence[str] | None = None,
    participants: Sequence[str] | None = None,
) -> PairData:
    """Count wins in a table with one row an answer.

    Parameters
    ----------
    table
        One row an answer; more columns do no harm.
    participant, item_a, item_b, chosen
        The names of the columns: who, the two items shown (in either order), and the name of the
        preferred one. A row without a `chosen` counts as unanswered.
    tie
        What `chosen` holds where neither is preferred: half a win each. None: ties are refused.
    items, participants
        All that may occur, in the wanted order; None: those that do, sorted.

    Raises
    ------
    InputError
        If the table is empty, a column or a name is missing, an item is compared with itself, the
        chosen item was not shown, or an item or participant is unknown.
    """
    columns = (participant, item_a, item_b, chosen)
    missing = [name for name in columns if name not in table.columns]
    if missing:
        raise InputError(f"table: the column {missing[0]} is missing")
    answered = table[table[chosen].notna()]
    if answered.empty:
        raise InputError("table: nothing to analyse, there is no answer")
    if answered[list(columns)].isna().to_numpy().any():
        raise InputError(f"table: {participant}, {item_a} and {item_b} accepted in every row")
    # A missing answer turns whole numbers into floats: item 1 would be chosen as "1.0".
    who, first, second, preferred = (
        answered[name].convert_dtypes().astype(str) for name in columns
    )
    names = _known("items", items, pd.concat([first, second]))
    if tie in names:
        raise InputError(f"tie: {tie!r} is the name of an item, another word accepted")
    people = _known("participants", participants, who)
    _check_answers(first, second, preferred, tie)
    rows = _places(who, people)
    one, other = _places(first, names), _places(second, names)
    half_win = 0.5 * (preferred == tie).to_numpy()
    wins = np.zeros((len(people), len(names), len(names)))
    np.add.at(wins, (rows, one, other), np.maximum(half_win, preferred == first))
    np.add.at(wins, (rows, other, one), np.maximum(half_win, preferred == second))
    return PairData(wins, tuple(people), tuple(names), len(table) - len(answered))


def complete_tournaments(
    table: pd.DataFrame,
    within: Sequence[str] = (),
    items: Sequence[str] | None = None,
    tie: str | None = None,
) -> tuple[list[Tournaments], tuple[str, ...]]:
    """Return the tournaments of all participants who compared every pair once.

    Parameters
    ----------
    table, items, tie
        As in `pair_data`.
    within
        The columns whose values split a participant's answers into several tournaments, such as
        ``["angle"]``.

    Returns
    -------
    conditions : list of numpy.ndarray
        For each combination of those values: shape (n, t, t), of the same n participants.
    left_out : tuple of str
        Participants who miss a pair, repeated or tied one.

    Raises
    ------
    InputError
        As `pair_data`, or if a column is missing.
    """
    missing = [name for name in within if name not in table.columns]
    if missing:
        raise InputError(f"table: the column {missing[0]} is missing")
    everything = pair_data(table, items=items, tie=tie)
    people = everything.participants
    parts = [part for _, part in table.groupby(list(within), observed=True)] if within else [table]
    conditions = [
        pair_data(part, items=everything.items, participants=people, tie=tie) for part in parts
    ]
    kept = np.logical_and.reduce([condition.complete for condition in conditions])
    return (
        [condition.wins[kept].astype(np.int64) for condition in conditions],
        tuple(name for name, keep in zip(people, kept, strict=True) if not keep),
    )


def _known(argument: str, accepted: Sequence[str] | None, found: pd.Series) -> list[str]:
    """Return the names in their order, all of those found being among them."""
    if accepted is None:
        return sorted(map(str, found.unique()))
    names = [str(name) for name in accepted]
    unknown = sorted(set(map(str, found.unique())) - set(names))
    if unknown:
        raise InputError(f"{argument}: {unknown[0]!r} found, one of {names} accepted")
    if len(set(names)) < len(names):
        raise InputError(f"{argument}: {names} given, different names accepted")
    return names


def _places(values: pd.Series, names: list[str]) -> NDArray[np.int64]:
    return np.asarray(pd.Index(names).get_indexer(pd.Index(values)), dtype=np.int64)


def _check_answers(first: pd.Series, second: pd.Series, chosen: pd.Series, tie: str | None) -> None:
    same = first == second
    if same.any():
        raise InputError(
            f"item_a, item_b: {first[same].iloc[0]!r} is compared with itself, two different items"
            " accepted"
        )
    wrong = (chosen != first) & (chosen != second)
    if tie is not None:
        wrong &= chosen != tie
    if wrong.any():
        place = int(wrong.to_numpy().argmax())
        raise InputError(
            f"chosen: {chosen.iloc[place]!r} given, {first.iloc[place]!r} or"
            f" {second.iloc[place]!r} accepted{'' if tie is None else f' (or {tie!r})'}"
        )
