"""Which objects were inserted? How often they are found, against chance, and times."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pandas as pd

from analysis.answers.picks import pick_table
from analysis.naming import p_text
from analysis.rates.picks import MEASURES, PickRates, pick_rates
from analysis.rates.times import AnswerTimes, answer_times
from analysis.report.study_analysis import Collected, StudyAnalysis
from experiments.study import Study
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PickAnalysis(StudyAnalysis):
    """The results of a study of picked objects.

    Attributes
    ----------
    overall
        How often inserted objects are found, by how many there are.
    by_level
        The same by level and number inserted.
    by_condition
        The same by level, number inserted and the study's conditions; None without conditions.
    picked
        How many answers picked how many objects.
    times
        None where there are none.
    """

    overall: PickRates
    by_level: PickRates
    by_condition: PickRates | None
    picked: Mapping[int, int]
    times: AnswerTimes | None

    template: ClassVar[str] = "pick"

    def findings(self) -> Mapping[str, object]:
        """Return the results by name, for JSON."""
        return {
            "overall": self.overall,
            "by_level": self.by_level,
            "by_condition": self.by_condition,
            "picked": self.picked,
            "times": self.times,
        }

    def rows(self) -> list[dict[str, object]]:
        """Return the rates by level, for a page."""
        table = self.by_level.table.assign(found=self.by_level.table["measure"].map(MEASURES))
        return [{str(key): value for key, value in row.items()} for row in table.to_dict("records")]

    def sentences(self) -> list[str]:
        """Return the results in plain sentences."""
        who = "Simulated observers, not people," if self.simulated else "People"
        told = [
            f"{who} find {MEASURES[str(row['measure'])]} in {100 * row['rate']:.1f} %"
            f" [{100 * row['low']:.1f}, {100 * row['high']:.1f}] of images with"
            f" {row['targets']} inserted; chance is {100 * row['chance']:.1f} %"
            f" (p {p_text(row['p_holm'])}, Holm)."
            for row in self.overall.table.to_dict("records")
        ]
        if self.times is not None:
            told.append(f"The median answer took {self.times.median_s:.1f} s.")
        return told

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables that are written beside a report, by name."""
        tables = {
            "found": self.overall.to_frame(),
            "found-by-level": self.by_level.to_frame(),
            "objects": self.overall.objects,
        }
        if self.by_condition is not None:
            tables["found-by-condition"] = self.by_condition.to_frame()
        if self.times is not None:
            tables["times"] = self.times.to_frame()
        return tables

    def figures(self) -> "dict[str, Figure]":
        """Return every figure that the answers allow, by name."""
        from analysis.figures.pick import pick_figures  # they tell of this class

        return pick_figures(self)


def trials(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return `analysis.answers.picks.pick_table`."""
    return pick_table(responses, study, stimuli)


def analyse(collected: Collected) -> PickAnalysis:
    """Compute rates and times."""
    for_all, for_levels, for_conditions, for_times = np.random.default_rng(collected.seed).spawn(4)
    study, table = collected.study, collected.trials
    level = ["level"] if study.stimuli.level is not None else []
    cells, conditions = [*level, "targets"], study.stimuli.conditions
    objects = collected.stimuli.objects
    answered = table[table["answer"].notna()]
    timed = answered["reaction_time_s"].notna().any()
    return PickAnalysis(
        **vars(collected),
        overall=pick_rates(table, ["targets"], objects, for_all),
        by_level=pick_rates(table, cells, objects, for_levels),
        by_condition=(
            pick_rates(table, [*cells, *conditions], objects, for_conditions)
            if conditions
            else None
        ),
        picked=dict(sorted(Counter(len(answer) for answer in answered["answer"]).items())),
        times=answer_times(table, cells, for_times) if timed else None,
    )
