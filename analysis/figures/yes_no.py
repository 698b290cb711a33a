"""The figures of a study of judgements."""

import matplotlib as mpl
from matplotlib.figure import Figure

from analysis.figures.realism import realism_figure
from analysis.figures.style import SETTINGS
from analysis.report.tasks.yes_no import YesNoAnalysis


@mpl.rc_context(SETTINGS)
def yes_no_figures(analysis: YesNoAnalysis) -> dict[str, Figure]:
    """Return every figure that a study's answers allow, by name."""
    figures = {"realism": realism_figure(analysis.realism, simulated=analysis.simulated)}
    if analysis.by_condition is not None:
        figures["realism-by-condition"] = realism_figure(
            analysis.by_condition, simulated=analysis.simulated
        )
    return figures
