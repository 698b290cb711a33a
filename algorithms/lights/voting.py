"""Contour voting: fuzzy circular clusters of the outline's normals, then elevations inside.

Lopez-Moreno 2011, sec. 3.6.1 and algorithm 1. A normal votes for every light that it may be lit
by, in proportion to the luminance that each would account for; a light's azimuth is the direction
of the sum of its voters' normals, as unit vectors (raw angles, as printed, cannot be averaged
across 0 and 360 degrees). Lights are as strong as their votes, and ambient light gets votes too:
expectation maximisation of clamped cosines on the circle. Equally strong lights without ambient
light, as printed, share what one of them accounts for, and are drawn together.
"""

from typing import Final

import numpy as np

from algorithms.lights.contour import Contour
from algorithms.lights.fitting import are_strong, gain, grown
from algorithms.lights.shading import Array, Shading, Sources, predict, refine
from algorithms.lights.starts import raised

# Later rounds follow an object's shadows on itself: chosen on renders.
_ROUNDS: Final = 25
_STARTS: Final = 4
_AMBIENT_AT_FIRST: Final = 0.2
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
    1 to 4 directional lights: as many as `fitting.grown` accepts.
    """
    azimuth, luminance = np.radians(contour.azimuth_deg), contour.luminance / shading.unit

    def elected(luminance: Array, count: int) -> Sources | None:
        start = raised(shading, np.degrees(_voted(azimuth, luminance, count)))
        sources, _ = refine(shading, start, turning=False)
        return sources if are_strong(sources) else None

    found = grown(shading, lambda _, count: elected(luminance, count))
    # The number stays: an albedo may explain whatever light is missing.
    again = elected(luminance / _albedo(shading, luminance, found), len(found.vectors))
    return again if again and gain(shading, found, again) > 0 else found


def _voted(azimuth: Array, luminance: Array, count: int) -> Array:
    """Return the azimuths that a given number of lights settle at.

    They start evenly spread, the first one where it is brightest; then likewise, turned by parts of
    their distance. What explains the luminance best is returned.
    """
    normals = np.exp(1j * azimuth)[:, None, None]
    votes = luminance[:, None, None]
    turns = (np.arange(count) + np.arange(_STARTS)[:, None] / _STARTS) / count
    lights = np.exp(1j * (azimuth[np.argmax(luminance)] + 2 * np.pi * turns))
    mean = max(float(luminance.mean()), 1e-12)
    ambient = np.full((_STARTS, 1), _AMBIENT_AT_FIRST * mean)
    # The mean of a clamped cosine around the circle is 1 / pi.
    strength = np.full(lights.shape, (1 - _AMBIENT_AT_FIRST) * np.pi * mean / count)
    for _ in range(_ROUNDS):
        facing = np.maximum((normals * lights.conj()).real, 0)
        surplus = votes / _explained(facing, strength, ambient)
        # Votes beyond those expected, so that directions which no normal has count as expected.
        beyond = (surplus - 1) * strength * facing
        sums = (beyond * normals).sum(axis=0) + (facing**2).sum(axis=0) * strength * lights
        strength = strength + beyond.sum(axis=0) / np.maximum(facing.sum(axis=0), 1e-12)
        ambient = ambient * surplus.mean(axis=0)
        length = np.abs(sums)
        lights = np.where(length > 1e-12, sums / np.maximum(length, 1e-12), lights)
    explained = _explained(np.maximum((normals * lights.conj()).real, 0), strength, ambient)
    likelihood = (votes * np.log(explained) - explained).sum(axis=(0, 2))
    return np.asarray(np.angle(lights[np.argmax(likelihood)]))


def _explained(facing: Array, strength: Array, ambient: Array) -> Array:
    """Return the luminance at each normal, `(normals, starts, 1)`."""
    total = (facing * strength).sum(axis=2, keepdims=True) + ambient
    return np.asarray(np.maximum(total, 1e-12))


def _albedo(shading: Shading, luminance: Array, found: Sources) -> Array:
    """Return by how much each normal's surface is lighter or darker than the lights explain.

    The second pass: where the outline is lit, albedo is what its luminance is over the predicted
    one, within a factor of two; in the dark nothing can be told.
    """
    predicted = predict(shading, found)[shading.inside :]
    known = predicted > _DARK * predicted.max()
    ratio = np.where(known, luminance / np.maximum(predicted, 1e-12), 1.0)
    return np.clip(ratio / max(float(np.median(ratio[known])), 1e-12), *_ALBEDO_LIMITS)
