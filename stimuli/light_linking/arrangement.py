"""The scene of chapter 2: eight abstract objects in two rows."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from algorithms.color import decode_srgb
from stimuli.camera import View
from stimuli.light_linking.materials import Material
from stimuli.light_linking.placed_objects import Placed
from stimuli.shapes.displaced_spheres import AbstractShape, sphere_directions

FULL: Final = View(width_px=1024, height_px=600, radius_px=105, samples=16)
QUICK: Final = View(width_px=512, height_px=300, radius_px=52.5, samples=16)
COARSE: Final = View(width_px=256, height_px=150, radius_px=26.25, samples=4)
"""For measuring a whole set before it is rendered."""

BACKGROUND: Final = float(decode_srgb(np.array(128 / 255)))
"""Display-referred linear light behind the objects: the grey that surrounds the runners' images."""

OBJECTS: Final = 8
_MESH_SIZE: Final = (128, 256)
_COLUMNS: Final = 4
_SPACING: Final = (2.4375, 2.857)  # of the objects' centres, in their radii
_LIFT: Final = 0.08  # leaves room below the objects for their numbers


def place_objects(
    materials: Sequence[Material], generator: np.random.Generator, coarseness: int = 1
) -> list[Placed]:
    """Return eight objects, each of a shape of its own.

    Parameters
    ----------
    materials
        Theirs, in reading order.
    generator
        Draws the shapes and the textures.
    coarseness
        How many times coarser than for pictures meshes and textures are: 1, 2, 4 or 8; the objects
        are the same.
    """
    placed = []
    for index, material in enumerate(materials):
        row, column = divmod(index, _COLUMNS)
        x = (column - (_COLUMNS - 1) / 2) * _SPACING[0]
        y = (0.5 - row) * _SPACING[1] + _LIFT
        shape = AbstractShape(generator)
        texels = (max(2, extent // coarseness) for extent in _texture_size(material))
        albedo = material.albedo_at(sphere_directions(*texels), generator)
        rows, columns = (extent // coarseness for extent in _MESH_SIZE)
        placed.append(Placed(shape.mesh(rows, columns), material, albedo, (x, y)))
    return placed


def _texture_size(material: Material) -> tuple[int, int]:
    """Return rows and columns that leave no texel larger than a pixel where it would show."""
    return {"plain": (2, 4), "perlin": (384, 768)}.get(material.pattern, (1024, 2048))
