"""Stochastic transitivity: whether the group's proportions can come from one scale.

If most prefer A to B, and most B to C, then most should prefer A to C (weak); by no less than the
smaller of the two majorities (moderate); by no less than the larger one (strong). Bradley-Terry and
Thurstone V imply all three. Proportions are estimates: near one half chance alone violates them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, permutations

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import software_version
from analysis.paired.pair_data import item_names, pair_counts

KINDS = ("weak", "moderate", "strong")


@dataclass(frozen=True)
class Transitivity:
    """Which triples of items violate stochastic transitivity.

    Attributes
    ----------
    table
        One row a triple of which every pair was compared: `first`, `second`, `third` (in the order
        that violates least), the proportions `first_over_second`, `second_over_third` and
        `first_over_third`, whether it is `weak`, `moderate`, `strong`, and by how much
        `first_over_third` falls `short_of_strong`.
    violations
        How many triples violate each kind.
    tested, untested
        How many triples there are, and how many more have a pair that was never compared.
    proportions
        Shape (t, t): how often the row's item was preferred; NaN where never compared.
    items, n, version
        Their names, the number of answers, and Trompe.
    """

    table: pd.DataFrame
    violations: dict[str, int]
    tested: int
    untested: int
    proportions: Matrix
    items: tuple[str, ...]
    n: float
    version: str
    method: str = "pooled proportions, no test of significance"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def transitivity(wins: ArrayLike, items: Sequence[str] | None = None) -> Transitivity:
    """Return which triples of items violate weak, moderate and strong stochastic transitivity.

    Parameters
    ----------
    wins
        Win counts, shape (n, t, t) or (t, t), t of 3 or more; half a win each for a tie. Pairs may
        be missing: their triples are not tested.
    items
        Their names; None: 1, 2, ...

    Raises
    ------
    InputError
        If shape or counts are impossible, or there are fewer than three items.

    Notes
    -----
    Tversky 1969, Psychological Review 76; for proportions of exactly one half the order that
    violates least is taken, as in Wickelmaier and Schmid 2004, Behavior Research Methods 36.
    """
    counts = pair_counts(wins).sum(axis=0)
    names = item_names(items, len(counts))
    if len(names) < 3:
        raise InputError("wins: 2 items given, 3 or more accepted (two make no triple)")
    answers = counts + counts.T
    share = np.divide(counts, answers, out=np.full_like(counts, np.nan), where=answers > 0)
    triples = list(combinations(range(len(names)), 3))
    known = [(a, b, c) for a, b, c in triples if answers[a, b] and answers[b, c] and answers[a, c]]
    table = pd.DataFrame(
        [_row(share, triple, names) for triple in known],
        columns=[
            *("first", "second", "third"),
            *("first_over_second", "second_over_third", "first_over_third"),
            *KINDS,
            "short_of_strong",
        ],
    )
    return Transitivity(
        table,
        {kind: int((~table[kind].astype(bool)).sum()) for kind in KINDS},
        len(known),
        len(triples) - len(known),
        share,
        names,
        float(counts.sum()),
        software_version(),
    )


def _row(share: Matrix, triple: tuple[int, ...], names: tuple[str, ...]) -> dict[str, object]:
    """Return a triple in that order, of those with two majorities, which violates least."""
    orders = [
        order
        for order in permutations(triple)
        if share[order[0], order[1]] >= 0.5 and share[order[1], order[2]] >= 0.5
    ]
    a, b, c = max(orders, key=lambda order: (sum(_holds(share, order)), share[order[0], order[2]]))
    largest = max(share[a, b], share[b, c])
    return {
        "first": names[a],
        "second": names[b],
        "third": names[c],
        "first_over_second": float(share[a, b]),
        "second_over_third": float(share[b, c]),
        "first_over_third": float(share[a, c]),
        **dict(zip(KINDS, _holds(share, (a, b, c)), strict=True)),
        "short_of_strong": float(max(0.0, largest - share[a, c])),
    }


def _holds(share: Matrix, order: tuple[int, ...]) -> tuple[bool, bool, bool]:
    a, b, c = order
    smaller, larger = sorted((share[a, b], share[b, c]))
    return bool(share[a, c] >= 0.5), bool(share[a, c] >= smaller), bool(share[a, c] >= larger)
