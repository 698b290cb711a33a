"""Time per answer by level and condition (as Lopez-Moreno 2011, figure 2.4)."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import (
    COLOURS,
    draw_points,
    legend_below,
    level_label,
    new_figure,
    split_by,
)
from analysis.rates.times import AnswerTimes
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis


def draw_times(axes: Axes, times: AnswerTimes) -> Axes:
    """Draw geometric mean times with their intervals, one line for each value of the condition."""
    series = (*times.by[1:], None)[0]
    for number, (label, rows) in enumerate(split_by(times.table, series)):
        axes.plot(rows["level"], rows["mean_s"], color=COLOURS[number], linewidth=0.8, alpha=0.7)
        draw_points(axes, rows, ("level", "mean_s", "low_s", "high_s"), number, label or "all")
    axes.set_ylim(bottom=0)
    axes.set_ylabel("time per answer (s)")
    return axes


def times_figure(analysis: OddOneOutAnalysis, times: AnswerTimes) -> Figure:
    """Return the time per answer over the levels."""
    figure, (axes,) = new_figure(1, analysis.simulated, width=5.0)
    draw_times(axes, times)
    axes.set_xlabel(level_label(analysis.study))
    legend_below(axes, columns=3)
    return figure
