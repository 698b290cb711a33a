"""Scores with lines under items that do not differ (as Lopez-Moreno 2011, table 7.3)."""

import textwrap
from collections.abc import Mapping

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import COLOURS, new_figure
from analysis.paired.score_groups import ScoreGroups

_SCORE_ROW, _GROUP_STEP = 0.75, 0.42
_LINE_BEYOND = 0.38  # of the step between items: a line reaches over its first and last item
_CHARACTERS = 13  # of an item's name, before it goes on in a new line
_WIDTH_OF_ITEM, _WIDTH_OF_REST = 1.1, 1.7  # inches
_HEIGHT_OF_UNIT = 0.3


def draw_score_groups(axes: Axes, results: Mapping[str, ScoreGroups]) -> Axes:
    """Draw a row of items for each condition, best on the left, and a line under each group.

    Parameters
    ----------
    axes
        Where; it becomes a table without axes.
    results
        As from `analysis.score_groups`, by the condition's name.
    """
    height = 0.0
    for condition, result in results.items():
        place = {item: k for k, item in enumerate(result.table["item"])}
        axes.text(-0.75, height + 0.2, condition, ha="right", va="center", fontweight="bold")
        for item, score in zip(result.table["item"], result.table["score"], strict=True):
            name = "\n".join(textwrap.wrap(str(item), _CHARACTERS))
            axes.text(place[item], height, name, ha="center", va="center")
            axes.text(
                place[item], height + _SCORE_ROW, str(score), ha="center", va="center", fontsize=8
            )
        for number, group in enumerate(result.groups):
            below = height + _SCORE_ROW + _GROUP_STEP * (number + 1)
            ends = (place[group[0]] - _LINE_BEYOND, place[group[-1]] + _LINE_BEYOND)
            axes.plot(ends, (below, below), color=COLOURS[0], linewidth=2.2, solid_capstyle="butt")
        height = _next_row(height, result)
    most = max(len(result.table) for result in results.values())
    axes.set_xlim(-0.75, most - 0.5)
    axes.set_ylim(height - 0.6, -0.6)
    axes.set_axis_off()
    return axes


def score_groups_figure(results: Mapping[str, ScoreGroups], *, simulated: bool) -> Figure:
    """Return scores and groups of several conditions.

    Parameters
    ----------
    results
        As from `analysis.score_groups`, by the condition's name; one or more.
    simulated
        Whether programs answered; then the figure says so.
    """
    height = 0.0
    for result in results.values():
        height = _next_row(height, result)
    most = max(len(result.table) for result in results.values())
    figure, (axes,) = new_figure(
        1,
        simulated,
        width=_WIDTH_OF_REST + _WIDTH_OF_ITEM * most,
        height=0.75 + _HEIGHT_OF_UNIT * height,
    )
    draw_score_groups(axes, results)
    figure.supxlabel(_legend(results), fontsize=7.5)
    return figure


def _next_row(height: float, result: ScoreGroups) -> float:
    return height + _SCORE_ROW + _GROUP_STEP * len(result.groups) + 1.0


def _legend(results: Mapping[str, ScoreGroups]) -> str:
    """Return from which difference on items differ, and where none can."""
    needed = {name: one for name, one in results.items() if one.critical is not None}
    texts = {name: f"{one.critical} (alpha = {one.alpha:g})" for name, one in needed.items()}
    if len(set(texts.values())) > 1:
        texts = {name: f"{name}: {text}" for name, text in texts.items()}
    parts = ["A line joins items whose scores do not differ significantly."]
    if texts:
        parts.append(
            f"Smallest significant difference: {', '.join(dict.fromkeys(texts.values()))}."
        )
    parts += [f"{name}: {one.remark}" for name, one in results.items() if one.remark]
    return "\n".join(line for part in parts for line in textwrap.wrap(part, 70))
