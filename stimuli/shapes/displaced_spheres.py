"""Star-shaped objects: ellipsoids dented and swollen by noise, from smooth to rugged."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from algorithms.errors import InputError
from algorithms.noise import PerlinNoise
from stimuli.shapes.gaussian_noise import GaussianNoise
from stimuli.shapes.mesh import Mesh, grid_mesh

Noise = Callable[[NDArray[np.floating[Any]]], NDArray[np.float64]]

_NOISE_FREQUENCY: Final = 1.2
_OCTAVES: Final = 2
_OCTAVE_GAIN: Final = 0.2
_RADIUS_DEVIATION: Final = 0.10
_AXES: Final = (0.9, 1.05)
_DIFFERENCE_STEP: Final = 1e-4

_PEBBLE_AXES: Final = (0.75, 1.05)
_FRACTAL_DEVIATION: Final = (0.02, 0.08)
_GAUSSIAN_SCALES: Final = (0.4, 0.2, 0.08)
_GAUSSIAN_DEVIATIONS: Final = (0.06, 0.03, 0.008)

LIGHTPROBES: Final = {"O1": 0.0, "O2": 1 / 3, "O3": 2 / 3, "O4": 1.0}
"""The complexity of a `RuggedShape` in the place of each object of Lopez-Moreno 2011, fig. 3.9."""


class StarShape(ABC):
    """A closed surface around the origin that every ray from there meets once."""

    @abstractmethod
    def radius(self, directions: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the distance of the surface from the centre along unit directions `(..., 3)`.

        The largest is 1, within the sampling of the directions used to scale it.
        """

    def normal(self, directions: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the outward unit normals of the surface along unit directions `(..., 3)`."""
        # The surface is where |p| / radius(p / |p|) = 1; its gradient points out.
        points = directions * self.radius(directions)[..., None]
        steps = np.eye(3) * _DIFFERENCE_STEP
        gradient = np.stack([self._level(points + step) - 1 for step in steps], axis=-1)
        return np.asarray(gradient / np.linalg.norm(gradient, axis=-1, keepdims=True))

    def mesh(self, rows: int = 128, columns: int = 256) -> Mesh:
        """Return the surface as a closed mesh.

        Parameters
        ----------
        rows, columns
            Quadrilaterals from pole to pole and around; the vertices of the seam stand twice, with
            texture coordinate 0 and 1.
        """
        directions = sphere_directions(rows, columns)
        return grid_mesh(directions * self.radius(directions)[..., None], self.normal(directions))

    def _level(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        distance = np.linalg.norm(points, axis=-1)
        return np.asarray(distance / self.radius(points / distance[..., None]))


class AbstractShape(StarShape):
    """An asymmetric, globally convex surface: an ellipsoid's radius times noise.

    Parameters
    ----------
    generator
        Draws the ellipsoid's axes, its orientation and the noise.

    Notes
    -----
    All shapes share the noise's frequency and the standard deviation of its relative radius, so
    that they differ in form and hardly in complexity (Lopez-Moreno 2011, sec. 2.3).
    """

    def __init__(self, generator: np.random.Generator) -> None:
        self._noise = PerlinNoise(generator)
        self._offset = generator.uniform(0, 64, size=3)
        self._axes = generator.uniform(*_AXES, size=3)
        frame, triangle = np.linalg.qr(generator.normal(size=(3, 3)))
        self._rotation = frame * np.sign(np.diag(triangle))
        self._gain, self._scale = 1.0, 1.0
        radii = self.radius(sphere_directions(32, 64).reshape(-1, 3))
        deviation = np.log(radii).std()
        self._gain = _RADIUS_DEVIATION / deviation
        self._scale = 1 / self.radius(sphere_directions(64, 128).reshape(-1, 3)).max()

    def radius(self, directions: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the distance of the surface from the centre along unit directions `(..., 3)`.

        The largest is 1, within the sampling of the directions used to scale it.
        """
        ellipsoid = 1 / np.linalg.norm((directions @ self._rotation) / self._axes, axis=-1)
        noise = self._noise.fractal(
            directions * _NOISE_FREQUENCY + self._offset, _OCTAVES, _OCTAVE_GAIN
        )
        return np.asarray(self._scale * np.exp(self._gain * (np.log(ellipsoid) + noise)))


class RuggedShape(StarShape):
    """An ellipsoid with fractal noise, and Gaussian noise at three ever finer scales.

    Parameters
    ----------
    generator
        Draws the shape and the noise; what it draws does not depend on the complexity.
    complexity
        0..1: how much noise there is. 0 is a pebble; the surface's bending energy
        (`stimuli.shapes.curvature`) grows with it, from a sphere's to several times that.

    Raises
    ------
    InputError
        If the complexity is outside 0..1.

    Notes
    -----
    After Lopez-Moreno 2011, fig. 3.9, whose numbers are not stated; ours are the constants above.
    The finer a scale is, the later it comes in: its share is a higher power of the complexity.
    """

    def __init__(self, generator: np.random.Generator, complexity: float) -> None:
        check_complexity(complexity)
        self._axes = generator.uniform(*_PEBBLE_AXES, size=3)
        self._rotation = Rotation.random(rng=generator).as_matrix()
        self._perlin = PerlinNoise(generator)
        self._offset = generator.uniform(0, 64, size=3)
        self._fields = [GaussianNoise(generator, scale) for scale in _GAUSSIAN_SCALES]
        low, high = _FRACTAL_DEVIATION
        self._gains = [low + (high - low) * complexity]
        self._gains += [
            deviation * complexity ** (1 + step)
            for step, deviation in enumerate(_GAUSSIAN_DEVIATIONS)
        ]
        self._gains[0] /= self._fractal(sphere_directions(32, 64)).std()
        self._scale = 1.0
        self._scale = 1 / self.radius(sphere_directions(128, 256)).max()

    def radius(self, directions: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the distance of the surface from the centre along unit directions `(..., 3)`.

        The largest is 1, within the sampling of the directions used to scale it.
        """
        noises: list[Noise] = [self._fractal, *self._fields]
        logarithm = -np.log(np.linalg.norm((directions @ self._rotation) / self._axes, axis=-1))
        for gain, noise in zip(self._gains, noises, strict=True):
            if gain:
                logarithm += gain * noise(directions)
        return np.asarray(self._scale * np.exp(logarithm))

    def mesh(self, rows: int = 256, columns: int = 512) -> Mesh:
        """Return the surface as a closed mesh of radius 1, finer than that of smoother shapes."""
        mesh = super().mesh(rows, columns)
        return mesh.moved(np.zeros(3), 1 / mesh.bounding_radius)

    def _fractal(self, directions: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        points = directions * _NOISE_FREQUENCY + self._offset
        return self._perlin.fractal(points, _OCTAVES, _OCTAVE_GAIN)


def check_complexity(complexity: float) -> None:
    """Raise InputError unless the complexity is in 0..1."""
    if not 0 <= complexity <= 1:
        raise InputError(f"complexity: 0..1 is accepted, not {complexity}")


def sphere_directions(rows: int, columns: int) -> NDArray[np.float64]:
    """Return unit vectors over longitude and latitude: `(rows + 1, columns + 1, 3)`.

    Rows run from +y to -y; columns around y, the last equal to the first.
    """
    polar = np.linspace(0, np.pi, rows + 1)[:, None]
    longitude = np.linspace(0, 2 * np.pi, columns + 1)[None, :]
    longitude = np.where(longitude == longitude[0, -1], 0.0, longitude)
    radial = np.where((polar == 0) | (polar == np.pi), 0.0, np.sin(polar))
    y = np.broadcast_to(np.cos(polar), (rows + 1, columns + 1))
    return np.stack([radial * np.sin(longitude), y, radial * np.cos(longitude)], axis=-1)
