"""The light probes of chapter 3: objects whose shading tells where the lights are."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from stimuli.light_linking.materials import Material, exponent_of, roughness_of
from stimuli.light_linking.placed_objects import Placed
from stimuli.shapes.displaced_spheres import LIGHTPROBES, RuggedShape, StarShape, sphere_directions
from stimuli.shapes.distance_fields import capsule, ellipsoid
from stimuli.shapes.gaussian_noise import GaussianNoise
from stimuli.shapes.implicit import smooth_union, surface_of
from stimuli.shapes.mesh import Mesh

_MATT: Final = Material("diffuse", "plain", (0.6, 0.6))
_GREY: Final = (1.0, 1.0, 1.0)
_RED: Final = (1.0, 0.36, 0.25)

TEXTURE_FREQUENCIES: Final = {"O5": 1.5, "O6": 3.0, "O7": 6.0, "O8": 12.0}
"""Of the fractal noise of the materials O5 to O8, in cells of its lattice in a radius."""

GLOSS_EXPONENTS: Final = {"gloss-10": 10.0, "gloss-40": 40.0, "gloss-160": 160.0}
"""About the Blinn-Phong exponents of the glossy probes; `gloss-0` is matt and otherwise alike."""

_TEXTURED_SHAPE: Final = "O2"


@dataclass(frozen=True)
class Probe:
    """What a probe is made of.

    Attributes
    ----------
    shape
        A name out of `SHAPES`.
    material
        How it reflects.
    colour
        What its diffuse albedo is multiplied by, per channel.
    """

    shape: str
    material: Material = _MATT
    colour: tuple[float, float, float] = _GREY

    @property
    def complexity(self) -> float:
        """The complexity of a `RuggedShape`, 0..1, and -1 for other shapes."""
        return LIGHTPROBES.get(self.shape, -1.0)

    @property
    def gloss(self) -> float:
        """About the Blinn-Phong exponent of its highlights; 0 for a matt probe."""
        return exponent_of(self.material.roughness) if self.material.finish == "shiny" else 0.0

    def placed(self, seed: int, coarseness: int = 1) -> Placed:
        """Return the probe in the middle of a scene.

        Parameters
        ----------
        seed
            Draws shapes and textures; equal shapes, and O1 to O4 but for their complexity, are one
            object.
        coarseness
            How many times coarser than for pictures meshes and textures are: 1, 2, 4 or 8.
        """
        generator = np.random.default_rng([seed, 2])
        texels = (4, 8) if self.material.pattern == "plain" else (1024, 2048)
        directions = sphere_directions(*(max(2, extent // coarseness) for extent in texels))
        albedo = self.material.albedo_at(directions, generator)
        if self.colour != _GREY:
            albedo = albedo[..., None] * np.array(self.colour)
        return Placed(self.mesh(seed, coarseness), self.material, albedo, (0.0, 0.0))

    def mesh(self, seed: int, coarseness: int = 1) -> Mesh:
        """Return its shape; see `placed`."""
        return SHAPES[self.shape](np.random.default_rng([seed, 1]), coarseness)


PROBES: Final[dict[str, Probe]] = {
    **{name: Probe(name) for name in LIGHTPROBES},
    **{
        name: Probe(_TEXTURED_SHAPE, Material("diffuse", "perlin", (0.2, 0.8), frequency))
        for name, frequency in TEXTURE_FREQUENCIES.items()
    },
    "gloss-0": Probe(_TEXTURED_SHAPE, Material("diffuse", "plain", (0.75, 0.75)), _RED),
    **{
        name: Probe(
            _TEXTURED_SHAPE,
            Material("shiny", "plain", (0.75, 0.75), roughness=roughness_of(exponent)),
            _RED,
        )
        for name, exponent in GLOSS_EXPONENTS.items()
    },
    "apple": Probe(
        "apple",
        Material("shiny", "perlin", (0.55, 0.8), frequency=3.0, roughness=roughness_of(30)),
        _RED,
    ),
    "head": Probe("head", _MATT, (1.0, 0.75, 0.62)),
    "quilt": Probe(
        "quilt", Material("diffuse", "squares", (0.25, 0.7), 8 / (np.pi / 2)), (0.8, 0.9, 1.0)
    ),
}
"""The probes by name. O1 to O8 as in Lopez-Moreno 2011, table 3.2: shapes of growing complexity and
materials of growing frequency. The photographs of table 3.1 show an apple, the head of a guitar
player and a quilt: an apple-shaped body, a bald head of ellipsoids and a chequered cushion stand in
for them. The glossy ones are coloured, as methods that remove highlights go by colour."""


_APPLE_TURN: Final = Rotation.from_euler("XZ", [28, -8], degrees=True).as_matrix()


class AppleShape(StarShape):
    """A sphere with a deep dent above and a shallow one below, slightly uneven."""

    def __init__(self, generator: np.random.Generator) -> None:
        self._noise = GaussianNoise(generator, 0.7)
        self._scale = 1.0
        self._scale = 1 / self.radius(sphere_directions(128, 256)).max()

    def radius(self, directions: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the distance of the surface from the centre along unit directions `(..., 3)`."""
        # By the height and not the angle: smooth at the poles.
        y = directions[..., 1]
        dents = 0.5 * np.exp((y - 1) / 0.09) + 0.14 * np.exp((-y - 1) / 0.05)
        body = 1 - 0.1 * (1 - y) / 2 + 0.03 * self._noise(directions)
        return np.asarray(self._scale * body * (1 - dents))


