"""The thresholds of every two values of a condition compared, with Holm's correction."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, sum_by_participant
from analysis.multiplicity import Family, family
from analysis.rates.factors import varies_within
from analysis.thresholds.sigmoid import Floats
from analysis.thresholds.threshold_difference import ThresholdDifference, threshold_difference


@dataclass(frozen=True)
class ConditionDifferences:
    """The differences of a condition's thresholds.

    Attributes
    ----------
    condition
        The factor.
    differences
        By pair, such as `front - back`.
    family
        Their tests together.
    left_out
        By value or pair: why there is no difference.
    """

    condition: str
    differences: dict[str, ThresholdDifference]
    family: Family
    left_out: dict[str, str]

    def to_frame(self) -> pd.DataFrame:
        """Return one row a pair, with raw and corrected p-values."""
        rows = pd.concat([one.to_frame() for one in self.differences.values()], ignore_index=True)
        return rows.assign(
            condition=self.condition,
            pair=list(self.differences),
            p_holm=self.family.table["p_holm"].to_numpy(),
        )


def condition_differences(
    table: pd.DataFrame,
    condition: str,
    guess_rate: float,
    generator: np.random.Generator,
    resamples: int = RESAMPLES,
    correct: float | None = None,
    *,
    levels_fixed: bool = True,
) -> ConditionDifferences:
    """Compare the thresholds of every two values of a condition.

    Parameters
    ----------
    table
        As from `analysis.trial_table`, for what participants are with
        `analysis.answers.participants.join_demographics`; controls and trials without an answer
        do not count.
    condition
        A factor with two values or more. If it varies within participants, those who answered at
        both values are compared with themselves; else the groups are.
    guess_rate, generator, resamples, correct
        As in `analysis.threshold_difference`.
    levels_fixed
        Whether the design, not the answers, chose the levels. Then only levels that were shown
        with both values count: others would set them apart. Where answers chose them, each
        value's levels lie around its own threshold, and all count.

    Raises
    ------
    InputError
        If the condition is unknown or no two of its values can be compared.
    """
    if condition not in table.columns:
        raise InputError(f"condition: {condition!r} given, a column of the table accepted")
    scored = table[table["correct"].notna() & table[condition].notna()]
    paired = varies_within(scored, condition)
    found: dict[str, ThresholdDifference] = {}
    left_out: dict[str, str] = {}
    values = [value for value, _ in scored.groupby(condition, observed=True, sort=True)]
    for first, second in combinations(values, 2):
        pair = f"{first!s} - {second!s}"
        try:
            levels, one, other = _counts(
                scored, condition, (first, second), paired=paired, levels_fixed=levels_fixed
            )
            found[pair] = threshold_difference(
                levels, one, other, guess_rate, generator, resamples, paired=paired, correct=correct
            )
        except InputError as error:
            left_out[pair] = str(error)
    if not found:
        reasons = "; ".join(f"{pair}: {why}" for pair, why in left_out.items())
        raise InputError(f"condition: no two values of {condition} to compare. {reasons}".strip())
    tests = family(f"thresholds by {condition}", {pair: one.p_value for pair, one in found.items()})
    return ConditionDifferences(condition, found, tests, left_out)


def _counts(
    scored: pd.DataFrame,
    condition: str,
    pair: tuple[object, object],
    *,
    paired: bool,
    levels_fixed: bool,
) -> tuple[Floats, tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Return the levels that count, and each value's counts there."""
    parts = [scored[scored[condition] == value] for value in pair]
    if paired:
        both = set(parts[0]["participant"]) & set(parts[1]["participant"])
        parts = [part[part["participant"].isin(both)] for part in parts]
    shown = [set(part["level"]) for part in parts]
    levels = sorted(shown[0] & shown[1] if levels_fixed else shown[0] | shown[1])
    if len(levels) < 2:
        raise InputError(f"levels: {len(levels)} shown with both, two or more accepted")
    one, other = (_at(part[part["level"].isin(levels)], levels) for part in parts)
    return np.array(levels, float), one, other


def _at(part: pd.DataFrame, levels: Sequence[float]) -> tuple[Floats, Floats]:
    """Return right answers and all answers by participant and level; 0 where there are none."""
    sums = sum_by_participant(part, "correct", ["level"])
    places = np.searchsorted(levels, sums.cells["level"].to_numpy(float))
    counts: tuple[Floats, Floats] = (
        np.zeros((len(sums.totals), len(levels))),
        np.zeros((len(sums.totals), len(levels))),
    )
    counts[0][:, places], counts[1][:, places] = sums.totals, sums.counts
    return counts
