"""Thresholds of all groups, the two definitions side by side and never in one panel."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import COLOURS, MARKERS, level_label, new_figure
from analysis.groups import GroupThreshold
from analysis.study_analysis import StudyAnalysis


def draw_mid_points(axes: Axes, groups: Sequence[GroupThreshold]) -> Axes:
    """Draw each group's mid-point with its two intervals; arrows where it is beyond the levels."""
    for row, group in enumerate(groups):
        lowest, highest = min(group.fit.levels), max(group.fit.levels)
        if group.fit.reached != "within":
            edge, arrow = (highest, ">") if group.fit.reached == "above" else (lowest, "<")
            axes.plot(edge, row, arrow, color=COLOURS[0], markerfacecolor="none", clip_on=False)
            continue
        wide = group.over_participants
        if np.isfinite(wide.low):
            axes.plot([wide.low, wide.high], [row, row], color="#999999", linewidth=1)
        ends = np.clip([group.fit.threshold.low, group.fit.threshold.high], lowest, highest)
        axes.plot(ends, [row, row], color=COLOURS[0], linewidth=3, solid_capstyle="butt")
        axes.plot(group.fit.threshold.value, row, "o", color=COLOURS[0], markersize=5)
    axes.plot([], [], color=COLOURS[0], linewidth=3, marker="o", label="95 % credible interval")
    axes.plot([], [], color="#999999", linewidth=1, label="95 % interval over participants")
    return axes


def draw_chance_limits(axes: Axes, groups: Sequence[GroupThreshold]) -> Axes:
    """Draw each group's largest level not distinguishable from chance, by both tests."""
    for number, test in enumerate(("exact binomial", "t over participants")):
        limits = [
            group.at_chance if number == 0 else group.at_chance_by_participant for group in groups
        ]
        axes.plot(
            [limit.level if limit is not None else np.nan for limit in limits],
            np.arange(len(groups)) + (number - 0.5) * 0.3,
            MARKERS[number],
            color=COLOURS[1 + number],
            markersize=5,
            label=test,
        )
    return axes


def threshold_figure(analysis: StudyAnalysis) -> Figure:
    """Return both kinds of threshold of all groups, each kind in a panel of its own."""
    groups = analysis.thresholds
    figure, (left, right) = new_figure(
        2, analysis.simulated, panel_width=4.2, height=1.9 + 0.24 * len(groups)
    )
    draw_mid_points(left, groups).set_title("mid-point of the psychometric function")
    draw_chance_limits(right, groups).set_title("largest level not distinguishable from chance")
    levels = analysis.trials["level"]
    margin = 0.04 * float(levels.max() - levels.min())
    for axes in (left, right):
        axes.set_xlim(float(levels.min()) - margin, float(levels.max()) + margin)
        axes.set_xlabel(level_label(analysis.study))
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    left.set_yticks(range(len(groups)), [group.label for group in groups])
    left.invert_yaxis()
    return figure
