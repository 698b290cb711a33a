"""The shape families whose complexity can be set, by name."""

from collections.abc import Callable
from typing import Final

import numpy as np

from stimuli.shapes.displaced_spheres import RuggedShape
from stimuli.shapes.lathe import random_lathe
from stimuli.shapes.mesh import Mesh
from stimuli.shapes.metaballs import random_metaballs
from stimuli.shapes.superquadric import random_superquadric


def random_rugged(generator: np.random.Generator, complexity: float) -> Mesh:
    """Return a `RuggedShape` as a mesh."""
    return RuggedShape(generator, complexity).mesh()


FAMILIES: Final[dict[str, Callable[[np.random.Generator, float], Mesh]]] = {
    "rugged": random_rugged,
    "superquadric": random_superquadric,
    "metaballs": random_metaballs,
    "lathe": random_lathe,
}
"""Each takes a generator and a complexity in 0..1, which does not change what is drawn, and returns
a closed mesh around the origin of radius 1, whose bending energy grows with the complexity."""
