"""Heat maps over pictures and the ratio of looking times (as Lopez-Moreno 2011, 2.6 and 2.7)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter
from numpy.typing import NDArray

from algorithms.errors import InputError
from analysis.figures.style import (
    CHANCE_COLOUR,
    COLOURS,
    draw_points,
    legend_below,
    new_figure,
)
from analysis.gaze.heat_map import HeatMap
from analysis.gaze.looking_times import DwellRatios

_MAP = "inferno"
_STRONGEST = 0.75  # opacity at the peak: the picture stays in sight
_FAINTEST = 0.02  # of the peak: less is not drawn
_LUMINANCE = (0.2126, 0.7152, 0.0722)
_WIDTH = 5.6  # inches
_RATIO_TICKS = (0.01, 0.03, 0.1, 0.25, 0.5, 1, 2, 4, 10, 30, 100)


def draw_heat_map(axes: Axes, picture: NDArray[Any], heat: HeatMap) -> Axes:
    """Draw a heat map over its picture, which is shown in grey.

    Parameters
    ----------
    axes
        Where; it becomes a picture without axes.
    picture
        As displayed: shape (height, width, 3) or (height, width), integers 0 to 255 or floats 0
        to 1.
    heat
        As from `analysis.heat_map`, of the picture's size.

    Raises
    ------
    InputError
        If the sizes differ.
    """
    if picture.shape[:2] != heat.density.shape:
        raise InputError(
            f"picture: {picture.shape[:2]} pixels given, {heat.density.shape} as the heat map's"
            " accepted"
        )
    grey = picture / 255 if np.issubdtype(picture.dtype, np.integer) else picture
    if grey.ndim == 3:
        grey = grey[..., :3] @ np.array(_LUMINANCE)
    axes.imshow(grey, cmap="gray", vmin=0, vmax=1)
    share = heat.density / heat.density.max()
    opacity = np.where(share < _FAINTEST, 0.0, _STRONGEST * np.sqrt(share))
    drawn = axes.imshow(share, cmap=_MAP, vmin=0, vmax=1, alpha=opacity)
    drawn.set_rasterized(True)
    axes.set_axis_off()
    return axes


def heat_map_figure(picture: NDArray[Any], heat: HeatMap, *, simulated: bool) -> Figure:
    """Return a heat map over its picture.

    Parameters
    ----------
    picture, heat
        As in `draw_heat_map`.
    simulated
        Whether the gaze was simulated; then the figure says so.
    """
    height, width = heat.density.shape
    figure, (axes,) = new_figure(
        1, simulated, width=_WIDTH, height=0.9 + (_WIDTH - 0.9) * height / width
    )
    draw_heat_map(axes, picture, heat)
    axes.set_title(
        f"{heat.fixations} fixations, {heat.duration_s:.1f} s, sigma {heat.sigma_deg:g} deg",
        loc="left",
    )
    # A mappable of its own: the bar of the drawn one would have the opacity of the map.
    colours = ScalarMappable(Normalize(0, 1), _MAP)
    bar = figure.colorbar(colours, ax=axes, fraction=0.046, pad=0.02)
    bar.set_label("time per area, share of the peak")
    return figure


def draw_dwell_ratios(axes: Axes, results: Mapping[str, DwellRatios], level: str) -> Axes:
    """Draw ratios of looking times over a level, on a logarithmic scale, one line a result.

    Parameters
    ----------
    axes
        Where.
    results
        As from `analysis.dwell_ratios`, by the name of the region (such as `target`).
    level
        The column of their tables that is the abscissa.
    """
    for number, (label, result) in enumerate(results.items()):
        table = result.table[result.table["ratio"] > 0]
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(table[level], table["ratio"], color=colour, linewidth=0.8, alpha=0.7)
        draw_points(axes, table, (level, "ratio", "low", "high"), number, label)
    axes.axhline(
        1,
        color=CHANCE_COLOUR,
        linestyle=(0, (4, 3)),
        linewidth=1,
        label="as long as the others",
    )
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.5), max(high, 2))
    low, high = axes.get_ylim()
    axes.set_yticks([tick for tick in _RATIO_TICKS if low <= tick <= high])
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.minorticks_off()
    axes.set_ylabel("time on it / mean of the others")
    return axes


def dwell_ratios_figure(
    results: Mapping[str, DwellRatios], level: str, label: str, *, simulated: bool
) -> Figure:
    """Return ratios of looking times over a level.

    Parameters
    ----------
    results, level
        As in `draw_dwell_ratios`.
    label
        Of the abscissa, such as `divergence (deg)`.
    simulated
        Whether the gaze was simulated; then the figure says so.
    """
    figure, (axes,) = new_figure(1, simulated, width=5.4, height=3.4)
    draw_dwell_ratios(axes, results, level)
    axes.set_xlabel(label)
    axes.set_title("Looking time, 95 % interval over participants", loc="left")
    legend_below(axes, columns=3)
    return figure
