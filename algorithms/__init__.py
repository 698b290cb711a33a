"""Image in, image or estimate out: plain functions on arrays, and the words shared by all rooms."""

from importlib import import_module
from typing import TYPE_CHECKING

from algorithms.images import read_image, read_labels, write_image, write_labels
from algorithms.light import Light, angle_between_deg

if TYPE_CHECKING:
    from algorithms.caustics import add_caustics, caustic_map
    from algorithms.depth import perceptual_relief
    from algorithms.fog import Fog, add_fog
    from algorithms.lights import LightEstimate, detect_lights
    from algorithms.shadows import lift_shadow
    from algorithms.symmetry import phase_symmetry
    from algorithms.transparency import make_transparent

__all__ = [
    "Fog",
    "Light",
    "LightEstimate",
    "add_caustics",
    "add_fog",
    "angle_between_deg",
    "caustic_map",
    "detect_lights",
    "lift_shadow",
    "make_transparent",
    "perceptual_relief",
    "phase_symmetry",
    "read_image",
    "read_labels",
    "write_image",
    "write_labels",
]

# Loaded at their first use: every command imports this package, few need these libraries.
_LATER = {
    "Fog": "algorithms.fog",
    "LightEstimate": "algorithms.lights",
    "add_caustics": "algorithms.caustics",
    "add_fog": "algorithms.fog",
    "caustic_map": "algorithms.caustics",
    "detect_lights": "algorithms.lights",
    "lift_shadow": "algorithms.shadows",
    "make_transparent": "algorithms.transparency",
    "perceptual_relief": "algorithms.depth",
    "phase_symmetry": "algorithms.symmetry",
}


def __getattr__(name: str) -> object:
    if name in _LATER:
        value: object = getattr(import_module(_LATER[name]), name)
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
