"""Effects of factors with their intervals: differences of hit rates, ratios of odds or times."""

from collections.abc import Mapping

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from analysis.figures.style import CHANCE_COLOUR, COLOURS, MARKERS, new_figure
from analysis.rates.effects import TIME, Effects

_ROW_INCHES = 0.28
_HEADING_INCHES = 1.15
_TICKS = np.array([0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 0.8, 1, 1.25, 2, 5, 10, 20, 50, 100])
_ALPHA = 0.05


def draw_effects(axes: Axes, effects: Effects, quantity: str, none: float) -> Axes:
    """Draw a contrast a row, first on top; filled where its factor's corrected test finds it.

    Parameters
    ----------
    axes
        Where.
    effects
        As from `analysis.hit_effects` or `analysis.time_effects`.
    quantity
        `difference` or `ratio`, a column of the contrasts.
    none
        The value that stands for no effect.
    """
    axes.axvline(none, color=CHANCE_COLOUR, linestyle=(0, (4, 3)), linewidth=1)
    factors = effects.tests["factor"].tolist()
    for place, (_, row) in enumerate(effects.to_frame().iterrows()):
        number = factors.index(row["factor"])
        colour = COLOURS[number % len(COLOURS)]
        axes.plot(
            [row[f"{quantity}_low"], row[f"{quantity}_high"]],
            [place, place],
            color=colour,
            linewidth=1.4,
        )
        axes.plot(
            row[quantity],
            place,
            MARKERS[number % len(MARKERS)],
            color=colour,
            markerfacecolor=colour if row["p_holm"] < _ALPHA else "white",
            markersize=5,
        )
    axes.set_ylim(len(effects.contrasts) - 0.5, -0.5)
    axes.grid(visible=False, axis="y")
    return axes


def effects_figure(
    effects: Effects,
    simulated: bool,
    names: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
) -> Figure:
    """Return every contrast: on the left in points of the hit rate, on the right as a ratio.

    Parameters
    ----------
    effects
        As from `analysis.hit_effects` or `analysis.time_effects`; times have ratios only.
    simulated
        Whether programs answered.
    names
        Factors in words; else underscores become spaces.
    units
        Of numeric factors, such as `deg`.
    """
    timed = effects.quantity == TIME
    height = _HEADING_INCHES + _ROW_INCHES * len(effects.contrasts)
    figure, panels = new_figure(1 if timed else 2, simulated, 5.6 if timed else 8.1, height)
    if not timed:
        left = draw_effects(panels[0], effects, "difference", 0.0)
        left.xaxis.set_major_formatter(
            FuncFormatter(lambda share, _: f"{100 * share:+g}" if share else "0")
        )
        left.set_xlabel("difference (percentage points)")
        left.set_title(effects.quantity.capitalize())
    right = draw_effects(panels[-1], effects, "ratio", 1.0)
    _logarithmic(right, effects.contrasts)
    right.set_xlabel("ratio of geometric means" if timed else "odds ratio")
    right.set_title(effects.quantity.capitalize() if timed else "Odds")
    labels = _labels(effects.contrasts, names or {}, units or {})
    panels[0].set_yticks(range(len(effects.contrasts)), labels)
    for axes in panels[1:]:
        axes.tick_params(left=False)
    figure.supxlabel(
        f"bars: 95 % intervals; filled: p < {_ALPHA:g} by Holm's correction for"
        f" {effects.family.size} factors",
        fontsize=7.5,
    )
    return figure


def _labels(
    contrasts: pd.DataFrame, names: Mapping[str, str], units: Mapping[str, str]
) -> list[str]:
    return [
        f"{names.get(str(factor), str(factor).replace('_', ' '))}:"
        f" {contrast} {units.get(str(factor), '')}".rstrip()
        for factor, contrast in zip(contrasts["factor"], contrasts["contrast"], strict=True)
    ]


def _logarithmic(axes: Axes, contrasts: pd.DataFrame) -> None:
    """Make the axis logarithmic, with round numbers within what is drawn."""
    axes.set_xscale("log")
    ratios = contrasts[["ratio_low", "ratio", "ratio_high"]].to_numpy(float)
    low = max(float(np.nanmin(ratios)), _TICKS[0])
    high = min(float(np.nanmax(ratios)), _TICKS[-1])
    axes.set_xlim(min(low, 0.95) / 1.05, max(high, 1.05) * 1.05)
    shown = _TICKS[(low / 1.1 <= _TICKS) & (high * 1.1 >= _TICKS)]
    axes.xaxis.set_major_locator(FixedLocator(list(shown) if len(shown) > 1 else [0.9, 1.0, 1.1]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda ratio, _: f"{ratio:g}"))
