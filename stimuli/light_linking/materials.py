"""The materials of experiments 1 and 2: matt or glossy, plain, noisy or chequered."""

from dataclasses import dataclass
from typing import Any, Final, Literal

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.noise import PerlinNoise

Finish = Literal["diffuse", "shiny"]
Pattern = Literal["plain", "perlin", "checkerboard", "squares"]

ROUGHNESS: Final = 0.16
"""Of the shiny objects of experiment 1."""

_REFRACTIVE_INDEX: Final = 1.5
_PERLIN_CONTRAST: Final = 1.6


@dataclass(frozen=True)
class Material:
    """How a surface reflects light; achromatic.

    Attributes
    ----------
    finish
        `diffuse` (Lambertian) or `shiny` (a Lambertian base under a glossy coat).
    pattern
        How the diffuse albedo varies over the surface: noise, a checkerboard in space (whose tiles
        are cut by the surface into many forms), or one of nearly square tiles on the surface.
    albedo
        Lowest and highest diffuse albedo, 0..1; equal for a plain surface.
    frequency
        How many of the pattern's tiles, or cells of the noise's lattice, stand side by side in the
        length of an object's radius, more than 0; a plain surface has none.
    roughness
        Of the coat of a shiny surface, more than 0 and at most 1; see `plugin`.
    """

    finish: Finish
    pattern: Pattern
    albedo: tuple[float, float]
    frequency: float = 0.0
    roughness: float = ROUGHNESS

    def albedo_at(
        self, points: NDArray[np.floating[Any]], generator: np.random.Generator
    ) -> NDArray[np.float64]:
        """Return the diffuse albedo over the object: a solid texture, without seams.

        Parameters
        ----------
        points
            `(..., 3)`: where in the solid; unit directions from the object's centre give a texture
            that is stretched as the surface swells.
        generator
            Draws the texture's phase; two points share a texture only through one call.

        Returns
        -------
        Albedo `(...)`.
        """
        low, high = self.albedo
        return low + (high - low) * self._share(points, generator)

    def _share(
        self, points: NDArray[np.floating[Any]], generator: np.random.Generator
    ) -> NDArray[np.float64]:
        if self.pattern == "plain":
            return np.ones(points.shape[:-1])
        if self.pattern == "checkerboard":
            # Turned, lest a tile's border be seen edge-on as a straight line.
            turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
            tiles = np.floor(points @ turn * self.frequency + generator.uniform(size=3))
            return np.asarray(tiles.sum(axis=-1) % 2)
        if self.pattern == "squares":
            turn = np.linalg.qr(generator.normal(size=(3, 3)))[0]
            return squares(points @ turn, 2 * round(self.frequency * np.pi / 4))
        noise = PerlinNoise(generator)
        offset = generator.uniform(0, 64, size=3)
        values = noise.fractal(points * self.frequency + offset, 2)
        return np.clip(0.5 + 0.5 * _PERLIN_CONTRAST * values, 0, 1)

    def plugin(self, albedo: NDArray[np.float64]) -> dict[str, Any]:
        """Return Mitsuba's description of the material with this albedo over the surface.

        Parameters
        ----------
        albedo
            `(rows, columns)`, or `(rows, columns, 3)` where it has a colour, over latitude and
            longitude, as texture coordinates run.

        Notes
        -----
        Mitsuba has no Phong lobe: `roughplastic` with a Beckmann distribution stands in, which is
        close to a Blinn-Phong exponent of 2 / roughness^2 - 2 (Walter et al. 2007), 76 for
        experiment 1; see `roughness_of`.
        """
        texels = albedo if albedo.ndim == 3 else albedo[..., None]
        texture = {
            "type": "bitmap",
            "bitmap": mi.Bitmap(np.ascontiguousarray(texels, dtype=np.float32)),
            "raw": True,
            "wrap_mode": "repeat",
        }
        if self.finish == "diffuse":
            return {"type": "diffuse", "reflectance": texture}
        return {
            "type": "roughplastic",
            "distribution": "beckmann",
            "alpha": self.roughness,
            "int_ior": _REFRACTIVE_INDEX,
            "diffuse_reflectance": texture,
        }


def squares(directions: NDArray[np.floating[Any]], tiles: int) -> NDArray[np.float64]:
    """Return a checkerboard over the sphere: the faces of a cube, each of equally wide tiles.

    Parameters
    ----------
    directions
        `(..., 3)`, of any length but 0.
    tiles
        Along an edge of the cube, a quarter of the sphere's circumference; an even number.

    Returns
    -------
    0 or 1 `(...)`. Three tiles meet at a corner of the cube, so that not all neighbours can
    differ: they do within the faces, and across eight of the twelve edges.
    """
    directions = directions.astype(np.float32)  # fine enough for borders, and faster
    axis = np.abs(directions).argmax(axis=-1)
    beside = np.stack([(axis + 1) % 3, (axis + 2) % 3], axis=-1)
    along = np.take_along_axis(directions, axis[..., None], axis=-1)[..., 0]
    across = np.take_along_axis(directions, beside, axis=-1) / np.abs(along)[..., None]
    # By angle: through the centre of the cube, its tiles are seen at one width.
    index = np.floor((np.arctan(across) * 4 / np.pi + 1) / 2 * tiles).clip(0, tiles - 1)
    face = (along > 0) ^ (axis == 0)
    return np.asarray((index.sum(axis=-1) + face) % 2)


def roughness_of(exponent: float) -> float:
    """Return the roughness whose highlight is about that of a Blinn-Phong exponent, 0 or more."""
    return float(np.sqrt(2 / (exponent + 2)))


def exponent_of(roughness: float) -> float:
    """Return the Blinn-Phong exponent of about the same highlight as a roughness in 0..1."""
    return 2 / roughness**2 - 2


TABLE_2_1: Final[dict[str, Material]] = {
    "a": Material("diffuse", "plain", (0.85, 0.85)),
    "b": Material("diffuse", "perlin", (0.06, 0.50), frequency=7.0),
    "c": Material("diffuse", "plain", (0.16, 0.16)),
    "d": Material("shiny", "checkerboard", (0.04, 0.72), frequency=2.6),
    "e": Material("shiny", "checkerboard", (0.04, 0.72), frequency=2.6),
    "f": Material("diffuse", "plain", (0.30, 0.30)),
    "g": Material("shiny", "perlin", (0.04, 0.42), frequency=1.8),
    "h": Material("shiny", "plain", (0.20, 0.20)),
}
"""Finish and pattern by object (Lopez-Moreno 2011, table 2.1); the albedos are ours, spread so that
an object's brightness says little about its light."""
