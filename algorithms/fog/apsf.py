"""The atmospheric point-spread function: how fog spreads the light of a small source.

Narasimhan and Nayar 2003, *Shedding light on the weather*, eq. 17: multiple scattering around an
isotropic source in a sphere of homogeneous fog, as a Legendre series. It depends on the optical
thickness T between source and viewer, and on how strongly the particles scatter forwards, q.
"""

from typing import Final

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError

Array = NDArray[np.float64]

LEAST_OPTICAL_THICKNESS: Final = 1.02
"""Below 1 the series diverges; close above it, it needs thousands of terms."""

_ACCURACY: Final = 1e-9


def apsf(
    angle_deg: ArrayLike, optical_thickness: float, forward_scattering: float = 0.75
) -> NDArray[np.float64]:
    """Return the radiance around a point source in fog, relative to that towards its centre.

    Parameters
    ----------
    angle_deg
        Between the direction looked at and the source, 0..180, any shape.
    optical_thickness
        T, extinction times distance, `LEAST_OPTICAL_THICKNESS` or more.
    forward_scattering
        q, 0..1 without 1: about 0.2 for air, 0.75 for haze, 0.85 for fog, 0.95 for rain.

    Returns
    -------
    float64, the shape of `angle_deg`: 1 at 0 degrees, falling, 0 at 180 degrees.

    Raises
    ------
    InputError
        If a value is outside its range.

    Examples
    --------
    >>> apsf([5, 20, 45, 90], 1.2).round(3).tolist()
    [0.965, 0.752, 0.478, 0.184]
    """
    angle = np.asarray(angle_deg, dtype=np.float64)
    if not ((angle >= 0) & (angle <= 180)).all():
        raise InputError("angle_deg: 0..180 is accepted")
    series = _series(optical_thickness, forward_scattering)
    values = legendre.legval(np.cos(np.radians(angle)), series)
    # Rounding leaves traces of either sign at 180 degrees.
    return np.asarray(np.maximum(values / series.sum(), 0))


def energy_within(
    angle_deg: float, optical_thickness: float, forward_scattering: float = 0.75
) -> float:
    """Return the share of the light that arrives from within an angle around the source, 0..1.

    Parameters
    ----------
    angle_deg
        0..180.
    optical_thickness, forward_scattering
        As of `apsf`.

    Raises
    ------
    InputError
        If a value is outside its range.
    """
    if not 0 <= angle_deg <= 180:
        raise InputError(f"angle_deg: 0..180 is accepted, not {angle_deg}")
    integral = legendre.legint(_series(optical_thickness, forward_scattering))
    ends = legendre.legval([1.0, np.cos(np.radians(angle_deg)), -1.0], integral)
    return float((ends[0] - ends[1]) / (ends[0] - ends[2]))


def apsf_kernel(
    shape: tuple[int, int],
    focal_length_px: float,
    optical_thickness: float,
    forward_scattering: float = 0.75,
    scale: float = 1.0,
) -> NDArray[np.float32]:
    """Return the function as a convolution kernel, its centre at the first pixel (periodic).

    Parameters
    ----------
    shape
        Height and width of the kernel, and of the plane that it is meant for.
    focal_length_px
        The camera's, more than 0: half the width over the tangent of half the angle of view.
    optical_thickness, forward_scattering
        As of `apsf`.
    scale
        By how much its angles are scaled, more than 0.

    Returns
    -------
    float32, sums to 1; `apsf` at the scaled angles from the optical axis.
    """
    rows, columns = (np.fft.fftfreq(extent, 1 / extent) for extent in shape)
    angle = np.degrees(np.arctan(np.hypot(rows[:, None], columns) / focal_length_px)) / scale
    knots = np.linspace(0, 180, 1441)
    values = np.interp(angle, knots, apsf(knots, optical_thickness, forward_scattering))
    return np.asarray(values / values.sum(), dtype=np.float32)


def _series(optical_thickness: float, forward_scattering: float) -> Array:
    """Return the coefficients of the Legendre polynomials, g_m + g_(m+1)."""
    if not LEAST_OPTICAL_THICKNESS <= optical_thickness < np.inf:
        raise InputError(
            f"optical_thickness: {LEAST_OPTICAL_THICKNESS} or more is accepted, not "
            f"{optical_thickness}; the series diverges at 1"
        )
    if not 0 <= forward_scattering < 1:
        raise InputError(f"forward_scattering: 0..1 without 1, not {forward_scattering}")
    terms = int(-np.log(_ACCURACY) / np.log(optical_thickness)) + 8
    m = np.arange(1, terms + 1)
    beta = (2 * m + 1) / m * (1 - forward_scattering ** (m - 1.0))
    # exp(-beta T - alpha log T) with alpha = m + 1; the common factor T^-2 keeps T large in range.
    g = np.exp(-beta * optical_thickness - (m - 1) * np.log(optical_thickness))
    return np.asarray(np.append(0, g) + np.append(g, 0))
