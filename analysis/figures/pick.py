"""The figures of a study of picked objects: found by level against chance, and by object."""

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import (
    CHANCE_COLOUR,
    COLOURS,
    SETTINGS,
    draw_points,
    draw_rows,
    level_label,
    new_figure,
    split_by,
)
from analysis.rates.picks import MEASURES
from analysis.report.tasks.pick import PickAnalysis

_HEIGHT_OF_ROW, _HEIGHT_OF_REST = 0.3, 1.35  # inches


@mpl.rc_context(SETTINGS)
def pick_figures(analysis: PickAnalysis) -> dict[str, Figure]:
    """Return every figure that a study's answers allow, by name."""
    figures = {"objects": objects_figure(analysis)}
    if analysis.study.stimuli.level is not None:
        figures["found"] = found_figure(analysis)
    return figures


def found_figure(analysis: PickAnalysis) -> Figure:
    """Return shares by level: a panel for each measure, a line for each number of inserted."""
    figure, all_axes = new_figure(len(MEASURES), analysis.simulated)
    for axes, (measure, title) in zip(all_axes, MEASURES.items(), strict=True):
        rows = analysis.by_level.table
        draw_found(axes, rows[rows["measure"] == measure])
        axes.set_title(title)
        axes.set_xlabel(level_label(analysis.study))
    all_axes[0].set_ylabel("share of answers")
    handles, labels = all_axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(4, len(labels)))
    return figure


def draw_found(axes: Axes, table: pd.DataFrame) -> Axes:
    """Draw shares with their intervals and chance by level, one line for each number inserted.

    Parameters
    ----------
    axes
        Where.
    table
        Rows of one measure of `analysis.rates.picks.PickRates.table`, with `level`.
    """
    for number, (label, rows) in enumerate(split_by(table, "targets")):
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(rows["level"], rows["rate"], color=colour, linewidth=0.8, alpha=0.7)
        axes.plot(rows["level"], rows["chance"], color=colour, linewidth=1, linestyle=(0, (4, 3)))
        draw_points(axes, rows, ("level", "rate", "low", "high"), number, f"{label} inserted")
    axes.plot([], [], color=CHANCE_COLOUR, linewidth=1, linestyle=(0, (4, 3)), label="chance")
    axes.set_ylim(-0.02, 1.02)
    return axes


def objects_figure(analysis: PickAnalysis) -> Figure:
    """Return how often each object is picked where it is inserted, and where another one is."""
    table = analysis.overall.objects
    names = list(dict.fromkeys(table["object"]))
    height = _HEIGHT_OF_REST + _HEIGHT_OF_ROW * len(names)
    figure, (axes,) = new_figure(1, analysis.simulated, width=5.4, height=height)
    for number, (inserted, label) in enumerate(((True, "inserted"), (False, "another one is"))):
        rows = table[table["inserted"] == inserted]
        places = np.array([names.index(name) for name in rows["object"]]) + 0.16 * (number - 0.5)
        draw_rows(axes, rows, ("rate", "low", "high"), places, number, label)
    mean = float(np.average(table["chance"], weights=table["answers"]))
    label = f"chance ({100 * mean:.1f} %)"
    axes.axvline(mean, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1, label=label)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlim(-0.02, 1.02)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("share of answers that pick it")
    figure.legend(loc="outside lower center", ncols=3)
    return figure
