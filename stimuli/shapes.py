"""Abstract objects: ellipsoids dented and swollen by noise, asymmetric and globally convex."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.noise import PerlinNoise
from stimuli.mesh import Mesh

_NOISE_FREQUENCY: Final = 1.2
_OCTAVES: Final = 2
_OCTAVE_GAIN: Final = 0.2
_RADIUS_DEVIATION: Final = 0.10
_AXES: Final = (0.9, 1.05)
_DIFFERENCE_STEP: Final = 1e-4


class AbstractShape:
    """A star-shaped surface: its radius in every direction is an ellipsoid's times noise.

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
        vertices = directions * self.radius(directions)[..., None]
        u, v = np.meshgrid(np.arange(columns + 1) / columns, np.arange(rows + 1) / rows)
        return Mesh(
            vertices.reshape(-1, 3),
            self.normal(directions).reshape(-1, 3),
            np.stack([u, v], axis=-1).reshape(-1, 2),
            _sphere_faces(rows, columns),
        )

    def _level(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        distance = np.linalg.norm(points, axis=-1)
        return np.asarray(distance / self.radius(points / distance[..., None]))


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


def _sphere_faces(rows: int, columns: int) -> NDArray[np.int64]:
    index = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    upper_left, upper_right = index[:-1, :-1], index[:-1, 1:]
    lower_left, lower_right = index[1:, :-1], index[1:, 1:]
    first = np.stack([upper_left, lower_left, lower_right], axis=-1)[:-1]
    second = np.stack([upper_left, lower_right, upper_right], axis=-1)[1:]
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])
