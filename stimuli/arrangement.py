"""The scene of chapter 2: eight abstract objects in two rows, with the materials of table 2.1."""

from typing import Final

import numpy as np

from algorithms.color import decode_srgb
from stimuli.camera import View
from stimuli.materials import TABLE_2_1, Material
from stimuli.scene import Placed
from stimuli.shapes import AbstractShape, sphere_directions

FULL: Final = View(width_px=1024, height_px=600, radius_px=105, samples=16)
QUICK: Final = View(width_px=512, height_px=300, radius_px=52.5, samples=16)
COARSE: Final = View(width_px=256, height_px=150, radius_px=26.25, samples=4)
"""For measuring a whole set before it is rendered."""

BACKGROUND: Final = float(decode_srgb(np.array(128 / 255)))
"""Display-referred linear light behind the objects: the grey that surrounds the runners' images."""

_COLUMNS: Final = 4
_SPACING: Final = (2.4375, 2.857)  # of the objects' centres, in their radii
_LIFT: Final = 0.08  # leaves room below the objects for their numbers


def place_objects(order: str, generator: np.random.Generator) -> list[Placed]:
    """Return eight objects of table 2.1, each of a shape of its own.

    Parameters
    ----------
    order
        Their letters in reading order.
    generator
        Draws the shapes and the textures.
    """
    placed = []
    for index, letter in enumerate(order):
        material = TABLE_2_1[letter]
        row, column = divmod(index, _COLUMNS)
        x = (column - (_COLUMNS - 1) / 2) * _SPACING[0]
        y = (0.5 - row) * _SPACING[1] + _LIFT
        shape = AbstractShape(generator)
        albedo = material.albedo_at(sphere_directions(*_texture_size(material)), generator)
        placed.append(Placed(shape.mesh(), material, albedo, (x, y)))
    return placed


def _texture_size(material: Material) -> tuple[int, int]:
    """Return rows and columns that leave no texel larger than a pixel where it would show."""
    return {"plain": (2, 4), "checkerboard": (1024, 2048)}.get(material.pattern, (384, 768))
