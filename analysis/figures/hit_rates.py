"""Hit rates by level and condition, against chance (as Lopez-Moreno 2011, figure 2.3)."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import (
    COLOURS,
    draw_chance,
    draw_points,
    level_label,
    new_figure,
    split_by,
)
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis

_OFFSET_SHARE = 0.06  # of the step between levels: intervals of two series stay legible


def draw_hit_rates(axes: Axes, table: pd.DataFrame, series: str | None, guess_rate: float) -> Axes:
    """Draw hit rates with their intervals, one line for each value of a factor.

    Parameters
    ----------
    axes
        Where.
    table
        Rows of `analysis.HitRates.table`.
    series
        The factor that makes the lines, or None.
    guess_rate
        The share of right answers by chance.
    """
    draw_chance(axes, guess_rate)
    levels = table["level"].drop_duplicates().sort_values()
    step = float(levels.diff().min()) if len(levels) > 1 else 1.0
    for number, (label, rows) in enumerate(split_by(table, series)):
        moved = rows.assign(level=rows["level"] + (2 * number - 1) * _OFFSET_SHARE * step)
        axes.plot(moved["level"], moved["rate"], color=COLOURS[number], linewidth=0.8, alpha=0.7)
        draw_points(axes, moved, ("level", "rate", "low", "high"), number, label or "hit rate")
    axes.set_ylim(-0.02, 1.02)
    return axes


def hit_rate_figure(analysis: OddOneOutAnalysis) -> Figure:
    """Return hit rates by level: panels for the first condition, lines for the second."""
    conditions = analysis.study.stimuli.conditions
    panel_factor, series = (*conditions, None, None)[:2]
    panels = list(split_by(analysis.hits[-1].table, panel_factor))
    figure, all_axes = new_figure(len(panels), analysis.simulated)
    for axes, (title, rows) in zip(all_axes, panels, strict=True):
        draw_hit_rates(axes, rows, series, analysis.study.guess_rate)
        axes.set_title(title)
        axes.set_xlabel(level_label(analysis.study))
    all_axes[0].set_ylabel("share of right answers")
    handles, labels = all_axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure
