"""Fog in a single picture: `add_fog`, what fog is like, and the point-spread function."""

from algorithms.fog.apsf import apsf, energy_within
from algorithms.fog.fog import add_fog
from algorithms.fog.parameters import PRESETS, Fog, airlight_colour
from algorithms.fog.relighting import white_level

__all__ = [
    "PRESETS",
    "Fog",
    "add_fog",
    "airlight_colour",
    "apsf",
    "energy_within",
    "white_level",
]
