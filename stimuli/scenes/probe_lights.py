"""The lights of chapter 3: the rigs of its tables, wide lights, and light from everywhere."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.light_linking.rigs import KEY_INTENSITY

_GOLDEN_ANGLE: Final = np.pi * (3 - np.sqrt(5))

TABLE_3_1: Final = {
    "apple1": ((-15.0, 40.0), (165.0, -40.0)),
    "apple2": ((90.0, -70.0),),
    "apple3": ((180.0, 0.0), (0.0, 0.0)),
    "guitar": ((180.0, 10.0), (30.0, -45.0), (260.0, 45.0)),
    "quilt": ((10.0, -35.0), (120.0, -10.0)),
}
"""Azimuth theta and zenith psi of each light, in degrees and chapter 3's frame: the rows R of
Lopez-Moreno 2011, table 3.1. `light_of_chapter_3` makes lights of them."""

TABLE_3_2: Final = ((90.0, 0.0), (180.0, 45.0), (315.0, -45.0))
"""Likewise, the lights of table 3.2 and fig. 3.9."""


def light_of_chapter_3(theta_deg: float, psi_deg: float, intensity: float = KEY_INTENSITY) -> Light:
    """Return a light given as chapter 3 does, in the project's frame.

    Parameters
    ----------
    theta_deg
        Azimuth in the image plane.
    psi_deg
        Zenith: out of the image plane, positive towards the viewer, -90..90.
    intensity
        As of `Light`.

    Notes
    -----
    Chapter 3 has its image plane in y and z, and x out of it (fig. 3.1). Seen by the viewer, that
    right-handed frame has y to the right and z up, so its axes x, y, z are the project's z, x, y,
    and both angles keep their numbers.
    """
    theta, psi = np.radians([theta_deg, psi_deg])
    x, y, z = np.sin(psi), np.cos(psi) * np.cos(theta), np.cos(psi) * np.sin(theta)
    exact = Light.from_direction((y, z, x))
    return Light(round(exact.azimuth_deg, 9) % 360, round(exact.elevation_deg, 9), intensity)


def disc(light: Light, radius_deg: float, count: int) -> tuple[Light, ...]:
    """Return many directional lights that stand for one round and evenly bright light.

    Parameters
    ----------
    light
        Its centre, without a distance; its intensity is the irradiance of the whole disc on a
        surface that faces the centre.
    radius_deg
        How far its rim stands from the centre, more than 0, at most 90.
    count
        How many, 1 or more.

    Returns
    -------
    Lights of equal intensity, evenly spread over the disc's solid angle: every k-th of them are
    spread about as evenly as so few can be.

    Raises
    ------
    InputError
        If an argument is out of range.
    """
    if not 0 < radius_deg <= 90:
        raise InputError(f"radius_deg: {radius_deg} given, more than 0 and at most 90 accepted")
    if light.distance is not None:
        raise InputError("light: one without a distance is accepted")
    cosines = 1 - _middles(count) * (1 - np.cos(np.radians(radius_deg)))
    axis = light.direction
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    side /= np.linalg.norm(side)
    frame = np.stack([side, np.cross(axis, side), axis])
    return tuple(_lights(cosines, frame, light.intensity / cosines.sum()))


def surroundings(irradiance: float, count: int) -> tuple[Light, ...]:
    """Return many directional lights that stand for evenly bright surroundings.

    Parameters
    ----------
    irradiance
        On a surface of which nothing is hidden from them.
    count
        How many, 1 or more; spread as those of `disc`.
    """
    # Over the sphere the mean of max(0, cosine) is a quarter.
    return tuple(_lights(1 - 2 * _middles(count), np.eye(3), 4 * irradiance / count))


def _middles(count: int) -> np.ndarray:
    if count < 1:
        raise InputError(f"count: {count} given, 1 or more accepted")
    return (np.arange(count) + 0.5) / count


def _lights(cosines: np.ndarray, frame: np.ndarray, intensity: float) -> Iterator[Light]:
    """Yield lights along a spiral around the frame's last axis (Vogel 1979)."""
    sines, turns = np.sqrt(1 - cosines**2), _GOLDEN_ANGLE * np.arange(len(cosines))
    local = np.stack([sines * np.cos(turns), sines * np.sin(turns), cosines], axis=-1)
    for direction in local @ frame:
        yield Light.from_direction(direction, intensity)
