"""The tables of a report, each row saying whether programs or people answered."""

import pandas as pd

from analysis.study_analysis import StudyAnalysis


def study_tables(analysis: StudyAnalysis) -> dict[str, pd.DataFrame]:
    """Return the tables that are written beside a report, by name.

    Each has a column `simulated`.
    """
    tables = {
        "participants": analysis.flow.to_frame(),
        "thresholds": pd.DataFrame([group.row() for group in analysis.thresholds]),
        "chance": pd.concat(
            [
                limit.to_frame().assign(group=group.label)
                for group in analysis.thresholds
                for limit in (group.at_chance, group.at_chance_by_participant)
                if limit is not None
            ],
            ignore_index=True,
        ),
        "hit-rates": analysis.hits[-1].to_frame(),
    }
    if analysis.flow.excluded:
        tables["excluded"] = pd.DataFrame([vars(one) for one in analysis.flow.excluded])
    if analysis.salience is not None:
        tables["salience"] = analysis.salience.to_frame()
        tables["salience-fall"] = analysis.salience.fall
    if analysis.times is not None:
        tables["times"] = analysis.times.to_frame()
    return {name: table.assign(simulated=analysis.simulated) for name, table in tables.items()}
