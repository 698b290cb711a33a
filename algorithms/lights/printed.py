"""Light-source fitting as printed, only for the figure that compares it with `fit_lights`.

Lopez-Moreno 2011, sec. 3.6.2 and 3.7. Along the outline lights are added one by one by pattern
search, the earlier ones unmoved, each so strong that the brightest luminance is met (eq. 3.5). Each
may be near (eq. 3.18) or split in two at its critical points. Scanlines then give the elevations,
by which intensities are multiplied (eq. 3.22). Where the print cannot be meant, eq. 3.15 and the
sign of eq. 3.20, what is meant is used.
"""

from dataclasses import replace
from typing import Any, Final, get_args

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from algorithms.light import Light
from algorithms.lights.contour import Contour, contour_of
from algorithms.lights.pattern_search import pattern_search
from algorithms.lights.probe import prepare_probe
from algorithms.lights.scanlines import Elevation, Turn, scan_elevation
from algorithms.lights.shape import interior_of
from algorithms.lights.trim import trimmed

Array = NDArray[np.float64]

MERGED_DEG: Final = 15.0
_MOST_LIGHTS: Final = 4
_LEAST_GAIN: Final = 0.2  # the printed "large enough amount" has no number
_EXPLAINED: Final = 1e-3
_STARTS_DEG: Final = 30.0
_STEPS_DEG: Final = 10.0
_NEIGHBOURHOOD_DEG: Final = 5.0
_GREATEST_DEG: Final = 85.0
_FAR: Final = 1e3  # in radii: no nearer than infinity to the eye
_NEAREST: Final = 1.05
_NEARER: Final = 0.1  # the first step, of 1 / distance


VARIANTS: Final = (
    "printed, arc, 1 + cos",
    "printed, ellipse, 1 + cos",
    "printed, ellipse, 1 / cos",
)
"""Normals inside guessed by arcs or ellipses (sec. 3.7.1, 3.7.2), and intensities multiplied by one
more than the elevation's cosine (eq. 3.22) or, as is physical, divided by this cosine."""


def printed_lights(image: NDArray[Any], mask: NDArray[Any]) -> dict[str, tuple[Light, ...]]:
    """Detect lights as the thesis prints it.

    Parameters
    ----------
    image, mask
        As for `detect_lights`.

    Returns
    -------
    The lights of each of `VARIANTS`, the strongest first.

    Raises
    ------
    InputError
        As `detect_lights` does.
    """
    probe = trimmed(prepare_probe(image, mask))
    found_on_contour = contour_lights(contour_of(probe, interior_of(probe)))
    azimuths_deg = [light.azimuth_deg for light in found_on_contour]
    scans: dict[Turn, list[Elevation]] = {
        turn: [scan_elevation(probe, azimuth, turn) for azimuth in azimuths_deg]
        for turn in get_args(Turn)
    }
    found = {}
    for variant in VARIANTS:
        lights = [
            _lifted(light, scan, physical="1 / cos" in variant)
            for light, scan in zip(
                found_on_contour, scans["arc" if "arc" in variant else "ellipse"], strict=True
            )
        ]
        found[variant] = tuple(sorted(_merged(lights), key=lambda light: -light.intensity))
    return found


def contour_lights(contour: Contour) -> list[Light]:
    """Return the lights in the image plane, with a distance in radii where they are near."""
    azimuth, luminance = np.radians(contour.azimuth_deg), contour.luminance
    lights = np.zeros((0, 3))
    error = float(np.mean(luminance**2))
    for _ in range(_MOST_LIGHTS):
        more = _split(azimuth, luminance, _added(azimuth, luminance, lights))
        lower = float(np.mean((luminance - _lit(azimuth, more)) ** 2))
        if len(lights) and lower > (1 - _LEAST_GAIN) * error:
            break
        lights, error = more, lower
        if len(lights) >= _MOST_LIGHTS or error < _EXPLAINED * float(np.mean(luminance**2)):
            break
    return [
        Light(np.degrees(direction) % 360, 0.0, intensity, distance if distance < _FAR else None)
        for direction, intensity, distance in lights.tolist()
        if intensity > 0
    ]


def near_cosine(turned: Array, distance: Array | float) -> Array:
    """Return the cosine of incidence of point lights around a circle (eq. 3.18), 0 or more.

    Parameters
    ----------
    turned
        Angles from the light's azimuth, in radians.
    distance
        From the circle's centre, in its radii, more than 1. No light falls off with it, as printed.
    """
    length = np.sqrt(1 + distance**2 - 2 * distance * np.cos(turned))
    return np.asarray(np.maximum((distance * np.cos(turned) - 1) / length, 0))


def _lit(azimuth: Array, lights: Array) -> Array:
    """Return the luminance of the outline under lights (eq. 3.1 and 3.18).

    A light is a row of azimuth, intensity and distance; that of a directional one is `_FAR`.
    """
    return np.asarray(near_cosine(azimuth[:, None] - lights[:, 0], lights[:, 2]) @ lights[:, 1])


