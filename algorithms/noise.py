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

    def image(
        self, shape: tuple[int, int], period_px: float, octaves: int, gain: float = 0.5
    ) -> NDArray[np.float32]:
        """Return a picture of fractal noise: that over ``(row, column, 0) / period_px``, faster.

        Parameters
        ----------
        shape
            Height and width.
        period_px
            Cells of the lattice of the first octave, more than 0.
        octaves, gain
            As of `fractal`.
        """
        total = np.zeros(shape, dtype=np.float32)
        for octave in range(octaves):
            step = 2.0**octave / period_px
            rows, columns = (np.arange(extent, dtype=np.float64) * step for extent in shape)
            self._add_plane(total, rows, columns, gain**octave)
        return total

    def _add_plane(
        self,
        total: NDArray[np.float32],
        rows: NDArray[np.float64],
        columns: NDArray[np.float64],
        amplitude: float,
    ) -> None:
        """Add the noise at all pairs of a row and a column, its third coordinate 0."""
        down, across = (np.floor(axis).astype(np.int64) for axis in (rows, columns))
        corners = np.indices((down.max() + 2, across.max() + 2, 1))[..., 0]
        slopes = self._gradients[self._hash(np.moveaxis(corners, 0, -1))] * amplitude
        # Between columns first, at the lattice's few rows: values there, and slopes down from them.
        values, steepness = (np.zeros((len(slopes), columns.size), np.float32) for _ in range(2))
        for j in range(2):
            step = columns - across - j
            values += slopes[:, across + j, 1] * (step * _hat(step))
            steepness += slopes[:, across + j, 0] * _hat(step)
        for i in range(2):
            step = rows - down - i
            fade = _hat(step)
            weight, slope = (side[:, None].astype(np.float32) for side in (fade, step * fade))
            total += weight * values[down + i]
            total += slope * steepness[down + i]

    def _hash(self, lattice: NDArray[np.int64]) -> NDArray[np.int64]:
        index = np.zeros(lattice.shape[:-1], dtype=np.int64)
        for axis in range(3):
            index = self._permutation[(index + lattice[..., axis]) % _TABLE_SIZE]
        return index


def _hat(distance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the quintic fade: 1 at a lattice point, 0 at its neighbours."""
    rest = 1 - np.abs(distance)
    return np.asarray(rest**3 * (rest * (rest * 6 - 15) + 10))
