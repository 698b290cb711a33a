"""Mean ranks with intervals and groups (as Lopez-Moreno 2011, figure 7.14), and worths."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import blended_transform_factory

from analysis.figures.style import CHANCE_COLOUR, COLOURS, legend_below, new_figure
from analysis.ranking.mean_ranks import RankSummary
from analysis.ranking.plackett_luce import PlackettLuceScale

_HEIGHT_OF_ITEM = 0.3  # inches
_HEIGHT_OF_REST = 1.45
_GROUP_STEP = 0.03  # between the lines of groups, in widths of the panel
_BEYOND = 0.25  # how far a group's line reaches over its items, in rows


def draw_mean_ranks(axes: Axes, summary: RankSummary) -> Axes:
    """Draw each item's mean rank with its interval, the best on top, and a line beside each group.

    Parameters
    ----------
    axes
        Where.
    summary
        As from `analysis.rank_summary`.
    """
    _draw_items(axes, summary.table, "mean", "95 % interval over participants")
    indifferent = (summary.items + 1) / 2
    axes.axvline(
        indifferent,
        color=CHANCE_COLOUR,
        linestyle=(0, (4, 3)),
        linewidth=1,
        label=f"rank if nobody could tell ({indifferent:g})",
    )
    _draw_groups(axes, summary)
    axes.set_xlim(0.9, summary.items + 0.1)
    axes.set_xticks(range(1, summary.items + 1))
    axes.set_xlabel("mean rank (1 is best)")
    return axes


def _draw_items(axes: Axes, table: pd.DataFrame, name: str, label: str) -> None:
    rows = np.arange(len(table))
    value, low, high = (table[column].to_numpy(float) for column in (name, "low", "high"))
    axes.errorbar(
        value,
        rows,
        xerr=(value - low, high - value),
        color=COLOURS[0],
        marker="o",
        markersize=4.5,
        linewidth=0,
        elinewidth=1.4,
        label=label,
    )
    axes.set_yticks(rows, table["item"].tolist())
    axes.set_ylim(len(table) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")


def _draw_groups(axes: Axes, summary: RankSummary) -> None:
    place = {item: row for row, item in enumerate(summary.table["item"])}
    beside = blended_transform_factory(axes.transAxes, axes.transData)
    label: str | None = f"not told apart ({summary.comparisons.posthoc.capitalize()})"
    for number, group in enumerate(summary.comparisons.groups):
        axes.plot(
            [1 + _GROUP_STEP * (number + 1)] * 2,
            [place[group[0]] - _BEYOND, place[group[-1]] + _BEYOND],
            transform=beside,
            color=COLOURS[1],
            linewidth=2.4,
            solid_capstyle="butt",
            clip_on=False,
            label=label,
        )
        label = None


def mean_ranks_figure(summary: RankSummary, *, simulated: bool) -> Figure:
    """Return the mean ranks of the items.

    Parameters
    ----------
    summary
        As from `analysis.rank_summary`.
    simulated
        Whether programs answered; then the figure says so.
    """
    figure, axes = _figure(summary.items, simulated)
    draw_mean_ranks(axes, summary)
    concordance = summary.concordance
    axes.set_title(f"{summary.participants} participants, W = {concordance.w:.2f}", loc="left")
    legend_below(axes, columns=2)
    return figure


def worths_figure(scale: PlackettLuceScale, *, simulated: bool) -> Figure:
    """Return the items on their Plackett-Luce scale.

    Parameters
    ----------
    scale
        As from `analysis.plackett_luce`.
    simulated
        Whether programs ranked; then the figure says so.
    """
    figure, axes = _figure(scale.items, simulated)
    _draw_items(axes, scale.table, "log_worth", "95 % interval over participants")
    axes.axvline(0, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1)
    axes.set_xlabel("log worth (0: the items' mean)")
    axes.set_title(f"Plackett-Luce, {scale.participants} participants", loc="left")
    legend_below(axes, columns=1)
    return figure


def _figure(items: int, simulated: bool) -> tuple[Figure, Axes]:
    height = _HEIGHT_OF_REST + _HEIGHT_OF_ITEM * items
    figure, (axes,) = new_figure(1, simulated, width=5.4, height=height)
    return figure, axes
