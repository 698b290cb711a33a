"""The elevation of a light whose azimuth is known, from scanlines that run along it.

Lopez-Moreno 2011, sec. 3.7. From the outline that faces the light, one marches inwards. In front of
the object the luminance rises up to the point whose normal is the light's direction; behind it, it
falls to the point whose normal is perpendicular to it. What is missing is how the surface turns on
the way: like a circle over the whole scanline, or like an arc fitted to the shading (eq. 3.20).
"""

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.lights.probe import Probe

Array = NDArray[np.float64]
Turn = Literal["ellipse", "arc"]

_SMOOTHING_IN_RADII: Final = 0.03
_FEWEST_SAMPLES: Final = 8
_FACING: Final = 0.5  # of the light, along the outline where a scanline begins
_FLAT: Final = 0.98
_RISE: Final = 0.005  # in one pixel, of all that the luminance varies; less is noise
_REACHED: Final = 0.03


@dataclass(frozen=True)
class Elevation:
    """What the scanlines say of one light.

    Attributes
    ----------
    elevation_deg
        -90..90; negative behind the object. Not a number where no scanline tells.
    shadow
        The mean luminance at the edges of shadows that were met; not a number if none was.
    scanlines
        How many told something.
    """

    elevation_deg: float
    shadow: float
    scanlines: int


