"""Ellipsoids under known lights, shaded by hand: ground truth without a renderer."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light


def ellipsoid(
    side_px: int, axes: tuple[float, float, float] = (1, 1, 1), radius: float = 0.8
) -> tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]:
    """Return mask `(side, side)`, normals and positions `(side, side, 3)` of an ellipsoid."""
    places = ((np.arange(side_px) + 0.5) / side_px * 2 - 1) / radius
    x, y = np.meshgrid(places, -places)
    a, b, c = axes
    squared = 1 - (x / a) ** 2 - (y / b) ** 2
    z = c * np.sqrt(np.maximum(squared, 0))
    normals = np.stack([x / a**2, y / b**2, z / c**2], axis=-1)
    normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)
    return squared > 0, normals, np.stack([x, y, z], axis=-1)


def lit(
    normals: NDArray[np.float64],
    lights: Sequence[Light],
    ambient: float = 0.0,
    positions: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """Return the luminance of a matt surface of albedo 1; positions matter to near lights."""
    total = np.full(normals.shape[:-1], ambient)
    for light in lights:
        if light.distance is None:
            total += light.intensity * np.maximum(normals @ light.direction, 0)
            continue
        assert positions is not None
        towards = light.direction * light.distance - positions
        distance = np.linalg.norm(towards, axis=-1)
        cosine = np.maximum(np.einsum("ijk,ijk->ij", normals, towards), 0) / distance
        total += light.intensity * cosine * light.distance**2 / distance**2
    return total


def grey(luminance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a grey image."""
    return np.repeat(luminance[..., None], 3, axis=2)
