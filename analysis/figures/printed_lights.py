"""What the sounder steps of light-source fitting are worth: printed variants beside the default."""

from typing import Final

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.figures.style import COLOURS, MARKERS
from analysis.printed_lights import VARIANTS

_PANELS: Final = (
    ("azimuth_error_deg", "azimuth error (deg)"),
    ("elevation_error_deg", "elevation error (deg)"),
    ("intensity_error", "error of intensity (factor)"),
    ("number_is_right", "number right (share of images)"),
)


def printed_lights_figure(table: pd.DataFrame) -> Figure:
    """Draw mean errors by the number of true lights, and how often that number is found.

    Parameters
    ----------
    table
        From `analysis.printed_lights.compare_with_printed`.
    """
    figure = Figure(figsize=(10.5, 3.4), layout="constrained")
    grid = figure.subplots(1, len(_PANELS)).ravel().tolist()
    for axes, (column, label) in zip(grid, _PANELS, strict=True):
        _draw(axes, _means(table, column))
        axes.set_ylabel(label)
        axes.set_xlabel("true lights")
    grid[-1].set_ylim(0, 1.02)
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=8)
    return figure


def _means(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return means by variant (columns) and number of lights (rows)."""
    rows = table
    if column == "number_is_right":
        rows = table.drop_duplicates(["id", "variant"])
        values = (rows["missed"] == 0) & (rows["strong_extra"] == 0)
        rows = rows.assign(number_is_right=values.astype(float))
    elif column == "intensity_error":
        ratios = np.log(table["intensity_ratio"].clip(lower=1e-3))
        rows = table.assign(intensity_error=np.abs(ratios))
    means = rows.pivot_table(index="lights", columns="variant", values=column, aggfunc="mean")
    return means.map(np.exp) if column == "intensity_error" else means


def _draw(axes: Axes, means: pd.DataFrame) -> None:
    for number, variant in enumerate(VARIANTS):
        axes.plot(
            range(len(means)),
            means[variant],
            color=COLOURS[number],
            marker=MARKERS[number],
            markersize=5,
            linewidth=1,
            label=variant,
        )
    axes.set_xticks(range(len(means)), [str(count) for count in means.index])
    axes.set_ylim(bottom=0)
    axes.grid(axis="y", color="#e6e6e6", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