def scan_elevation(probe: Probe, azimuth_deg: float, turn: Turn = "ellipse") -> Elevation:
    """Estimate a light's elevation.

    Parameters
    ----------
    probe
        The object.
    azimuth_deg
        The light's, counter-clockwise from the right.
    turn
        How normals are guessed: `ellipse`, half a circle over each scanline, or `arc`, which falls
        back to it where eq. 3.20 has no solution, and behind the object, where it has none ever.

    Returns
    -------
    The mean over the scanlines: weighted by luminance where it rises from the outline (eq. 3.21 as
    a mean), by length where it falls, as luminance vanishes at a shadow's edge. The side that more
    scanlines are on decides between front and back.
    """
    radius_px = float(np.sqrt(probe.mask.sum() / np.pi))
    front: list[tuple[float, float]] = []
    back: list[tuple[float, float, float]] = []
    for luminance in _scanlines(probe, azimuth_deg, radius_px):
        first = min(luminance.size // 2, max(2, round(0.06 * radius_px)))
        if luminance[first] >= luminance[0]:
            top = _first_turn(luminance)
            front.append((_normal_deg(luminance, top, turn), float(luminance[top])))
        else:
            low = _shadow_edge(luminance)
            normal_deg = _normal_deg(luminance, low, "ellipse")
            back.append((normal_deg - 90, float(luminance.size), float(luminance[low])))
    shadow = float(np.mean([darkest for *_, darkest in back])) if back else np.nan
    if not front and not back:
        return Elevation(np.nan, np.nan, 0)
    if len(front) >= len(back):
        angles, weights = np.array(front).T
    else:
        angles, weights, _ = np.array(back).T
    total = weights.sum() or 1.0
    return Elevation(float(angles @ weights / total), shadow, len(angles))


def osculating_radius(d0: Array | float, d1: Array | float, ratio: Array | float) -> Array:
    """Return the radius of the arc on which luminance falls by a ratio between two points.

    Parameters
    ----------
    d0
        How far from the outline the brightest point is, where the normal is the light's direction.
    d1
        How far the second point is; more than d0.
    ratio
        The second point's luminance over the first one's, 0..1.

    Returns
    -------
    The radius, in the unit of the distances; infinite where there is no such arc.

    Notes
    -----
    Lopez-Moreno 2011, eq. 3.20, solved again from eq. 3.19: printed, it has the wrong sign below
    the line and the root twice.

    Examples
    --------
    On a circle of radius 10 the normal at 1 from the outline leans by arccos(0.9) = 25.8 degrees,
    and 50 degrees further it is 7.5 away.

    >>> lean = np.radians(25.84193 + 50)
    >>> osculating_radius(1.0, 10 - 10 * np.cos(lean), np.cos(np.radians(50))).round(3).tolist()
    10.0
    """
    d0, d1, ratio = (np.asarray(value, dtype=np.float64) for value in (d0, d1, ratio))
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = (d0 + d1 - np.sqrt(2 * d0 * d1 * (1 + ratio))) / (1 - ratio)
    sound = (ratio < _FLAT) & (ratio >= 0) & (d1 > d0) & (d0 >= 0) & (radius > d0)
    return np.where(sound, radius, np.inf)


def _scanlines(probe: Probe, azimuth_deg: float, radius_px: float) -> list[Array]:
    """Return smoothed luminance along lines from the outline that faces the light inwards."""
    smooth = _smoothed(probe, _SMOOTHING_IN_RADII * radius_px)
    azimuth = np.radians(azimuth_deg)
    inwards = np.array([np.sin(azimuth), -np.cos(azimuth)])  # rows grow downwards
    across = np.array([inwards[1], -inwards[0]])
    centre = np.array(ndimage.center_of_mass(probe.mask))
    reach = int(np.ceil(np.hypot(*probe.mask.shape)))
    along = np.arange(-reach, reach + 1)
    lines = []
    for offset in np.arange(-_FACING * radius_px, _FACING * radius_px + 1, 2.0):
        places = (centre + offset * across)[:, None] + inwards[:, None] * along
        inside = ndimage.map_coordinates(probe.mask.astype(np.uint8), places, order=0) > 0
        starts = np.flatnonzero(np.diff(inside.astype(np.int8), prepend=0) == 1)
        if starts.size == 0:
            continue
        length = int(np.argmin(np.append(inside[starts[0] :], False)))  # a sentinel
        if length >= _FEWEST_SAMPLES:
            piece = places[:, starts[0] : starts[0] + length]
            lines.append(ndimage.map_coordinates(smooth, piece, order=1))
    return lines


def _smoothed(probe: Probe, sigma_px: float) -> Array:
    """Smooth luminance inside the object, from which nothing outside is mixed in."""
    weights = ndimage.gaussian_filter(probe.usable.astype(np.float64), sigma_px)
    values = ndimage.gaussian_filter(np.where(probe.usable, probe.luminance, 0.0), sigma_px)
    return np.asarray(values / np.maximum(weights, 1e-9))


def _first_turn(luminance: Array) -> int:
    """Return where values first stop to rise."""
    falls = np.flatnonzero(np.diff(luminance) < 0)
    risen = falls[falls > 0]
    return int(risen[0]) if risen.size else luminance.size - 1


def _shadow_edge(luminance: Array) -> int:
    """Return where falling values have all but reached the first low."""
    rises = np.flatnonzero(np.diff(luminance) > _RISE * np.ptp(luminance))
    end = int(rises[0]) + 1 if rises.size else luminance.size
    falling = luminance[:end]
    lowest = float(falling.min())
    reached = falling <= lowest + _REACHED * (float(falling[0]) - lowest)
    return int(np.argmax(reached))


def _normal_deg(luminance: Array, index: int, turn: Turn) -> float:
    """Return how far the normal at a sample leans from the image plane to the viewer."""
    radius = luminance.size / 2
    if turn == "arc":
        fitted = _arc(luminance, index)
        radius = fitted if np.isfinite(fitted) else radius
    return float(np.degrees(np.arccos(np.clip(1 - (index + 0.5) / radius, 0, 1))))


def _arc(luminance: Array, top: int) -> float:
    """Fit the arc between the brightest point and where the luminance falls most steeply."""
    if top + 2 >= luminance.size or luminance[top] <= 0:
        return np.inf
    end = top + 1 + _shadow_edge(luminance[top + 1 :])
    steepest = top + 1 + int(np.argmin(np.diff(luminance[top : end + 1])))
    ratio = max(float(luminance[steepest] / luminance[top]), 0.0)
    return float(osculating_radius(top + 0.5, steepest + 0.5, ratio))
