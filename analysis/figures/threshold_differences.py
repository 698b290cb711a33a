"""Differences of thresholds between the values of a condition, with their intervals."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import CHANCE_COLOUR, COLOURS, MARKERS, new_figure
from analysis.thresholds.condition_differences import ConditionDifferences

_ROW_INCHES = 0.3
_HEADING_INCHES = 1.25
_ALPHA = 0.05


def draw_differences(axes: Axes, conditions: Sequence[ConditionDifferences]) -> Axes:
    """Draw a pair a row; filled where its corrected test finds a difference.

    An end that the answers do not bound is an arrow; of a pair without a threshold there is none.
    """
    axes.axvline(0, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1)
    frames = [one.to_frame() for one in conditions]
    ends = np.concatenate(
        [frame[["difference_low", "difference", "difference_high"]].to_numpy() for frame in frames]
    )
    finite = np.abs(ends[np.isfinite(ends)])
    reach = 1.15 * float(finite.max()) if finite.size else 1.0
    place = 0
    for number, frame in enumerate(frames):
        colour, marker = COLOURS[number % len(COLOURS)], MARKERS[number % len(MARKERS)]
        for _, row in frame.iterrows():
            low, high = row["difference_low"], row["difference_high"]
            axes.plot(np.clip([low, high], -reach, reach), [place] * 2, color=colour, linewidth=1.6)
            for end, arrow in ((low, "<"), (high, ">")):
                if np.isinf(end):
                    at = np.clip(end, -reach, reach)
                    axes.plot(at, place, arrow, color=colour, markersize=5, clip_on=False)
            filled = colour if row["p_holm"] < _ALPHA else "white"
            axes.plot(
                row["difference"], place, marker, color=colour, markerfacecolor=filled, markersize=5
            )
            if np.isnan(row["difference"]):
                text = "a threshold beyond the levels tested"
                axes.text(0, place, f"  {text}", color=colour, fontsize=7, va="center")
            place += 1
    axes.set_xlim(-reach, reach)
    axes.set_ylim(place - 0.5, -0.5)
    axes.set_yticks(
        range(place),
        [
            f"{one.condition.replace('_', ' ')}: {pair}"
            for one in conditions
            for pair in one.differences
        ],
    )
    axes.grid(visible=False, axis="y")
    return axes


def differences_figure(
    conditions: Sequence[ConditionDifferences], simulated: bool, unit: str = ""
) -> Figure:
    """Return the differences of the thresholds of some conditions.

    Parameters
    ----------
    conditions
        As from `analysis.condition_differences`, one or more with one definition of the threshold.
    simulated
        Whether programs answered.
    unit
        Of the levels.
    """
    rows = sum(len(one.differences) for one in conditions)
    height = _HEADING_INCHES + _ROW_INCHES * rows
    figure, (axes,) = new_figure(1, simulated, width=6.0, height=height)
    draw_differences(axes, conditions)
    definition = next(iter(conditions[0].differences.values())).definition
    axes.set_title(definition.capitalize(), loc="left")
    axes.set_xlabel(f"difference ({unit})" if unit else "difference")
    figure.supxlabel(
        f"bars: 95 % intervals over participants; filled: p < {_ALPHA:g} by Holm's correction"
        " within a condition",
        fontsize=7.5,
    )
    return figure
