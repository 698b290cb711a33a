"""Items on their scale of preference, with intervals."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import CHANCE_COLOUR, COLOURS, new_figure
from analysis.paired.scaling import PairScale

_HEIGHT_OF_ITEM = 0.3  # inches
_HEIGHT_OF_REST = 1.15


def draw_paired_scale(axes: Axes, scale: PairScale) -> Axes:
    """Draw each item's value with its interval, the best on top.

    Parameters
    ----------
    axes
        Where.
    scale
        As from `analysis.scale_pairs`.
    """
    table = scale.table.sort_values("jod", kind="stable")
    rows = np.arange(len(table))
    value, low, high = (table[name].to_numpy(float) for name in ("jod", "low", "high"))
    axes.axvline(0, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1)
    axes.errorbar(
        value,
        rows,
        xerr=(value - low, high - value),
        color=COLOURS[0],
        marker="o",
        markersize=4.5,
        linewidth=0,
        elinewidth=1.4,
    )
    axes.set_yticks(rows, table["item"].tolist())
    axes.set_ylim(-0.6, len(table) - 0.4)
    axes.grid(visible=False, axis="y")
    zero = "the items' mean" if scale.anchor == "mean" else scale.anchor
    axes.set_xlabel(f"JOD above {zero} (1 JOD: 75 % prefer the better item)")
    of = f"over {scale.observers} observers" if scale.over_observers else "over answers"
    axes.set_title(f"{scale.model}, 95 % intervals {of}", loc="left")
    return axes


def paired_scale_figure(scale: PairScale, *, simulated: bool) -> Figure:
    """Return the items on their scale.

    Parameters
    ----------
    scale
        As from `analysis.scale_pairs`.
    simulated
        Whether programs answered; then the figure says so.
    """
    height = _HEIGHT_OF_REST + _HEIGHT_OF_ITEM * len(scale.table)
    figure, (axes,) = new_figure(1, simulated, width=5.4, height=height)
    draw_paired_scale(axes, scale)
    return figure