def _added(azimuth: Array, luminance: Array, lights: Array) -> Array:
    """Add the light that lowers the weighted error most (eq. 3.3 to 3.8)."""
    before = _lit(azimuth, lights)
    weights = np.ones_like(azimuth)
    if len(lights):
        weights = (1 - np.cos(lights[:, 0] - azimuth[:, None])).mean(axis=1) / 2

    def light(direction: float, distance: float) -> Array:
        """Return one so strong that the brightest luminance on its side is met (3.5)."""
        facing = near_cosine(azimuth - direction, distance)
        near = facing > 0.05
        if not near.any():
            return np.array([[direction, 0.0, distance]])
        strongest = ((luminance[near].max() - before[near]) / facing[near]).min()
        return np.array([[direction, max(float(strongest), 0.0), distance]])

    def error(direction: float, distance: float) -> float:
        left = luminance - before - _lit(azimuth, light(direction, distance))
        return float(np.mean(weights * left**2))

    step = np.radians([_STEPS_DEG])
    directions = (
        pattern_search(lambda place: error(float(place[0]), _FAR), [start], step)
        for start in np.radians(np.arange(0, 360, _STARTS_DEG))
    )
    found, _ = min(directions, key=lambda fit: fit[1])
    direction = float(found[0])

    def distance_of(nearness: Array) -> float:
        return float(1 / np.clip(nearness[0], 1 / _FAR, 1 / _NEAREST))

    nearness, _ = pattern_search(
        lambda place: error(direction, distance_of(place)), [1 / _FAR], [_NEARER]
    )
    return np.concatenate([lights, light(direction, distance_of(nearness))])


def _split(azimuth: Array, luminance: Array, lights: Array) -> Array:
    """Replace the last light by two at its critical points, where that is better (3.9 to 3.16)."""
    *others, last = lights
    rest = luminance - _lit(azimuth, np.reshape(others, (-1, 3)))
    left = _critical(azimuth, rest, last, -1)
    right = _critical(azimuth, rest, last, 1)
    if left is None or right is None:
        return lights
    directions = np.array([right - np.pi / 2, left + np.pi / 2])
    facing = np.maximum(np.cos(azimuth[:, None] - directions), 0)
    start = np.concatenate([directions, nnls(facing, np.maximum(rest, 0))[0]])

    def lights_of(pair: Array) -> Array:
        return np.stack([pair[:2], np.maximum(pair[2:], 0), np.full(2, _FAR)], axis=-1)

    def error(pair: Array) -> float:
        return float(np.mean((rest - _lit(azimuth, lights_of(pair))) ** 2))

    reach = max(float(luminance.max()) / 10, 1e-9)
    pair, _ = pattern_search(error, start, [*np.radians([_STEPS_DEG] * 2), reach, reach])
    two = lights_of(pair)
    single_left, two_left = ((rest - _lit(azimuth, each)) ** 2 for each in (last[None], two))
    here = int(np.argmax(np.cos(azimuth - last[0])))
    gain = 1 - float(two_left.mean() / max(float(single_left.mean()), 1e-30))
    if two_left[here] > single_left[here] or gain < _LEAST_GAIN:
        return lights
    return np.concatenate([np.reshape(others, (-1, 3)), two])


def _critical(azimuth: Array, rest: Array, light: Array, side: int) -> float | None:
    """Return where, on one side of a light, too much luminance turns into too little."""
    over = rest - _lit(azimuth, light[None])
    turned = side * np.angle(np.exp(1j * (azimuth - light[0])))
    width = np.radians(_NEIGHBOURHOOD_DEG)
    for index in np.argsort(turned):
        if not 0 < turned[index] < np.pi / 2 or over[index] <= 0:
            continue
        near = np.abs(turned - turned[index]) <= width
        if over[near].sum() > over[index]:
            return float(light[0] + side * turned[index])
    return None


def _lifted(light: Light, scan: Elevation, *, physical: bool) -> Light:
    told = scan.elevation_deg if np.isfinite(scan.elevation_deg) else 0.0
    elevation_deg = float(np.clip(told, -90, 90))
    level = np.cos(np.radians(np.clip(elevation_deg, -_GREATEST_DEG, _GREATEST_DEG)))
    factor = 1 / level if physical else 1 + level
    return replace(light, elevation_deg=elevation_deg, intensity=float(light.intensity * factor))


def _merged(lights: list[Light]) -> list[Light]:
    """Merge lights that are less than 15 degrees apart in azimuth (sec. 3.7.4)."""
    kept: list[Light] = []
    for light in lights:
        for index, other in enumerate(kept):
            apart = abs((light.azimuth_deg - other.azimuth_deg + 180) % 360 - 180)
            if apart < MERGED_DEG:
                total = other.direction * other.intensity + light.direction * light.intensity
                kept[index] = Light.from_direction(total, float(np.linalg.norm(total)))
                break
        else:
            kept.append(replace(light))
    return kept
