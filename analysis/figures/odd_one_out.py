"""The figures of a study of odd ones out."""

import matplotlib as mpl
from matplotlib.figure import Figure

from analysis.figures.effects import effects_figure
from analysis.figures.hit_rates import hit_rate_figure
from analysis.figures.psychometric import psychometric_figure
from analysis.figures.salience import salience_figure
from analysis.figures.style import SETTINGS
from analysis.figures.threshold_differences import differences_figure
from analysis.figures.threshold_ranges import threshold_figure
from analysis.figures.times import times_figure
from analysis.naming import level_name
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis

UNITS = {"age": "years"}


@mpl.rc_context(SETTINGS)
def odd_one_out_figures(analysis: OddOneOutAnalysis) -> dict[str, Figure]:
    """Return every figure that a study's answers allow, by name."""
    figures = {
        "psychometric": psychometric_figure(analysis),
        "thresholds": threshold_figure(analysis),
        "hit-rates": hit_rate_figure(analysis),
    }
    if analysis.differences:
        figures["threshold-differences"] = differences_figure(
            analysis.differences, analysis.simulated, analysis.study.stimuli.level_unit
        )
    names = {"level": level_name(analysis.study)}
    units = {"level": analysis.study.stimuli.level_unit}
    for name, effects in (("hit", analysis.hit_effects), ("time", analysis.time_effects)):
        if effects is not None:
            figures[f"{name}-effects"] = effects_figure(
                effects, analysis.simulated, names, UNITS | units
            )
    if analysis.salience is not None:
        figures["salience"] = salience_figure(analysis, analysis.salience)
    if analysis.times is not None:
        figures["times"] = times_figure(analysis, analysis.times)
    return figures
