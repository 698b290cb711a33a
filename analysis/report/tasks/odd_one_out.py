"""Which object differs? Thresholds, hit rates, salience and times."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, ClassVar, Final, TypeVar

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.answers.participants import join_demographics
from analysis.answers.trials import trial_table
from analysis.rates.effects import Effects, hit_effects, time_effects
from analysis.rates.hits import HitRates, hit_rates
from analysis.rates.salience import Salience, object_salience
from analysis.rates.times import AnswerTimes, answer_times
from analysis.report.study_analysis import Collected, StudyAnalysis
from analysis.thresholds.by_condition import GroupThreshold, condition_splits, group_thresholds
from analysis.thresholds.condition_differences import ConditionDifferences, condition_differences
from experiments.study import Study
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Result = TypeVar("Result")

_ADAPTIVE: Final = (
    "the design is adaptive, so the answers chose the levels and hit rates are not tested"
)


@dataclass(frozen=True)
class OddOneOutAnalysis(StudyAnalysis):
    """The results of a study of odd ones out.

    Attributes
    ----------
    thresholds
        For all trials, each condition and the conditions crossed.
    hits
        Hit rates by level alone, by level and each condition, and by level and all conditions.
    salience, times
        None where there are no controls, or no times.
    differences
        The thresholds of the values of each condition compared with each other.
    hit_effects, time_effects
        What hit rates and times depend on: the level, the conditions, and what participants said
        of themselves; None where it cannot be told.
    not_told
        Why, by the name of the result.
    """

    thresholds: tuple[GroupThreshold, ...]
    hits: tuple[HitRates, ...]
    salience: Salience | None
    times: AnswerTimes | None
    differences: tuple[ConditionDifferences, ...]
    hit_effects: Effects | None
    time_effects: Effects | None
    not_told: dict[str, str]

    template: ClassVar[str] = "odd-one-out"

    @property
    def overall(self) -> GroupThreshold:
        """The thresholds over all trials."""
        return self.thresholds[0]

    def hits_of(self, group: GroupThreshold) -> pd.DataFrame:
        """Return the hit rates of a group by level: what its psychometric function fits."""
        by = ("level", *group.conditions)
        table = next(rates.table for rates in self.hits if rates.by == by)
        for name, value in group.conditions.items():
            table = table[table[name].astype(str) == value]
        return table

    def findings(self) -> Mapping[str, object]:
        """Return the results by name, for JSON."""
        return {
            "level": self.study.stimuli.level,
            "level_unit": self.study.stimuli.level_unit,
            "thresholds": [{"group": group.label, **vars(group)} for group in self.thresholds],
            "hit_rates": self.hits[-1],
            "salience": self.salience,
            "times": self.times,
            "differences": self.differences,
            "hit_effects": self.hit_effects,
            "time_effects": self.time_effects,
            "not_told": self.not_told,
        }

    def sentences(self) -> list[str]:
        """Return the results in plain sentences."""
        from analysis.report.verdict import verdict  # it tells of this class

        return verdict(self)

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables that are written beside a report, by name."""
        tables = {
            "thresholds": pd.DataFrame([group.row() for group in self.thresholds]),
            "hit-rates": self.hits[-1].to_frame(),
        }
        limits = [
            limit.to_frame().assign(group=group.label)
            for group in self.thresholds
            for limit in (group.at_chance, group.at_chance_by_participant)
            if limit is not None
        ]
        if limits:
            tables["chance"] = pd.concat(limits, ignore_index=True)
        if self.salience is not None:
            tables["salience"] = self.salience.to_frame()
            tables["salience-fall"] = self.salience.fall
        if self.times is not None:
            tables["times"] = self.times.to_frame()
        if self.differences:
            parts = [each.to_frame() for each in self.differences]
            tables["threshold-differences"] = pd.concat(parts, ignore_index=True)
        if self.hit_effects is not None:
            tables["hit-effects"] = self.hit_effects.to_frame()
        if self.time_effects is not None:
            tables["time-effects"] = self.time_effects.to_frame()
        return tables

    def figures(self) -> "dict[str, Figure]":
        """Return every figure that the answers allow, by name."""
        from analysis.figures.odd_one_out import odd_one_out_figures  # they tell of this class

        return odd_one_out_figures(self)


def trials(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return `analysis.trial_table`."""
    return trial_table(responses, study, stimuli)


def analyse(collected: Collected) -> OddOneOutAnalysis:
    """Compute thresholds and their differences, hit rates, effects, salience and times."""
    # One generator a result: adding one changes no other.
    for_hits, for_salience, for_times, for_differences = np.random.default_rng(
        collected.seed
    ).spawn(4)
    study, table = collected.study, collected.trials
    conditions, guess_rate = study.stimuli.conditions, study.guess_rate
    answered = table["answer"].notna()
    has_controls = bool((table["control"] & answered).any())
    has_times = bool((table["reaction_time_s"].notna() & answered).any())
    split, objects = conditions[:1], collected.stimuli.objects
    known = join_demographics(table, collected.sessions)
    said = [name for name in known.columns if name not in table.columns]
    not_told: dict[str, str] = {}

    def attempt(name: str, compute: Callable[[], Result]) -> Result | None:
        try:
            return compute()
        except InputError as error:
            not_told[name] = str(error)
            return None

    adaptive = study.design.is_adaptive
    if adaptive:
        not_told |= {"largest level at chance": _ADAPTIVE, "effects on the hit rate": _ADAPTIVE}
    factors = ["level", *conditions, *said]
    differences = [
        attempt(
            f"thresholds by {name}",
            partial(
                condition_differences,
                table,
                name,
                guess_rate,
                generator,
                levels_fixed=not study.design.is_adaptive,
            ),
        )
        for name, generator in zip(conditions, for_differences.spawn(len(conditions)), strict=True)
    ]
    return OddOneOutAnalysis(
        **vars(collected),
        thresholds=group_thresholds(table, conditions, guess_rate, levels_fixed=not adaptive),
        hits=tuple(
            hit_rates(table, ("level", *names), guess_rate, for_hits)
            for names in condition_splits(conditions)
        ),
        salience=object_salience(table, objects, split, for_salience) if has_controls else None,
        times=answer_times(table, ("level", *split), for_times) if has_times else None,
        differences=tuple(each for each in differences if each is not None),
        hit_effects=(
            None if adaptive else attempt("hit rate", lambda: hit_effects(known, factors))
        ),
        time_effects=attempt("time per answer", lambda: time_effects(known, factors)),
        not_told=not_told,
    )
