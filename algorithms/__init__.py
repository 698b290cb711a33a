"""Image in, image or estimate out: plain functions on arrays, and the words shared by all rooms."""

from importlib import import_module
from typing import TYPE_CHECKING

from algorithms.images import read_image, read_labels, write_image, write_labels
from algorithms.light import Light, angle_between_deg

if TYPE_CHECKING:
    from algorithms.lights import LightEstimate, detect_lights

__all__ = [
    "Light",
    "LightEstimate",
    "angle_between_deg",
    "detect_lights",
    "read_image",
    "read_labels",
    "write_image",
    "write_labels",
]

# Loaded at their first use: every command imports this package, few need these libraries.
_LATER = {"LightEstimate": "algorithms.lights", "detect_lights": "algorithms.lights"}


def __getattr__(name: str) -> object:
    if name in _LATER:
        value: object = getattr(import_module(_LATER[name]), name)
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
