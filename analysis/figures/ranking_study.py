"""The figures of a study of rankings."""

import matplotlib as mpl
from matplotlib.figure import Figure

from analysis.figures.ranking import mean_ranks_figure, worths_figure
from analysis.figures.style import SETTINGS
from analysis.report.tasks.ranking import RankingAnalysis


@mpl.rc_context(SETTINGS)
def ranking_study_figures(analysis: RankingAnalysis) -> dict[str, Figure]:
    """Return the mean ranks of each group, and the scale where there is one, by name."""
    figures = {}
    for group in analysis.groups:
        if group.summary is not None:
            figures[f"mean-ranks-{group.stem}"] = mean_ranks_figure(
                group.summary, simulated=analysis.simulated
            )
        if group.scale is not None:
            figures[f"worths-{group.stem}"] = worths_figure(
                group.scale, simulated=analysis.simulated
            )
    return figures
