"""Which of two? Consistency, agreement, score groups and a scale of the items."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pandas as pd

from analysis.answers.comparison_tables import item_names, pair_table
from analysis.bootstrap import rate_intervals, sum_by_participant
from analysis.estimates import Estimate
from analysis.judgements.preference_pairs import Preferences, item_preferences
from analysis.multiplicity import Family, family
from analysis.naming import p_text
from analysis.paired.every_result import PairedAnalysis, analyse_pairs
from analysis.rates.times import AnswerTimes, answer_times
from analysis.report.study_analysis import Collected, StudyAnalysis
from experiments.study import Study
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST_TOLD = 3  # pairs that the verdict tells one by one


@dataclass(frozen=True)
class PairGroup:
    """What one group of pairs says: all of them, or those of one condition.

    Attributes
    ----------
    conditions
        The factor level that makes the group; none for all pairs.
    results
        Everything about its items.
    """

    conditions: Mapping[str, str]
    results: PairedAnalysis

    @property
    def label(self) -> str:
        """The group in words, such as `material matt`."""
        return ", ".join(f"{name} {level}" for name, level in self.conditions.items()) or "all"


@dataclass(frozen=True)
class TwoAlternativeAnalysis(StudyAnalysis):
    """The results of a study of pairs.

    Attributes
    ----------
    groups
        All pairs, then those of each condition.
    agreement_tests
        The tests of agreement of the conditions, corrected for their number; None without any.
    preferences
        How often the first of every two items was preferred, tested against one half and against
        the margin of equivalence that the study declares; of two items alone, in each cell of the
        conditions.
    first_place
        The share of answers for the image in the first place, with its interval over participants:
        one half if places do not matter.
    times
        None where there are none.
    """

    groups: tuple[PairGroup, ...]
    agreement_tests: Family | None
    preferences: Preferences
    first_place: Estimate
    times: AnswerTimes | None

    template: ClassVar[str] = "two-alternative"

    @property
    def overall(self) -> PairedAnalysis:
        """The results over all pairs."""
        return self.groups[0].results

    @property
    def corrected(self) -> dict[str, float]:
        """The corrected p-values of the tests of agreement, by the label of the group."""
        if self.agreement_tests is None:
            return {}
        table = self.agreement_tests.table
        return dict(zip(table["test"], table["p_holm"], strict=True))

    def findings(self) -> Mapping[str, object]:
        """Return the results by name, for JSON."""
        return {
            "item": self.study.stimuli.item,
            "items": self.overall.items,
            "groups": [{"group": group.label, **vars(group)} for group in self.groups],
            "agreement_tests": self.agreement_tests,
            "preferences": self.preferences,
            "first_place": self.first_place,
            "times": self.times,
        }

    def sentences(self) -> list[str]:
        """Return the results in plain sentences."""
        who = "Simulated observers, not people," if self.simulated else "People"
        told = [
            *_about_scale(who, self.overall),
            *_about_agreement(self.overall),
            *_about_groups(self.overall),
            *_about_preferences(self.preferences),
        ]
        share = self.first_place
        told.append(
            f"The first of two places was chosen in {100 * share.value:.1f} % of the answers, 95 %"
            f" interval {100 * share.low:.1f} to {100 * share.high:.1f} %."
        )
        if self.times is not None:
            told.append(f"The median answer took {self.times.median_s:.1f} s.")
        return told

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables that are written beside a report, by name."""
        tables = {
            "consistency": _collect(self.groups, lambda each: each.consistency),
            "agreement": _collect(self.groups, lambda each: each.agreement),
            "score-groups": _collect(self.groups, lambda each: each.groups),
            "scale": _collect(self.groups, lambda each: each.scale),
            "preferences": self.preferences.to_frame(),
            "transitivity": _collect(
                self.groups, lambda each: each.transitivity and each.transitivity.table
            ),
        }
        scale = self.overall.scale
        if scale is not None:
            tables["scale-differences"] = scale.differences
        if self.agreement_tests is not None:
            tables["agreement-tests"] = self.agreement_tests.to_frame()
        if self.times is not None:
            tables["times"] = self.times.to_frame()
        return {name: table for name, table in tables.items() if not table.empty}

    def figures(self) -> "dict[str, Figure]":
        """Return every figure that the answers allow, by name."""
        from analysis.figures.two_alternative import two_alternative_figures  # they tell of this

        return two_alternative_figures(self)


