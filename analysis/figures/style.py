"""What all figures share: colours, labels, the mark of simulated answers, and files."""

import io
from collections.abc import Iterator
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from experiments.study import Study

# Okabe and Ito 2008: told apart with any common colour vision, and in grey by their markers.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#000000", "#F0E442")
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
CHANCE_COLOUR = "#777777"
SIMULATED_COLOUR = "#B3261E"
SIMULATED_TEXT = "SIMULATED answers, not people"

SETTINGS: dict[Any, Any] = {  # the key's type is a union of all parameter names
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9,
    "axes.titleweight": "bold",
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "legend.fontsize": 7.5,
    "svg.hashsalt": "trompe",  # the same figure, the same bytes
    "svg.fonttype": "path",
}
_PNG_DOTS_PER_INCH = 200
_NARROWEST_PANEL = 1.8  # inches
_LEGEND_DROP_INCHES = 0.47  # leaves room for the abscissa's numbers and label


def new_figure(
    panels: int,
    simulated: bool,
    width: float = 8.1,
    height: float = 3.0,
    *,
    share_y: bool = True,
) -> tuple[Figure, list[Axes]]:
    """Return a figure with panels side by side, marked on its face if answers are simulated.

    Parameters
    ----------
    panels
        How many, 1 or more.
    simulated
        Whether programs answered.
    width, height
        In inches; many panels make the figure wider.
    share_y
        Whether the panels share their y axis.
    """
    figure = Figure(figsize=(max(width, _NARROWEST_PANEL * panels), height), layout="constrained")
    axes = figure.subplots(1, panels, sharey=share_y, squeeze=False)[0].tolist()
    if simulated:
        figure.suptitle(
            SIMULATED_TEXT,
            color=SIMULATED_COLOUR,
            fontsize=9,
            fontweight="bold",
            x=0.99,
            ha="right",
        )
    return figure, axes


def level_label(study: Study) -> str:
    """Return the axis label of a study's level, such as `divergence (deg)`."""
    unit = study.stimuli.level_unit
    name = (study.stimuli.level or "level").removesuffix(f"_{unit}").replace("_", " ")
    return f"{name} ({unit})" if unit else name


def split_by(table: pd.DataFrame, name: str | None) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield the value and the rows of each level of a factor; all rows if there is no factor."""
    if name is None:
        yield "", table
        return
    for value, rows in table.groupby(name, observed=True, sort=True):
        yield str(value), rows


def draw_chance(axes: Axes, rate: float) -> Axes:
    """Draw the rate of guessing across a panel."""
    label = f"chance ({100 * rate:.1f} %)"
    axes.axhline(rate, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1, label=label)
    return axes


def draw_points(
    axes: Axes,
    rows: pd.DataFrame,
    columns: tuple[str, str, str, str],
    number: int,
    label: str | None = None,
) -> Axes:
    """Draw points with their intervals in the colour and marker of a series.

    Parameters
    ----------
    axes
        Where.
    rows
        One row a point.
    columns
        The names of the abscissa, the value and the ends of its interval.
    number
        Of the series, from 0.
    label
        As the legend names it, or None.
    """
    x, y, low, high = (rows[name].to_numpy(float) for name in columns)
    axes.errorbar(
        x,
        y,
        yerr=(y - low, high - y),
        color=COLOURS[number % len(COLOURS)],
        marker=MARKERS[number % len(MARKERS)],
        markersize=4,
        linewidth=0,
        elinewidth=1,
        capsize=0,
        label=label,
    )
    return axes


def draw_rows(
    axes: Axes,
    table: pd.DataFrame,
    columns: tuple[str, str, str],
    rows: NDArray[np.number],
    number: int,
    label: str | None,
) -> None:
    """Draw values with their intervals, lying, in the colour and marker of a series.

    Parameters
    ----------
    axes
        Where.
    table
        One row a value.
    columns
        The names of the value and of the ends of its interval.
    rows
        The ordinate of each value.
    number
        Of the series, from 0.
    label
        As the legend names it, or None.
    """
    value, low, high = (table[name].to_numpy(float) for name in columns)
    axes.errorbar(
        value,
        rows,
        xerr=(value - low, high - value),
        color=COLOURS[number],
        marker=MARKERS[number],
        markersize=4.5,
        linewidth=0,
        elinewidth=1.4,
        label=label,
    )


def legend_below(axes: Axes, columns: int) -> Axes:
    """Put the legend under the abscissa's label, where no answer can lie; none if nothing is named.

    Parameters
    ----------
    axes
        A panel of a figure from `new_figure`, which makes room for it.
    columns
        How many entries stand side by side.
    """
    figure = axes.get_figure(root=True)
    if figure is not None and axes.get_legend_handles_labels()[0]:
        axes.legend(
            loc="upper center",
            bbox_to_anchor=(0.5, 0),
            bbox_transform=axes.transAxes
            + ScaledTranslation(0, -_LEGEND_DROP_INCHES, figure.dpi_scale_trans),
            ncols=columns,
            borderaxespad=0,
        )
    return axes


def figure_bytes(figure: Figure, file_format: str) -> bytes:
    """Return a figure as `svg` or `png`; the same figure always gives the same bytes."""
    stream = io.BytesIO()
    metadata = {"Date": None, "Creator": "Trompe"} if file_format == "svg" else {"Software": None}
    with mpl.rc_context(SETTINGS):
        if figure.get_layout_engine():
            # Laid out once, not twice for each format, and so the same in all of them.
            figure.draw_without_rendering()
            figure.set_layout_engine(None)
        figure.savefig(stream, format=file_format, dpi=_PNG_DOTS_PER_INCH, metadata=metadata)
    return stream.getvalue()
