"""Consistency and agreement by condition, in the form of Lopez-Moreno 2011, table 7.2."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.estimates import software_version
from analysis.paired.agreement import agreement_over, smallest_agreement
from analysis.paired.consistency import chance_zeta, group_consistency, triads_p_value
from analysis.paired.pair_data import Tournaments, complete_tournaments, pair_data

# Lopez-Moreno 2011, table 7.2: 44 people, 3 items, 4 scenes x 4 light angles (deg).
PUBLISHED = (
    ("scene", "skull", 0.790, -0.068),
    ("scene", "vertebrae", 0.903, -0.047),
    ("scene", "dolphin", 0.966, 0.240),
    ("scene", "bull", 0.972, 0.249),
    ("angle_deg", "0", 0.903, 0.040),
    ("angle_deg", "60", 0.903, 0.044),
    ("angle_deg", "120", 0.909, 0.021),
    ("angle_deg", "180", 0.914, 0.020),
)
_PUBLISHED_OBSERVERS, _PUBLISHED_ITEMS, _PUBLISHED_CONDITIONS = 44, 3, 4
_ROUNDING = 0.0005
_NOT_TOLD_FROM_CHANCE = 0.05


@dataclass(frozen=True)
class AgreementTable:
    """Consistency and agreement in each condition.

    Attributes
    ----------
    table
        One row a value of `by`: the value; `participants`; `tournaments` (of all of them);
        `mean_zeta` with `mean_zeta_low` and `_high` over participants, `chance_zeta` and
        `zeta_p_value`; `u` with `u_low` and `u_high` over participants, `minimum_u`, and the exact
        `u_p_value`.
    by, within
        The column of the rows, and those that split a row into tournaments.
    dropped
        Participants left out because they did not answer every pair once, by value of `by`.
    version
        Of Trompe.
    """

    table: pd.DataFrame
    by: str
    within: tuple[str, ...]
    dropped: dict[str, tuple[str, ...]]
    version: str
    method: str = "Kendall's zeta and u, exact tests against coins; intervals over participants"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def agreement_table(
    table: pd.DataFrame,
    by: str,
    within: Sequence[str] = (),
    *,
    items: Sequence[str] | None = None,
    drop_incomplete: bool = False,
) -> AgreementTable:
    """Return mean zeta and u for each value of a column of the answers.

    Parameters
    ----------
    table
        One row an answer, with the columns `participant`, `item_a`, `item_b`, `chosen`, `by` and
        `within`.
    by
        The column whose values make the rows, such as `scene`.
    within
        The columns that split a participant's answers in a row into sets of all pairs, such as
        ``["angle"]``.
    items
        All items; None: those that occur.
    drop_incomplete
        Whether participants who did not answer every pair of a row once are left out of that row
        and listed; else they are refused.

    Raises
    ------
    InputError
        If a column is missing, the table is empty, an answer is impossible, a pair is missing,
        repeated or tied, or fewer than two participants are left.
    """
    missing = [name for name in (by, *within) if name not in table.columns]
    if missing:
        raise InputError(f"table: the column {missing[0]} is missing")
    if table.empty:
        raise InputError("table: nothing to analyse, there is no answer")
    everything = pair_data(table, items=items)
    rows: list[dict[str, object]] = []
    dropped: dict[str, tuple[str, ...]] = {}
    for value, answers in table.groupby(by, observed=True, sort=True):
        name = str(value)
        conditions, left_out = complete_tournaments(answers, within, everything.items)
        if left_out and not drop_incomplete:
            raise InputError(
                f"table: participant {left_out[0]} did not compare every pair once in {by} {name},"
                " once without a tie accepted (drop_incomplete leaves such participants out)"
            )
        dropped |= {name: left_out} if left_out else {}
        if len(conditions[0]) < 2:
            raise InputError(
                f"table: {len(conditions[0])} participants with every pair in {by} {name}, two or"
                " more accepted"
            )
        rows.append({by: name} | _row(conditions))
    return AgreementTable(pd.DataFrame(rows), by, tuple(within), dropped, software_version())


def published_agreement() -> pd.DataFrame:
    """Return table 7.2 as published, with remarks where a number needs one.

    Returns
    -------
    pandas.DataFrame
        `by`, `value`, `zeta`, `u`, `minimum_u` (the smallest possible), `possible`, `remark`.
    """
    return pd.DataFrame(
        [
            {"by": by, "value": value, "zeta": zeta, "u": u} | _published_remark(zeta, u)
            for by, value, zeta, u in PUBLISHED
        ]
    )


def _published_remark(zeta: float, u: float) -> dict[str, object]:
    smallest = smallest_agreement(_PUBLISHED_OBSERVERS)
    tournaments = _PUBLISHED_OBSERVERS * _PUBLISHED_CONDITIONS
    triads = round((1 - zeta) * tournaments)
    by_chance = triads_p_value(triads, _PUBLISHED_ITEMS, tournaments)
    remarks = []
    if u < smallest - _ROUNDING:
        remarks.append(
            f"u is impossible: of {_PUBLISHED_OBSERVERS} observers it is {smallest:.4f} or more"
        )
    if by_chance > _NOT_TOLD_FROM_CHANCE:
        coins = chance_zeta(_PUBLISHED_ITEMS)
        remarks.append(f"zeta is not told from the {coins:.2f} of coins (p = {by_chance:.2f})")
    return {
        "minimum_u": smallest,
        "possible": u >= smallest - _ROUNDING,
        "remark": "; ".join(remarks),
    }


def _row(conditions: list[Tournaments]) -> dict[str, object]:
    people = list(range(len(conditions[0]))) * len(conditions)
    zeta = group_consistency(np.concatenate(conditions), people)
    u = agreement_over(conditions)
    return {
        "participants": zeta.n,
        "tournaments": zeta.tournaments,
        **zeta.mean_zeta.columns("mean_zeta"),
        "chance_zeta": zeta.chance_zeta,
        "zeta_p_value": zeta.p_value,
        **u.u.columns("u"),
        "minimum_u": u.minimum,
        "u_p_value": u.p_value,
    }
