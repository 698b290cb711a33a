"""Image in, image or estimate out: plain functions on arrays, and the words shared by all rooms."""

from algorithms.images import read_image, read_labels, write_image, write_labels
from algorithms.light import Light, angle_between_deg

__all__ = [
    "Light",
    "angle_between_deg",
    "read_image",
    "read_labels",
    "write_image",
    "write_labels",
]
