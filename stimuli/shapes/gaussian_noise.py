"""Gaussian noise of one spatial scale, in three dimensions."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

_WAVES: Final = 64


class GaussianNoise:
    """A smooth random field of zero mean and unit variance, with correlation exp(-d^2 / 2 s^2).

    Parameters
    ----------
    generator
        Draws the field.
    scale
        The correlation's length s, in the unit of the points.

    Notes
    -----
    A sum of plane waves whose frequencies follow the correlation's spectrum (Rahimi and Recht
    2007, *Random features for large-scale kernel machines*, sec. 3): Gaussian as their number
    grows, and without a grid.
    """

    def __init__(self, generator: np.random.Generator, scale: float) -> None:
        self._frequencies = generator.normal(size=(3, _WAVES)) / scale
        self._phases = generator.uniform(0, 2 * np.pi, size=_WAVES)

    def __call__(self, points: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        """Return the noise at points `(..., 3)`: `(...)`."""
        waves = np.cos(points @ self._frequencies + self._phases)
        return np.asarray(waves.sum(axis=-1) * np.sqrt(2 / _WAVES))
