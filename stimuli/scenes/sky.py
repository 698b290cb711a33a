"""A morning sky with clouds, as a map of radiance over all directions."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.noise import PerlinNoise

_ZENITH: Final = (0.13, 0.24, 0.50)
_HORIZON: Final = (0.62, 0.68, 0.74)
_GROUND: Final = (0.10, 0.09, 0.07)
_CLOUD: Final = (0.95, 0.90, 0.84)
_GLOW: Final = (1.6, 1.15, 0.7)
_GLOW_SHARPNESS: Final = 30.0


def map_directions(rows: int) -> NDArray[np.float64]:
    """Return the directions of an environment map's pixels, `(rows, 2 * rows, 3)`.

    As Mitsuba's `envmap` has them: the first row is up (+y), the middle column is -z... +x on the
    left of it.
    """
    polar = np.pi * (np.arange(rows) + 0.5)[:, None] / rows
    turn = 2 * np.pi * (np.arange(2 * rows) + 0.5)[None, :] / (2 * rows)
    x, z = np.sin(turn) * np.sin(polar), -np.cos(turn) * np.sin(polar)
    return np.stack([x, np.broadcast_to(np.cos(polar), x.shape), z], axis=-1)


def morning_sky(
    sun_direction: NDArray[np.floating[Any]], generator: np.random.Generator, rows: int = 512
) -> NDArray[np.float32]:
    """Return the sky's radiance without the sun's disk, float32 `(rows, 2 * rows, 3)`.

    Parameters
    ----------
    sun_direction
        Unit vector `(3,)` towards the sun, around which the sky is brighter.
    generator
        Draws the clouds.
    rows
        Of the map.
    """
    direction = map_directions(rows)
    up = direction[..., 1]
    share = np.clip(up, 0, 1)[..., None] ** 0.45
    sky = np.array(_HORIZON) * (1 - share) + np.array(_ZENITH) * share
    towards = np.exp(_GLOW_SHARPNESS * (direction @ np.asarray(sun_direction) - 1))
    sky = sky + np.array(_GLOW) * towards[..., None]
    # Clouds lie on a plane overhead, so that they crowd towards the horizon.
    plane = direction / np.maximum(up, 0.04)[..., None] * np.array([1.0, 0.0, 0.55])
    noise = PerlinNoise(generator).fractal(plane * 0.85 + 11.3, 5, 0.55)
    cover = np.clip(noise * 1.7 + 0.12, 0, 1) * np.clip(up / 0.16, 0, 1) ** 1.5
    lit = np.array(_CLOUD) * (0.72 + 0.28 * np.clip(1 - noise, 0, 1))[..., None]
    sky = sky + (lit - sky) * 0.85 * cover[..., None]
    return np.where(up[..., None] > 0, sky, np.array(_GROUND)).astype(np.float32)
