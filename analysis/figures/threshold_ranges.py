"""Thresholds of all groups, the two definitions side by side and never in one panel."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import COLOURS, MARKERS, legend_below, level_label, new_figure
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis
from analysis.thresholds.by_condition import GroupThreshold

_HALF_GAP = 0.16  # between the two marks of a group, in rows


def draw_mid_points(axes: Axes, groups: Sequence[GroupThreshold]) -> Axes:
    """Draw each group's mid-point with its two intervals; arrows where it is beyond the levels."""
    for row, group in enumerate(groups):
        lowest, highest = min(group.fit.levels), max(group.fit.levels)
        if group.fit.reached != "within":
            edge, arrow = (highest, ">") if group.fit.reached == "above" else (lowest, "<")
            axes.plot(edge, row, arrow, color=COLOURS[0], markerfacecolor="none", clip_on=False)
            continue
        for number, interval in enumerate((group.fit.threshold, group.over_participants)):
            ends = np.clip([interval.low, interval.high], lowest, highest)
            height = row + (2 * number - 1) * _HALF_GAP
            axes.plot(ends, [height, height], color=COLOURS[number], linewidth=1.6)
            axes.plot(interval.value, height, MARKERS[number], color=COLOURS[number], markersize=4)
    for number, label in enumerate(("95 % credible interval", "95 % interval over participants")):
        axes.plot([], [], color=COLOURS[number], marker=MARKERS[number], markersize=4, label=label)
    return axes


def draw_chance_limits(axes: Axes, groups: Sequence[GroupThreshold]) -> Axes:
    """Draw each group's largest level not distinguishable from chance, by both tests."""
    for row, group in enumerate(groups):
        for number, limit in enumerate((group.at_chance, group.at_chance_by_participant)):
            if limit is None:
                continue
            height = row + (2 * number - 1) * _HALF_GAP
            none = np.isnan(limit.level)
            axes.plot(
                limit.levels[0] if none else limit.level,
                height,
                "<" if none else MARKERS[number],
                color=COLOURS[2 + number],
                markerfacecolor="none" if none else COLOURS[2 + number],
                markersize=4.5,
            )
    for number, label in enumerate(("exact binomial test", "t-test over participants")):
        axes.plot([], [], MARKERS[number], color=COLOURS[2 + number], markersize=4.5, label=label)
    axes.plot([], [], "<", color="#444444", markerfacecolor="none", label="better at every level")
    return axes


def threshold_figure(analysis: OddOneOutAnalysis) -> Figure:
    """Return the kinds of threshold that are told of all groups, each in a panel of its own."""
    groups = analysis.thresholds
    told = analysis.overall.at_chance is not None
    height = 1.8 + 0.26 * len(groups)
    figure, (left, *right) = new_figure(1 + told, analysis.simulated, height=height)
    draw_mid_points(left, groups).set_title("Mid-point of the function")
    for axes in right:
        draw_chance_limits(axes, groups).set_title("Largest level at chance")
    levels = np.array(analysis.overall.fit.levels)
    for axes in (left, *right):
        axes.set_xlim(min(0.0, levels.min()), levels.max() + 2)
        axes.set_xlabel(level_label(analysis.study))
        legend_below(axes, columns=2)
    left.set_yticks(range(len(groups)), [group.label for group in groups])
    left.set_ylim(len(groups) - 0.5, -0.5)
    return figure
