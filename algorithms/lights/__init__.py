"""Light detection: where the lights of a picture are, from one object's outline and shading."""

from algorithms.lights.detect import detect_lights
from algorithms.lights.estimate import LightEstimate

__all__ = ["LightEstimate", "detect_lights"]
