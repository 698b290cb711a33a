"""Thresholds of both kinds for a whole study and for each of its conditions."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import sum_by_participant
from analysis.estimates import Estimate
from analysis.thresholds.bayesian_fit import ThresholdFit, fit_threshold
from analysis.thresholds.chance import (
    ChanceLimit,
    largest_level_at_chance,
    largest_level_at_chance_by_participant,
)
from analysis.thresholds.over_participants import participant_interval


@dataclass(frozen=True)
class GroupThreshold:
    """What one group of trials says about the threshold.

    Attributes
    ----------
    conditions
        The factor levels that make the group; none for all trials.
    fit
        The mid-point of a psychometric function.
    over_participants
        Its value with the interval that allows for differing participants.
    at_chance, at_chance_by_participant
        The largest level not distinguishable from chance: over answers, and (for two participants
        or more) over participants; None where the answers chose the levels.
    """

    conditions: Mapping[str, str]
    fit: ThresholdFit
    over_participants: Estimate
    at_chance: ChanceLimit | None
    at_chance_by_participant: ChanceLimit | None

    @property
    def label(self) -> str:
        """The group in words, such as `front, shiny`."""
        return ", ".join(self.conditions.values()) or "all"

    def row(self) -> dict[str, object]:
        """Return the row of a table of thresholds."""
        return {
            "group": self.label,
            **self.conditions,
            **self.fit.row(),
            "threshold_low_over_participants": self.over_participants.low,
            "threshold_high_over_participants": self.over_participants.high,
            "largest_level_at_chance": _level(self.at_chance),
            "largest_level_at_chance_by_participant": _level(self.at_chance_by_participant),
        }


def _level(limit: ChanceLimit | None) -> float | None:
    return None if limit is None else limit.level


def group_thresholds(
    table: pd.DataFrame,
    conditions: Sequence[str],
    guess_rate: float,
    *,
    levels_fixed: bool = True,
) -> tuple[GroupThreshold, ...]:
    """Compute the thresholds of all trials, of each condition, and of the conditions crossed.

    Parameters
    ----------
    table
        As from `analysis.trial_table`; controls and trials without an answer do not count.
    conditions
        The factors that split the analysis.
    guess_rate
        The share of right answers by chance.
    levels_fixed
        Whether the design, not the answers, chose the levels. The mid-point is told either way,
        as the likelihood of answers does not depend on why a level was shown; rates at a level
        are no estimates where those who erred there were led away from it or back.

    Raises
    ------
    InputError
        If there are scored answers at fewer than two levels. A condition of which that is true is
        left out.
    """
    scored = table[table["correct"].notna()]
    if scored["level"].nunique() < 2:
        raise InputError("nothing to analyse yet: right or wrong answers at fewer than two levels")
    return tuple(
        _threshold_of(labels, trials, guess_rate, levels_fixed=levels_fixed)
        for labels, trials in _groups(scored, conditions)
        if trials["level"].nunique() >= 2
    )


def condition_splits(conditions: Sequence[str]) -> list[tuple[str, ...]]:
    """Return how an analysis is split: not at all, by each condition, by all of them crossed.

    >>> condition_splits(("placement", "material"))
    [(), ('placement',), ('material',), ('placement', 'material')]
    """
    crossed = [tuple(conditions)] if len(conditions) > 1 else []
    return [(), *((name,) for name in conditions), *crossed]


def _groups(
    table: pd.DataFrame, conditions: Sequence[str]
) -> Iterator[tuple[dict[str, str], pd.DataFrame]]:
    for names in condition_splits(conditions):
        if not names:
            yield {}, table
            continue
        for values, trials in table.groupby(list(names), observed=True, sort=True):
            yield dict(zip(names, map(str, values), strict=True)), trials


def _threshold_of(
    conditions: Mapping[str, str], trials: pd.DataFrame, guess_rate: float, *, levels_fixed: bool
) -> GroupThreshold:
    sums = sum_by_participant(trials, "correct", ["level"])
    levels = sums.cells["level"].to_numpy()
    fit = fit_threshold(levels, sums.totals.sum(axis=0), sums.counts.sum(axis=0), guess_rate)
    return GroupThreshold(
        conditions=conditions,
        fit=fit,
        over_participants=participant_interval(fit, sums.totals, sums.counts),
        at_chance=(
            largest_level_at_chance(levels, fit.correct, fit.total, guess_rate)
            if levels_fixed
            else None
        ),
        at_chance_by_participant=(
            largest_level_at_chance_by_participant(levels, sums.totals, sums.counts, guess_rate)
            if levels_fixed and len(sums.totals) > 1
            else None
        ),
    )
