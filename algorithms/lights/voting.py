"""Contour voting: fuzzy circular clusters of the outline's normals, then elevations inside.

Lopez-Moreno 2011, sec. 3.6.1 and algorithm 1. A normal votes for every light that it may be lit
by, in proportion to the luminance that each would account for; a light's azimuth is the direction
of the sum of its voters' normals, as unit vectors (raw angles, as printed, cannot be averaged
across 0 and 360 degrees).
"""

from typing import Final

import numpy as np

from algorithms.lights.contour import Contour
from algorithms.lights.fitting import MOST_LIGHTS, WEAKEST, gain, least_gain
from algorithms.lights.shading import Array, Shading, Sources, predict, refine
from algorithms.lights.starts import raised

_ROUNDS: Final = 100
_SETTLED_DEG: Final = 0.01
_ALBEDO_LIMITS: Final = (0.5, 2.0)
_DARK: Final = 0.2


def vote_lights(contour: Contour, shading: Shading) -> Sources:
    """Find the lights, their number included.

    Parameters
    ----------
    contour
        The object's outline.
    shading
        Its outline and interior.

    Returns
    -------
    1 to 4 directional lights: as many as each lower the loss by `fitting.least_gain`.
    """
    azimuth, luminance = np.radians(contour.azimuth_deg), contour.luminance / shading.unit
    found = _grown(shading, azimuth, luminance)
    return _grown(shading, azimuth, luminance / _albedo(shading, luminance, found))


def _grown(shading: Shading, azimuth: Array, luminance: Array) -> Sources:
    """Vote for one light, two, and so on; stop where one is weak or explains too little."""
    found = Sources.directional(np.zeros((0, 3)))
    needed = 0.0
    for count in range(1, MOST_LIGHTS + 1):
        start = raised(shading, np.degrees(_voted(azimuth, luminance, count)))
        better, _ = refine(shading, start, turning=False)
        weakest = better.intensities.min() / max(float(better.intensities.max()), 1e-12)
        if count == 1:
            needed = least_gain(better)
        elif weakest < WEAKEST or gain(shading, found, better) < needed:
            break
        found = better
    return found


def _voted(azimuth: Array, luminance: Array, count: int) -> Array:
    """Return the azimuths that a given number of lights settle at."""
    normals = np.exp(1j * azimuth)
    # What comes from everywhere votes for nobody.
    votes = luminance - luminance.min()
    seed = azimuth[np.argmax(votes)]
    lights = np.exp(1j * (seed + 2 * np.pi * np.arange(count) / count))
    for _ in range(_ROUNDS):
        facing = np.maximum((normals[:, None] * lights.conj()).real, 0)
        total = np.maximum(facing.sum(axis=1, keepdims=True), 1e-12)
        sums = (votes[:, None] * facing / total * normals[:, None]).sum(axis=0)
        moved = np.where(np.abs(sums) > 1e-12, sums / np.maximum(np.abs(sums), 1e-12), lights)
        settled = np.abs(np.angle(moved / lights)).max() < np.radians(_SETTLED_DEG)
        lights = moved
        if settled:
            break
    return np.asarray(np.angle(lights))


def _albedo(shading: Shading, luminance: Array, found: Sources) -> Array:
    """Return by how much each normal's surface is lighter or darker than the lights explain.

    The second pass: where the outline is lit, albedo is what its luminance is over the predicted
    one, within a factor of two; in the dark nothing can be told.
    """
    predicted = predict(shading, found)[shading.inside :]
    known = predicted > _DARK * predicted.max()
    ratio = np.where(known, luminance / np.maximum(predicted, 1e-12), 1.0)
    return np.clip(ratio / max(float(np.median(ratio[known])), 1e-12), *_ALBEDO_LIMITS)