class CushionShape(StarShape):
    """A box with well-rounded edges and folds."""

    _AXES: Final = np.array([1.0, 0.8, 0.6])
    _POWER: Final = 3.5

    def __init__(self, generator: np.random.Generator) -> None:
        self._folds = [GaussianNoise(generator, scale) for scale in (0.45, 0.2)]
        self._scale = 1.0
        self._scale = 1 / self.radius(sphere_directions(128, 256)).max()

    def radius(self, directions: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the distance of the surface from the centre along unit directions `(..., 3)`."""
        level = (np.abs(directions / self._AXES) ** self._POWER).sum(axis=-1)
        large, small = (fold(directions) for fold in self._folds)
        return np.asarray(
            self._scale * level ** (-1 / self._POWER) * np.exp(0.06 * large + 0.02 * small)
        )


def head(cells: int = 192) -> Mesh:
    """Return a bald head on its neck, turned a little to the right, of radius 1."""
    parts = [
        ellipsoid((0, 0.22, -0.06), (0.50, 0.52, 0.58)),  # skull
        ellipsoid((0, -0.10, 0.14), (0.40, 0.55, 0.42)),  # face
        ellipsoid((0, -0.46, 0.30), (0.20, 0.14, 0.18)),  # chin
        ellipsoid((0, 0.18, 0.46), (0.30, 0.07, 0.10)),  # brow
        capsule((0, 0.10, 0.56), (0, -0.10, 0.66), 0.07),  # nose
        ellipsoid((0, -0.27, 0.50), (0.14, 0.06, 0.08)),  # mouth
        *(ellipsoid((side * 0.22, -0.08, 0.40), (0.13, 0.13, 0.12)) for side in (-1, 1)),
        *(ellipsoid((side * 0.49, 0.06, -0.04), (0.06, 0.17, 0.11)) for side in (-1, 1)),
        capsule((0, -0.4, -0.08), (0, -0.82, -0.12), 0.25),  # neck
    ]
    mesh = surface_of(smooth_union(parts, 0.05), cells, reach=1.2)
    return mesh.rotated(Rotation.from_euler("YX", [25, 8], degrees=True).as_matrix()).fitted()


def _rugged(complexity: float) -> Callable[[np.random.Generator, int], Mesh]:
    return lambda generator, coarseness: RuggedShape(generator, complexity).mesh(
        256 // coarseness, 512 // coarseness
    )


SHAPES: Final[dict[str, Callable[[np.random.Generator, int], Mesh]]] = {
    **{name: _rugged(complexity) for name, complexity in LIGHTPROBES.items()},
    "apple": lambda generator, coarseness: (
        AppleShape(generator).mesh(256 // coarseness, 512 // coarseness).rotated(_APPLE_TURN)
    ),
    "quilt": lambda generator, coarseness: CushionShape(generator).mesh(
        256 // coarseness, 512 // coarseness
    ),
    "head": lambda _, coarseness: head(192 // coarseness),
}
"""What makes a shape, of radius 1 around the origin, from a generator and a coarseness."""
