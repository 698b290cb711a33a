"""Choices on control trials and their fall with the level (as Lopez-Moreno 2011, figure 2.5)."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import (
    COLOURS,
    draw_chance,
    draw_points,
    legend_below,
    level_label,
    new_figure,
    split_by,
)
from analysis.rates.salience import Salience
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis


def draw_choices(axes: Axes, choices: pd.DataFrame, series: str | None, chance: float) -> Axes:
    """Draw how often each object is chosen on control trials, bars grouped by a factor."""
    split = list(split_by(choices, series))
    width = 0.8 / len(split)
    names = choices["object"].drop_duplicates().tolist()
    for number, (label, rows) in enumerate(split):
        places = np.array([names.index(name) for name in rows["object"]])
        low, share, high = (rows[name].to_numpy(float) for name in ("low", "share", "high"))
        axes.bar(
            places + (number - (len(split) - 1) / 2) * width,
            share,
            width=0.9 * width,
            yerr=(share - low, high - share),
            color=COLOURS[number],
            error_kw={"elinewidth": 0.8, "ecolor": "#333333"},
            label=label or "all",
        )
    draw_chance(axes, chance)
    axes.set_xticks(range(len(names)), names)
    return axes


FEWEST_ANSWERS = 10  # a share of fewer is left to the table


def draw_fall(axes: Axes, salience: Salience) -> Axes:
    """Draw how the most salient object is chosen at each level where it is not the target."""
    shown = salience.fall[salience.fall["answers"] >= FEWEST_ANSWERS]
    if shown.empty:
        text = f"fewer than {FEWEST_ANSWERS} answers at every level"
        axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center")
        return axes
    for number, (measure, rows) in enumerate(split_by(shown, "measure")):
        axes.plot(rows["level"], rows["share"], color=COLOURS[number], linewidth=0.8, alpha=0.7)
        draw_points(axes, rows, ("level", "share", "low", "high"), number, measure)
    return axes


def salience_figure(analysis: OddOneOutAnalysis, salience: Salience) -> Figure:
    """Return the choices on control trials, and what becomes of the most frequent one."""
    split = (*analysis.study.stimuli.conditions, None)[0]
    choices = salience.choices
    if split is not None:
        choices = choices[choices[split].notna()]
    figure, (left, right) = new_figure(2, analysis.simulated, height=3.3, share_y=False)
    draw_choices(left, choices, split, salience.chance)
    left.set_title("Choices where no object differs")
    left.set_xlabel("object")
    left.set_ylabel("share of choices")
    draw_fall(right, salience)
    right.set_title(f"Object {salience.most_salient} where it is not the target")
    right.set_ylabel("share")
    right.set_xlabel(level_label(analysis.study))
    for axes in (left, right):
        legend_below(axes, columns=2)
        axes.set_ylim(bottom=0)
    return figure
