"""Caustics in a photograph: the light that an object, made of glass, would throw on a surface.

People notice whether there are caustics, but cannot tell which shape they should have. Light
gathers where the object is symmetric about a line of sight, as a lens is; so the phase symmetry of
its relief makes a pattern that they find right (Lopez-Moreno 2011, ch. 7; Gutierrez et al. 2008).
The pattern is projected onto a quadrilateral that the user marks, and its luminance added.
"""

from algorithms.caustics.added import add_caustics
from algorithms.caustics.cast import cast, maps_of
from algorithms.caustics.pattern import caustic_map
from algorithms.caustics.settings import MAX_DIRECTIONS, PRESETS, Caustics

__all__ = [
    "MAX_DIRECTIONS",
    "PRESETS",
    "Caustics",
    "add_caustics",
    "cast",
    "caustic_map",
    "maps_of",
]
