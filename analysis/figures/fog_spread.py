"""How fog spreads the light of a small source: Lopez-Moreno 2011, fig. 6.7."""

from collections.abc import Sequence
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from algorithms.fog import apsf, energy_within
from analysis.figures.style import COLOURS, SETTINGS

PUBLISHED_FORWARD_SCATTERING: Final = 0.75
"""q of the published curves; Narasimhan and Nayar 2003 give it for haze."""

THICKNESSES: Final = (1.05, 1.2, 1.6, 2.5, 4.0)
FORWARD_SCATTERINGS: Final = (0.2, 0.75, 0.9)
WITHIN_DEG: Final = 20.0


def fog_spread_figure(
    thicknesses: Sequence[float] = THICKNESSES,
    forward_scatterings: Sequence[float] = FORWARD_SCATTERINGS,
) -> Figure:
    """Draw the atmospheric point-spread function, and the share of its energy near the source.

    Parameters
    ----------
    thicknesses
        Optical thicknesses T, each more than 1: one curve each, at the published q.
    forward_scatterings
        q, each 0..1 without 1: one curve of the share each.
    """
    with mpl.rc_context(SETTINGS):
        figure = Figure(figsize=(8.1, 3.0), layout="constrained")
        left, right = figure.subplots(1, 2)
        _draw_curves(left, thicknesses)
        _draw_shares(right, forward_scatterings)
    return figure


def _draw_curves(axes: Axes, thicknesses: Sequence[float]) -> None:
    angle_deg = np.linspace(0, 180, 361)
    for number, thickness in enumerate(thicknesses):
        values = apsf(angle_deg, thickness, PUBLISHED_FORWARD_SCATTERING)
        axes.plot(angle_deg, values, color=COLOURS[number % len(COLOURS)], label=f"T = {thickness}")
    axes.set_title(f"point-spread function, q = {PUBLISHED_FORWARD_SCATTERING}")
    axes.set_xlabel("angle from the source (deg)")
    axes.set_ylabel("radiance relative to 0 deg")
    axes.set_xticks(range(0, 181, 45))
    axes.legend()


def _draw_shares(axes: Axes, forward_scatterings: Sequence[float]) -> None:
    thicknesses = np.linspace(1.02, 4, 60)
    for number, forward in enumerate(forward_scatterings):
        shares = [energy_within(WITHIN_DEG, thickness, forward) for thickness in thicknesses]
        axes.plot(thicknesses, shares, color=COLOURS[number % len(COLOURS)], label=f"q = {forward}")
    even = (1 - np.cos(np.radians(WITHIN_DEG))) / 2
    axes.axhline(even, color="#777777", linewidth=0.8, linestyle="--", label="spread evenly")
    axes.set_title(f"energy within {WITHIN_DEG:g} deg")
    axes.set_xlabel("optical thickness T")
    axes.set_ylabel("share of all")
    axes.set_ylim(bottom=0)
    axes.legend()
