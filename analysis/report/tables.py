"""The tables of a report, each row saying whether programs or people answered."""

import pandas as pd

from analysis.report.study_analysis import StudyAnalysis


def study_tables(analysis: StudyAnalysis) -> dict[str, pd.DataFrame]:
    """Return the tables that are written beside a report, by name.

    Each has a column `simulated`.
    """
    tables = {"participants": analysis.flow.to_frame(), **analysis.tables()}
    if analysis.flow.excluded:
        tables["excluded"] = pd.DataFrame([vars(one) for one in analysis.flow.excluded])
    return {name: table.assign(simulated=analysis.simulated) for name, table in tables.items()}
