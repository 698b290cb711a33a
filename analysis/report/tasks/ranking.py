"""In which order? Mean ranks, concordance, groups of items and a scale."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pandas as pd
from scipy import stats

from algorithms.errors import InputError
from analysis.answers.comparison_tables import item_names, rank_table
from analysis.multiplicity import Family, family
from analysis.naming import p_text
from analysis.ranking.mean_ranks import RankSummary, rank_summary
from analysis.ranking.plackett_luce import PlackettLuceScale, plackett_luce
from analysis.rates.times import AnswerTimes, answer_times
from analysis.report.study_analysis import Collected, StudyAnalysis
from analysis.report.tasks.two_alternative import condition_parts
from experiments.study import Study
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class RankingGroup:
    """What one group of rankings says: all of them, or those of one condition.

    Attributes
    ----------
    label
        The group in words, such as `scene vase`.
    summary
        Mean ranks, concordance and comparisons; None where the rankings do not allow it.
    scale
        None where a participant ranked several sets, or the rankings do not allow it.
    rankings
        How many each participant made; their ranks are averaged and ranked again if several.
    incomplete
        Participants without a rank for every item.
    left_out
        Why, by the name of the result.
    """

    label: str
    summary: RankSummary | None
    scale: PlackettLuceScale | None
    rankings: int
    incomplete: tuple[str, ...]
    left_out: dict[str, str]

    @property
    def stem(self) -> str:
        """The label as it stands in file names."""
        return re.sub(r"[^a-z0-9]+", "-", self.label.lower()).strip("-")


@dataclass(frozen=True)
class RankingAnalysis(StudyAnalysis):
    """The results of a study of rankings.

    Attributes
    ----------
    groups
        All rankings (if they are of the same items), then those of each condition.
    concordance_tests
        Friedman's tests of the conditions, corrected for their number; None without any.
    times
        None where there are none.
    """

    groups: tuple[RankingGroup, ...]
    concordance_tests: Family | None
    times: AnswerTimes | None

    template: ClassVar[str] = "ranking"

    @property
    def corrected(self) -> dict[str, float]:
        """The corrected p-values of the conditions' tests, by the label of the group."""
        if self.concordance_tests is None:
            return {}
        table = self.concordance_tests.table
        return dict(zip(table["test"], table["p_holm"], strict=True))

    def findings(self) -> Mapping[str, object]:
        """Return the results by name, for JSON."""
        return {
            "item": self.study.stimuli.item,
            "groups": self.groups,
            "concordance_tests": self.concordance_tests,
            "times": self.times,
        }

    def sentences(self) -> list[str]:
        """Return the results in plain sentences."""
        who = "Simulated observers, not people," if self.simulated else "People"
        told = [sentence for group in self.groups for sentence in _about(who, group)]
        if self.times is not None:
            told.append(f"The median ranking took {self.times.median_s:.1f} s.")
        return told

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables that are written beside a report, by name."""
        summaries = [(each.label, each.summary) for each in self.groups if each.summary]
        scales = [(each.label, each.scale) for each in self.groups if each.scale]
        tables = {
            "mean-ranks": _labelled((label, one.table) for label, one in summaries),
            "concordance": _labelled(
                (label, pd.DataFrame([vars(one.concordance)])) for label, one in summaries
            ),
            "rank-differences": _labelled(
                (label, one.comparisons.table) for label, one in summaries
            ),
            "plackett-luce": _labelled((label, one.table) for label, one in scales),
        }
        if self.concordance_tests is not None:
            tables["concordance-tests"] = self.concordance_tests.to_frame()
        if self.times is not None:
            tables["times"] = self.times.to_frame()
        return {name: table for name, table in tables.items() if not table.empty}

    def figures(self) -> "dict[str, Figure]":
        """Return every figure that the answers allow, by name."""
        from analysis.figures.ranking_study import ranking_study_figures  # they tell of this

        return ranking_study_figures(self)


def trials(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return `analysis.answers.comparison_tables.rank_table`."""
    return rank_table(responses, study, stimuli)


def analyse(collected: Collected) -> RankingAnalysis:
    """Compute the results of all rankings and of each condition."""
    study, conditions = collected.study, collected.study.stimuli.conditions
    table = collected.trials[collected.trials["answer"].notna()]
    for_times, *for_groups = np.random.default_rng(collected.seed).spawn(
        2 + sum(table[name].nunique() for name in conditions)
    )
    names = item_names(study, collected.stimuli)
    groups = [
        _group(", ".join(f"{k} {v}" for k, v in levels.items()) or "all", part, names, generator)
        for (levels, part), generator in zip(
            condition_parts(table, conditions), for_groups, strict=False
        )
        if levels or table[names].notna().all(axis=None)
    ]
    timed = table["reaction_time_s"].notna().any()
    every = table.assign(every="ranking")
    return RankingAnalysis(
        **vars(collected),
        groups=tuple(groups),
        concordance_tests=_tests(groups),
        times=answer_times(every, ["every"], for_times) if timed else None,
    )


def _group(
    label: str, part: pd.DataFrame, names: Sequence[str], generator: np.random.Generator
) -> RankingGroup:
    shown = [name for name in names if part[name].notna().any()]
    ranks = part[["participant", *shown]].astype(dict.fromkeys(shown, float))
    means = ranks.groupby("participant").mean()
    complete = means.dropna()
    rankings = int(ranks.groupby("participant").size().max())
    again = pd.DataFrame(
        stats.rankdata(complete, axis=1), index=complete.index, columns=complete.columns
    )
    for_ranks, for_scale = generator.spawn(2)
    left_out: dict[str, str] = {}
    summary, scale = None, None
    try:
        summary = rank_summary(again, ties=rankings > 1, generator=for_ranks)
        if rankings == 1:
            scale = plackett_luce(again, generator=for_scale)
    except InputError as error:
        left_out["scale" if summary else "summary"] = str(error)
    if rankings > 1:
        left_out["scale"] = "each participant ranked several sets"
    gone = tuple(str(name) for name in means.index.difference(complete.index))
    return RankingGroup(label, summary, scale, rankings, gone, left_out)


def _tests(groups: Sequence[RankingGroup]) -> Family | None:
    p_values = {
        group.label: group.summary.concordance.p_value
        for group in groups
        if group.summary is not None and group.label != "all"
    }
    return family("concordance by condition", p_values) if p_values else None


def _labelled(parts: Iterable[tuple[str, pd.DataFrame]]) -> pd.DataFrame:
    tables = [table.assign(group=label) for label, table in parts]
    return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()


def _about(who: str, group: RankingGroup) -> list[str]:
    if group.summary is None:
        return [f"{group.label}: nothing can be said: {group.left_out['summary']}."]
    summary, concordance = group.summary, group.summary.concordance
    order = ", ".join(
        f"{row['item']} {row['mean']:.2f} [{row['low']:.2f}, {row['high']:.2f}]"
        for row in summary.table.to_dict("records")
    )
    groups = "; ".join(f"{{{', '.join(items)}}}" for items in summary.comparisons.groups)
    return [
        f"{who} give these mean ranks ({group.label}; 1 is best, 95 % intervals): {order}.",
        f"Their orders agree with Kendall's W = {concordance.w:.3f} (p"
        f" {p_text(concordance.p_value)}, {concordance.method}, {summary.participants}"
        " participants).",
        "Groups of items whose ranks do not differ significantly"
        f" ({summary.comparisons.posthoc.capitalize()}'s test, alpha"
        f" {summary.comparisons.alpha:g}): {groups}. Items of one group are not shown to be"
        " equal.",
    ]
