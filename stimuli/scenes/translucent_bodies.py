"""The bodies of chapter 9: four shapes, from a pebble to a rugged lump, of any medium and size."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Final

import mitsuba as mi
import numpy as np

from stimuli.shapes.displaced_spheres import RuggedShape
from stimuli.shapes.distance_fields import tube
from stimuli.shapes.implicit import smooth_union, surface_of
from stimuli.shapes.mesh import Mesh, Value, to_mitsuba
from stimuli.shapes.metaballs import random_metaballs
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.media import medium_named
from stimuli.translucency.renderer import Translucent

SHAPES: Final = ("pebble", "heart", "creature", "rugged")
"""In order of complexity: the first is convex, the second nearly so."""

PROFILE_STEPS: Final = 100


class Bodies:
    """Translucent bodies, each made when it is first needed.

    Parameters
    ----------
    seed
        Draws the shapes but for the heart, which is one for any seed.
    """

    def __init__(self, seed: int) -> None:
        self.mesh: Callable[[str], Mesh] = lru_cache(None)(lambda shape: mesh_of(shape, seed))
        """From a name out of `SHAPES` to a closed mesh of radius 1."""
        self.body: Callable[[str, str, float], Translucent] = lru_cache(None)(self._body)
        """From a shape's name, a medium's and a radius in mm to a body without highlights."""
        self.scene: Callable[[str], Value] = lru_cache(None)(self._scene)
        """From a shape's name to Mitsuba's scene of nothing else."""

    def _body(self, shape: str, medium: str, radius_mm: float) -> Translucent:
        return Translucent(self.mesh(shape), medium_named(medium), radius_mm)

    def _scene(self, shape: str) -> Value:
        body = to_mitsuba(self.mesh(shape), {"type": "diffuse"}, "body")
        return mi.load_dict({"type": "scene", "body": body})

    def profile(self, shape: str, medium: str, radius_mm: float) -> dict[str, Any]:
        """Return R_d on a body's own scale, as JSON.

        Returns
        -------
        `width_mm` of the body along x; `distance_widths`, from 0 to 1 in widths; `reflectance`,
        `(r, g, b)` at each of these per square width.
        """
        width_mm = float(np.ptp(self.mesh(shape).vertices[:, 0])) * radius_mm
        distances = np.linspace(0, 1, PROFILE_STEPS + 1)
        values = Dipole.of(medium_named(medium))(distances * width_mm) * width_mm**2
        return {
            "object": shape,
            "medium": medium,
            "radius_mm": radius_mm,
            "width_mm": width_mm,
            "distance_widths": distances.tolist(),
            "reflectance": values.tolist(),
        }


def mesh_of(shape: str, seed: int) -> Mesh:
    """Return the closed mesh, of radius 1, of a shape of `SHAPES`."""
    generator = np.random.default_rng([seed, SHAPES.index(shape)])
    makers: dict[str, Callable[[], Mesh]] = {
        "pebble": lambda: RuggedShape(generator, complexity=0).mesh(64, 128),
        "heart": _heart,
        "creature": lambda: random_metaballs(generator, complexity=0.7, cells=96),
        "rugged": lambda: RuggedShape(generator, complexity=1).mesh(128, 256),
    }
    return makers[shape]()


def _heart() -> Mesh:
    halves = [
        tube([(0.40 * side, 0.32, 0), (0.30 * side, -0.10, 0), (0.04 * side, -0.80, 0)], radii)
        for side, radii in ((-1, (0.44, 0.36, 0.06)), (1, (0.44, 0.36, 0.06)))
    ]
    return surface_of(smooth_union(halves, 0.05), cells=96).fitted()
