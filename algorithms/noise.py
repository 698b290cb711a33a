"""Perlin's gradient noise in three dimensions."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

_TABLE_SIZE: Final = 256


class PerlinNoise:
    """Gradient noise over space, of zero mean and smooth to the second derivative.

    Parameters
    ----------
    generator
        Draws the lattice's gradients; the same state gives the same noise.

    Notes
    -----
    Perlin 2002, *Improving noise*: the quintic fade curve. The gradients are unit vectors uniform
    over the sphere instead of twelve fixed ones, so that no axis is preferred.
    """

    def __init__(self, generator: np.random.Generator) -> None:
        gradients = generator.normal(size=(_TABLE_SIZE, 3))
        self._gradients = gradients / np.linalg.norm(gradients, axis=1, keepdims=True)
        self._permutation = generator.permutation(_TABLE_SIZE)

    def __call__(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the noise at points `(..., 3)`, in lattice units: `(...)`, within -1..1."""
        points = np.asarray(points, dtype=np.float64)
        cell = np.floor(points).astype(np.int64)
        offset = points - cell
        fade = offset**3 * (offset * (offset * 6 - 15) + 10)
        weights = (1 - fade, fade)
        total = np.zeros(points.shape[:-1])
        for i, j, k in np.ndindex(2, 2, 2):
            weight = weights[i][..., 0] * weights[j][..., 1] * weights[k][..., 2]
            corner = np.array([i, j, k])
            gradient = self._gradients[self._hash(cell + corner)]
            total += weight * np.einsum("...i,...i->...", gradient, offset - corner)
        return total

    def fractal(
        self, points: NDArray[np.floating[Any]], octaves: int, gain: float = 0.5
    ) -> NDArray[np.float64]:
        """Sum octaves, each of twice the frequency and `gain` times the amplitude of the last."""
        total = np.zeros(np.shape(points)[:-1])
        for octave in range(octaves):
            total += gain**octave * self(np.asarray(points) * 2.0**octave)
        return total

    def _hash(self, lattice: NDArray[np.int64]) -> NDArray[np.int64]:
        index = np.zeros(lattice.shape[:-1], dtype=np.int64)
        for axis in range(3):
            index = self._permutation[(index + lattice[..., axis]) % _TABLE_SIZE]
        return index
