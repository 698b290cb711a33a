"""Preferences in several pairs, tested together (the form of Lopez-Moreno 2011, figure 8.17)."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import sum_by_participant
from analysis.judgements.preference import ALPHA, Preference, preference
from analysis.multiplicity import holm


@dataclass(frozen=True)
class Preferences:
    """Several pairs, tested together.

    Attributes
    ----------
    cells
        One row a pair: the factor levels that make it.
    results
        One a pair.
    """

    cells: pd.DataFrame
    results: tuple[Preference, ...]

    @property
    def sentences(self) -> list[str]:
        """The results in plain words, each with the pair it is about."""
        cells = self.cells.drop(columns="pair", errors="ignore")  # the result says which two
        labels = [", ".join(map(str, cell)) for cell in cells.itertuples(index=False)]
        return [
            f"{label}: {result.sentence}" if label else result.sentence
            for label, result in zip(labels, self.results, strict=True)
        ]

    def to_frame(self) -> pd.DataFrame:
        """Return one row a pair."""
        rows = pd.DataFrame([result.row() for result in self.results])
        return pd.concat([self.cells, rows], axis=1)


def preferences(
    table: pd.DataFrame,
    by: Sequence[str],
    *,
    margin: float | None = None,
    alpha: float = ALPHA,
    names: tuple[str, str] = ("the first", "the second"),
    chosen: str = "chosen",
) -> Preferences:
    """Test several pairs together, in the form of Lopez-Moreno 2011, figure 8.17.

    Parameters
    ----------
    table
        One row an answer: `participant`, the columns `by`, and `chosen` (true or 1 where the first
        was preferred; rows without an answer are left out).
    by
        The columns that make the pairs, such as ``("style", "light")``.
    margin, alpha, names
        As in `preference`, for all pairs; the p-values are corrected for their number by Holm's
        method, differences and equivalences each as a family.
    chosen
        The name of that column.

    Raises
    ------
    InputError
        If a column is missing, nothing was answered, or an argument is impossible.
    """
    missing = [name for name in ("participant", *by, chosen) if name not in table]
    if missing:
        raise InputError(f"table: the column {missing[0]} is missing")
    if not by or table[chosen].notna().sum() == 0:
        raise InputError("table, by: answers, and one column or more that make the pairs, accepted")
    sums = sum_by_participant(table, chosen, by)
    results = [
        preference(yes, asked, margin=margin, alpha=alpha, names=names)
        for yes, asked in zip(sums.totals.T, sums.counts.T, strict=True)
    ]
    differences = holm([result.p_value for result in results])
    equivalences: list[float | None] = [None] * len(results)
    if margin is not None:
        equivalences = list(holm([result.p_equivalence or 0.0 for result in results]))
    corrected = tuple(
        replace(
            result,
            p_holm=float(difference),
            p_equivalence_holm=equivalence if equivalence is None else float(equivalence),
            tests=len(results),
        )
        for result, difference, equivalence in zip(results, differences, equivalences, strict=True)
    )
    return Preferences(sums.cells, corrected)


def item_preferences(
    table: pd.DataFrame,
    items: Sequence[str],
    by: Sequence[str] = (),
    *,
    margin: float | None = None,
    alpha: float = ALPHA,
) -> Preferences:
    """Test every two of some items, in each cell of other factors, all together.

    Parameters
    ----------
    table
        One row an answer: `participant`, `item_a`, `item_b`, `chosen` (one of the two; rows
        without an answer are left out) and the columns `by`.
    items
        Their names, in the order in which pairs are told; two or more.
    by
        The columns that split the answers, such as ``["light"]``.
    margin, alpha
        As in `preferences`.

    Returns
    -------
    Preferences
        Its cells have the column `pair`, such as `ours over theirs`, and the columns `by`; pairs
        that nobody answered are left out.

    Raises
    ------
    InputError
        As in `preferences`.
    """
    missing = [name for name in ("item_a", "item_b", "chosen") if name not in table]
    if missing:
        raise InputError(f"table: the column {missing[0]} is missing")
    pairs = {f"{first} over {second}": (first, second) for first, second in combinations(items, 2)}
    label_of = {frozenset(pair): label for label, pair in pairs.items()}
    shown = zip(table["item_a"], table["item_b"], strict=True)
    labels = [label_of.get(frozenset(pair)) for pair in shown]
    answered = table.assign(pair=pd.Categorical(labels, categories=list(pairs)))
    answered = answered[answered["chosen"].notna() & answered["pair"].notna()]
    first = answered["pair"].astype(str).map(lambda label: pairs[label][0])
    answered = answered.assign(first=answered["chosen"] == first)
    found = preferences(answered, ["pair", *by], margin=margin, alpha=alpha, chosen="first")
    named = [
        replace(result, names=pairs[str(label)])
        for label, result in zip(found.cells["pair"], found.results, strict=True)
    ]
    return Preferences(found.cells, tuple(named))
