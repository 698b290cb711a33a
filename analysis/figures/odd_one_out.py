"""The figures of a study of odd ones out."""

import matplotlib as mpl
from matplotlib.figure import Figure

from analysis.figures.hit_rates import hit_rate_figure
from analysis.figures.psychometric import psychometric_figure
from analysis.figures.salience import salience_figure
from analysis.figures.style import SETTINGS
from analysis.figures.threshold_ranges import threshold_figure
from analysis.figures.times import times_figure
from analysis.tasks.odd_one_out import OddOneOutAnalysis


@mpl.rc_context(SETTINGS)
def odd_one_out_figures(analysis: OddOneOutAnalysis) -> dict[str, Figure]:
    """Return every figure that a study's answers allow, by name."""
    figures = {
        "psychometric": psychometric_figure(analysis),
        "thresholds": threshold_figure(analysis),
        "hit-rates": hit_rate_figure(analysis),
    }
    if analysis.salience is not None:
        figures["salience"] = salience_figure(analysis, analysis.salience)
    if analysis.times is not None:
        figures["times"] = times_figure(analysis, analysis.times)
    return figures
