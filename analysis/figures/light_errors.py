"""The error of light detection against what people notice."""

from dataclasses import dataclass
from typing import Final

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from algorithms.errors import InputError
from analysis.figures.style import COLOURS, MARKERS, figure_bytes
from analysis.sweeps import METHODS

__all__ = ["THESIS_BAND", "PerceptualBand", "draw_factor", "figure_bytes", "light_error_figure"]

_COLUMNS: Final = 4
_WIDTH_INCHES: Final = 10.5
_ROW_INCHES: Final = 2.5
_LABELS: Final = {
    "complexity": "complexity of the shape",
    "texture_frequency": "texture (cells a radius)",
    "gloss": "gloss (Blinn-Phong exponent)",
    "lights": "number of lights",
    "separation_deg": "separation (deg)",
    "intensity_ratio": "ratio of intensities",
    "radius_mm": "marble, radius (mm)",
    "size": "size (share of the side)",
    "noise": "noise (share of bright)",
    "mask_error_px": "mask too large by (px)",
}


@dataclass(frozen=True)
class PerceptualBand:
    """How far lights may be wrong before people notice.

    Attributes
    ----------
    low_deg, high_deg
        The ends, of a range or of a threshold's interval; 0 or more.
    definition
        What is meant by threshold, as the legend says it.

    Raises
    ------
    InputError
        If the ends are out of order.
    """

    low_deg: float
    high_deg: float
    definition: str

    def __post_init__(self) -> None:
        if not 0 <= self.low_deg <= self.high_deg <= 180:
            raise InputError("low_deg, high_deg: 0 <= low <= high <= 180 is accepted")


THESIS_BAND: Final = PerceptualBand(
    20, 30, "largest divergence not distinguishable from chance (Lopez-Moreno 2011, ch. 2)"
)


def light_error_figure(table: pd.DataFrame, band: PerceptualBand = THESIS_BAND) -> Figure:
    """Return a panel for each factor: mean error and its 95th percentile, both methods.

    Parameters
    ----------
    table
        From `analysis.sweeps.long_table`.
    band
        What people notice, and by which definition.
    """
    factors = list(dict.fromkeys(table["factor"]))
    rows = -(-len(factors) // _COLUMNS)
    figure = Figure(figsize=(_WIDTH_INCHES, _ROW_INCHES * rows + 0.6), layout="constrained")
    grid = figure.subplots(rows, _COLUMNS, sharey=True, squeeze=False).ravel().tolist()
    for axes, factor in zip(grid, factors, strict=False):
        draw_factor(axes, table[table["factor"] == factor], band)
    for axes in grid[len(factors) :]:
        axes.set_visible(False)
    grid[0].set_ylim(0, 1.05 * max(band.high_deg, float(table["angle_95_deg"].max())))
    for axes in grid[::_COLUMNS]:
        axes.set_ylabel("great-circle error (deg)")
    handles, labels = grid[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, fontsize=7.5)
    return figure


def draw_factor(axes: Axes, rows: pd.DataFrame, band: PerceptualBand = THESIS_BAND) -> Axes:
    """Draw the errors of both methods over the levels of one factor.

    Parameters
    ----------
    axes
        Where.
    rows
        Of one factor, from `analysis.sweeps.long_table`.
    band
        As of `light_error_figure`.
    """
    axes.axhspan(
        band.low_deg, band.high_deg, color="#dddddd", zorder=0, label=f"noticed: {band.definition}"
    )
    levels = sorted(rows["level"].unique())
    for number, method in enumerate(METHODS):
        own = rows[rows["method"] == method]
        places = [levels.index(level) + 0.12 * (number - 0.5) for level in own["level"]]
        axes.vlines(places, own["angle_deg"], own["angle_95_deg"], COLOURS[number], linewidth=1)
        axes.plot(
            places,
            own["angle_deg"],
            color=COLOURS[number],
            marker=MARKERS[number],
            markersize=4,
            label=f"{method}: mean, up to the 95th percentile",
        )
    axes.set_xticks(
        range(len(levels)),
        [f"{level:.2g}" if level < 1 else f"{level:g}" for level in levels],
        fontsize=7.5,
    )
    factor = str(rows["factor"].iloc[0])
    axes.set_xlabel(_LABELS.get(factor, factor))
    axes.grid(axis="y", color="#e6e6e6", linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    return axes
