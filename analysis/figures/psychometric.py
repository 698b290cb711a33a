"""Fitted psychometric functions with their mid-points."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import (
    COLOURS,
    draw_chance,
    draw_points,
    legend_below,
    level_label,
    new_figure,
)
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis
from analysis.thresholds.bayesian_fit import ThresholdFit

_CURVE_POINTS = 400


def draw_psychometric(
    axes: Axes, fit: ThresholdFit, hits: pd.DataFrame, unit: str = "", number: int = 0
) -> Axes:
    """Draw hit rates, the function fitted to them, and its mid-point with its interval.

    Parameters
    ----------
    axes
        Where.
    fit
        The function; where it has no threshold within the levels only the rates are drawn.
    hits
        Rows of `analysis.HitRates.table`, one a level.
    unit
        Of the levels, for the legend.
    number
        Of the colour, from 0.
    """
    colour = COLOURS[number % len(COLOURS)]
    draw_chance(axes, fit.guess_rate)
    draw_points(axes, hits, ("level", "rate", "low", "high"), number)
    axes.set_ylim(-0.02, 1.02)
    if fit.reached != "within":
        axes.plot([], [], " ", label=f"mid-point\n{fit.reached} the levels tested")
        return axes
    levels = np.linspace(min(fit.levels), max(fit.levels), _CURVE_POINTS)
    axes.plot(levels, fit.rate(levels), color=colour, linewidth=1.4)
    ends = np.clip([fit.threshold.low, fit.threshold.high], levels[0], levels[-1])
    height = fit.correct_at_threshold
    axes.plot(ends, [height, height], color="black", linewidth=2, solid_capstyle="butt")
    axes.plot(
        fit.threshold.value,
        height,
        marker="+",
        markersize=11,
        markeredgewidth=2,
        color="black",
        linestyle="none",
        label=f"mid-point, {100 * height:.0f} % right\n{fit.threshold} {unit}",
    )
    return axes


def psychometric_figure(analysis: OddOneOutAnalysis) -> Figure:
    """Return the functions of all trials and of each value of the first condition."""
    groups = [
        group
        for group in analysis.thresholds
        if tuple(group.conditions) in ((), analysis.study.stimuli.conditions[:1])
    ]
    figure, all_axes = new_figure(len(groups), analysis.simulated, height=3.3)
    for number, (axes, group) in enumerate(zip(all_axes, groups, strict=True)):
        hits = analysis.hits_of(group)
        draw_psychometric(axes, group.fit, hits, analysis.study.stimuli.level_unit, number)
        axes.set_title(group.label)
        axes.set_xlabel(level_label(analysis.study))
        legend_below(axes, columns=1)
    all_axes[0].set_ylabel("share of right answers")
    return figure