def trials(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return `analysis.answers.comparison_tables.pair_table`."""
    return pair_table(responses, study, stimuli)


def analyse(collected: Collected) -> TwoAlternativeAnalysis:
    """Compute the results of all pairs and of each condition."""
    study, table = collected.study, collected.trials
    for_place, for_times, *for_groups = np.random.default_rng(collected.seed).spawn(
        3 + sum(table[name].nunique() for name in study.stimuli.conditions)
    )
    items = item_names(study, collected.stimuli)
    groups = tuple(
        PairGroup(
            conditions,
            analyse_pairs(
                part,
                generator,
                within=[*(n for n in study.stimuli.within if n not in conditions), "repeat"],
                items=items,
            ),
        )
        for (conditions, part), generator in zip(
            condition_parts(_with_repeats(table, study.stimuli.within), study.stimuli.conditions),
            for_groups,
            strict=False,
        )
    )
    answered = table[table["answer"].notna()]
    return TwoAlternativeAnalysis(
        **vars(collected),
        groups=groups,
        agreement_tests=_agreement_tests(groups[1:]),
        preferences=item_preferences(
            table,
            items,
            study.stimuli.conditions if len(items) == 2 else (),
            margin=study.analysis.equivalence_margin,
        ),
        first_place=_first_place(answered, for_place),
        times=answer_times(answered.assign(every="pair"), ["every"], for_times)
        if answered["reaction_time_s"].notna().any()
        else None,
    )


def _with_repeats(table: pd.DataFrame, within: Sequence[str]) -> pd.DataFrame:
    """Count how often a participant has compared the same pair before."""
    both = zip(table["item_a"], table["item_b"], strict=True)
    pair = [repr(sorted(items)) for items in both]
    counted = table.assign(pair=pair)
    keys = ["participant", *within, "pair"]
    return table.assign(repeat=counted.groupby(keys, observed=True).cumcount())


def condition_parts(
    table: pd.DataFrame, conditions: Sequence[str]
) -> Iterator[tuple[dict[str, str], pd.DataFrame]]:
    """Yield the whole table, then its part for each level of each condition."""
    yield {}, table
    for name in conditions:
        for level, part in table.groupby(name, observed=True):
            yield {name: str(level)}, part


def _agreement_tests(groups: Sequence[PairGroup]) -> Family | None:
    p_values = {
        group.label: group.results.agreement.p_value
        for group in groups
        if group.results.agreement is not None
    }
    return family("agreement by condition", p_values) if p_values else None


def _first_place(answered: pd.DataFrame, generator: np.random.Generator) -> Estimate:
    chosen = answered.assign(first=answered["answer"].astype(float) == 1, every="pair")
    sums = sum_by_participant(chosen, "first", ["every"])
    low, high, _ = rate_intervals(sums, generator)
    return Estimate(float(sums.means[0]), float(low[0]), float(high[0]))


def _about_scale(who: str, results: PairedAnalysis) -> list[str]:
    scale = results.scale
    if scale is None:
        return [f"The items have no scale: {results.left_out['scale']}."]
    table = scale.table.sort_values("jod", ascending=False)
    order = ", ".join(
        f"{row['item']} {row['jod']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"
        for row in table.to_dict("records")
    )
    apart = scale.differences[(scale.differences["low"] > 0) | (scale.differences["high"] < 0)]
    told = [
        f"{who} place the items, best first, at {order} ({scale.unit}; zero is the"
        f" {'mean' if scale.anchor == 'mean' else scale.anchor}; 95 % intervals)."
    ]
    if len(scale.differences) > 1:
        told.append(
            f"{len(apart)} of {len(scale.differences)} pairs of items lie apart by an interval that"
            " does not hold zero."
        )
    return told


def _about_agreement(results: PairedAnalysis) -> list[str]:
    told = []
    if results.consistency is not None:
        zeta = results.consistency
        told.append(
            f"The mean coefficient of consistency is {zeta.mean_zeta.value:.3f}, where coins give"
            f" {zeta.chance_zeta:.3f} (p {p_text(zeta.p_value)})."
        )
    if results.agreement is not None:
        u = results.agreement
        told.append(
            f"The coefficient of agreement u is {u.u.value:.3f} (from {u.minimum:.3f} to 1;"
            f" p {p_text(u.p_value)} if every answer were a coin's, {u.p_method})."
        )
    return told


def _about_groups(results: PairedAnalysis) -> list[str]:
    groups = results.groups
    if groups is None:
        return [f"There are no score groups: {results.left_out['groups']}."]
    if groups.critical is None:
        return [groups.remark]
    listed = "; ".join(f"{{{', '.join(group)}}}" for group in groups.groups)
    return [
        f"Scores that differ by {groups.critical} or more of {groups.largest_difference} differ"
        f" significantly (alpha {groups.alpha:g}); the groups that do not are: {listed}."
        " Items of one group are not shown to be equal."
    ]


def _about_preferences(found: Preferences) -> list[str]:
    """Tell a few pairs one by one, and how many of many there are of each outcome."""
    if len(found.results) <= _MOST_TOLD:
        return found.sentences
    outcomes = [each.outcome for each in found.results]
    margin = found.results[0].margin
    equivalent = (
        "no margin of equivalence was declared"
        if margin is None
        else f"{outcomes.count('equivalent')} are equivalent within the margin of"
        f" {100 * margin:g} percentage points"
    )
    return [
        f"Of {len(outcomes)} pairs of items {outcomes.count('differs')} differ from one half"
        f" (Holm's correction, alpha {found.results[0].alpha:g}); {equivalent};"
        f" {outcomes.count('undecided')} are undecided, which does not show that they are equal."
    ]


def _collect(
    groups: Sequence[PairGroup], result: Callable[[PairedAnalysis], object]
) -> pd.DataFrame:
    """Return one kind of result of every group in one table."""
    parts = []
    for group in groups:
        found = result(group.results)
        if found is not None:
            table = found if isinstance(found, pd.DataFrame) else found.to_frame()  # type: ignore[attr-defined]
            parts.append(table.assign(group=group.label))
    return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()
