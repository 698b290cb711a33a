"""Bodies that flow together from balls: from a sphere to a creature with a dozen limbs."""

from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from stimuli.shapes.displaced_spheres import check_complexity
from stimuli.shapes.distance_fields import capsule, ellipsoid
from stimuli.shapes.implicit import smooth_union, surface_of
from stimuli.shapes.mesh import Mesh

_LIMBS: Final = 12
_BODY_RADIUS: Final = 0.5
_LIMB_RADII: Final = (0.10, 0.18)
_FIRST_REACH: Final = 0.32
_REACH: Final = (0.55, 0.85)
_JITTER: Final = 0.25
_SOFTNESS: Final = 0.06


def random_metaballs(generator: np.random.Generator, complexity: float, cells: int = 128) -> Mesh:
    """Return a ball from which twelve limbs have grown so far, of radius 1 around the origin.

    Parameters
    ----------
    generator
        Draws the limbs' directions, thickness and reach; the same for every complexity.
    complexity
        0..1: how far the limbs have grown. 0 is nearly a sphere; the bending energy
        (`stimuli.shapes.curvature`) grows with it.
    cells
        As of `surface_of`.

    Raises
    ------
    InputError
        If the complexity is outside 0..1.
    """
    check_complexity(complexity)
    # A spiral of points about evenly apart (Gonzalez 2010), jittered and turned as if grown.
    y = 1 - (2 * np.arange(_LIMBS) + 1) / _LIMBS
    longitude = np.arange(_LIMBS) * np.pi * (3 - np.sqrt(5))
    radial = np.sqrt(1 - y**2)
    directions = np.column_stack([radial * np.sin(longitude), y, radial * np.cos(longitude)])
    directions += generator.normal(scale=_JITTER, size=directions.shape)
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    directions = Rotation.random(rng=generator).apply(directions)
    radii = generator.uniform(*_LIMB_RADII, size=_LIMBS)
    reaches = generator.uniform(*_REACH, size=_LIMBS)
    body = ellipsoid(np.zeros(3), np.full(3, _BODY_RADIUS))
    ends = directions * (_FIRST_REACH + complexity * (reaches - _FIRST_REACH))[:, None]
    limbs = [capsule(np.zeros(3), end, radius) for end, radius in zip(ends, radii, strict=True)]
    return surface_of(smooth_union([body, *limbs], _SOFTNESS), cells).fitted()
