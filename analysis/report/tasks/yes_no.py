"""Is it real? Shares of yes, and sensitivity and bias where there are true photographs."""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import pandas as pd

from analysis.answers.comparison_tables import judgement_table
from analysis.judgements.realism import Realism, realism
from analysis.rates.times import AnswerTimes, answer_times
from analysis.report.study_analysis import Collected, StudyAnalysis
from experiments.study import Study
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class YesNoAnalysis(StudyAnalysis):
    """The results of a study of judgements.

    Attributes
    ----------
    realism
        By item: how often it is judged real, and d' where the set tells which images are true
        photographs (its right answer is 1).
    by_condition
        The same by item and the study's conditions; None without conditions.
    times
        None where there are none.
    """

    realism: Realism
    by_condition: Realism | None
    times: AnswerTimes | None

    template: ClassVar[str] = "yes-no"

    def findings(self) -> Mapping[str, object]:
        """Return the results by name, for JSON."""
        return {
            "item": self.study.stimuli.item,
            "realism": self.realism,
            "by_condition": self.by_condition,
            "times": self.times,
        }

    def sentences(self) -> list[str]:
        """Return the results in plain sentences."""
        who = "Simulated observers, not people," if self.simulated else "People"
        shares = "; ".join(
            f"{row['item']} ({row['kind']}) {100 * row['share']:.1f} %"
            f" [{100 * row['low']:.1f}, {100 * row['high']:.1f}]"
            for row in self.realism.table.to_dict("records")
        )
        told = [f"{who} answer yes, with 95 % intervals: {shares}."]
        told += [
            f"Photographs are told from {row['item']} with d' = {row['d_prime']:.2f}"
            f" [{row['d_prime_low']:.2f}, {row['d_prime_high']:.2f}]{_caution(row)}."
            for row in self.realism.sensitivity_frame().to_dict("records")
        ]
        if self.times is not None:
            told.append(f"The median answer took {self.times.median_s:.1f} s.")
        return told

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables that are written beside a report, by name."""
        tables = {"shares": self.realism.to_frame()}
        if self.realism.sensitivities:
            tables["sensitivity"] = self.realism.sensitivity_frame()
        if self.by_condition is not None:
            tables["shares-by-condition"] = self.by_condition.to_frame()
        if self.times is not None:
            tables["times"] = self.times.to_frame()
        return tables

    def figures(self) -> "dict[str, Figure]":
        """Return every figure that the answers allow, by name."""
        from analysis.figures.yes_no import yes_no_figures  # they tell of this class

        return yes_no_figures(self)


def _caution(row: Mapping[Hashable, float]) -> str:
    """Return what must be said where an interval holds 0."""
    if row["d_prime_low"] <= 0 <= row["d_prime_high"]:
        return ", which may be chance; that does not show that they look the same"
    return ""


def trials(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return `analysis.answers.comparison_tables.judgement_table`."""
    return judgement_table(responses, study, stimuli)


def analyse(collected: Collected) -> YesNoAnalysis:
    """Compute shares, sensitivities and times."""
    for_items, for_conditions, for_times = np.random.default_rng(collected.seed).spawn(3)
    table, conditions = collected.trials, collected.study.stimuli.conditions
    photograph = "truth" if table["truth"].notna().any() else None
    timed = (table["answer"].notna() & table["reaction_time_s"].notna()).any()
    return YesNoAnalysis(
        **vars(collected),
        realism=realism(table, ["item"], photograph=photograph, generator=for_items),
        by_condition=(
            realism(table, ["item", *conditions], photograph=photograph, generator=for_conditions)
            if conditions
            else None
        ),
        times=answer_times(table, ["item"], for_times) if timed else None,
    )
