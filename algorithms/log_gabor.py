"""A bank of log-Gabor filters in the frequency plane: which wavelengths, and which orientations.

Each filter is the product of a radial part, a Gaussian over the logarithm of the frequency, and an
angular part about its orientation. It passes one side of the frequency plane only, so that its
response is complex: the real part is that of an even-symmetric wavelet, the imaginary part that of
the odd-symmetric one.
"""

from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from algorithms.errors import InputError

Plane = NDArray[np.float32]
AngularShape = Literal["gaussian", "cosine"]

OVERLAP: Final = 1.2
"""Interval between orientations over the standard deviation of a Gaussian one: even coverage."""

_BROAD: Final = 3  # orientations: more are so narrow that nothing reaches the other side
_CUTOFF: Final = 0.4  # cycles a pixel
_SHARPNESS: Final = 10


@dataclass(frozen=True)
class LogGaborBank:
    """A filter for each of several scales and orientations.

    Attributes
    ----------
    scales
        How many, 1 or more.
    orientations
        How many, 1 or more, evenly spread over 180 degrees.
    first_deg
        The first orientation: along which the wavelets oscillate, counter-clockwise from +x.
    shortest_px
        Wavelength of the smallest scale, 2 or more.
    scaling
        Each wavelength over the one before, more than 1.
    bandwidth
        Standard deviation of the radial Gaussian over its centre, between 0 and 1: 0.75 passes
        about one octave, 0.55 about two.
    angular
        `gaussian` (Lopez-Moreno 2011, eq. 7.12), whose standard deviation is the interval between
        orientations over `OVERLAP`; or `cosine`, which falls to 0 at twice the interval and adds
        up to the same over all orientations (as Kovesi's programs have it).

    Raises
    ------
    InputError
        If a value is out of its range.
    """

    scales: int = 5
    orientations: int = 6
    first_deg: float = 0.0
    shortest_px: float = 3.0
    scaling: float = 2.1
    bandwidth: float = 0.55
    angular: AngularShape = "gaussian"

    def __post_init__(self) -> None:
        for name in ("scales", "orientations"):
            value: Any = getattr(self, name)
            if not isinstance(value, int | np.integer) or value < 1:
                raise InputError(f"{name}: a whole number of 1 or more is accepted")
        if not np.isfinite(self.first_deg):
            raise InputError("first_deg: a finite number is accepted")
        if not 2 <= self.shortest_px < np.inf:
            raise InputError("shortest_px: a finite number of 2 or more is accepted")
        if not 1 < self.scaling < np.inf:
            raise InputError("scaling: a finite number of more than 1 is accepted")
        if not 0 < self.bandwidth < 1:
            raise InputError("bandwidth: a number between 0 and 1 is accepted")
        if self.angular not in get_args(AngularShape):
            raise InputError(f"angular: one of {', '.join(get_args(AngularShape))} is accepted")

    @property
    def angles_deg(self) -> tuple[float, ...]:
        """The orientations."""
        interval = 180 / self.orientations
        return tuple(self.first_deg + number * interval for number in range(self.orientations))

    @property
    def wavelengths_px(self) -> tuple[float, ...]:
        """The wavelengths, from the shortest."""
        return tuple(self.shortest_px * self.scaling**number for number in range(self.scales))

    def radial(self, shape: tuple[int, int]) -> list[Plane]:
        """Return the radial part of each scale.

        Parameters
        ----------
        shape
            Height and width of the images to filter.

        Returns
        -------
        float32 `(height // 2 + 1, width // 2 + 1)` each: at the frequencies from 0 upwards of both
        axes; the others mirror them. 0 at frequency 0.

        Notes
        -----
        The corners of the plane, which only diagonal wavelets reach, are cut off by a Butterworth
        low-pass filter, as in Kovesi's programs.
        """
        rows, columns = (np.arange(extent // 2 + 1) / extent for extent in shape)
        radius = np.hypot(rows[:, None], columns).astype(np.float32)
        radius[0, 0] = 1
        low_pass = 1 / (1 + (radius / _CUTOFF) ** (2 * _SHARPNESS))
        low_pass[0, 0] = 0
        logarithm = np.log(radius)
        width = np.float32(2 * np.log(self.bandwidth) ** 2)
        return [
            low_pass * np.exp(-((logarithm + np.float32(np.log(wavelength))) ** 2) / width)
            for wavelength in self.wavelengths_px
        ]

    def angular_part(self, angle_deg: float, polar_angle: Plane) -> Plane:
        """Return the angular part about an orientation, at polar angles in radians, any shape.

        Of a Gaussian as broad as one or two orientations have, what reaches beyond a right angle is
        taken off on both sides: only a filter that passes one side has a response whose two parts
        are a pair, and the difference is what the odd one is made of anyway.
        """
        distance = _turn_between(polar_angle, angle_deg)
        if self.angular == "cosine":
            stretched = np.minimum(distance * np.float32(self.orientations / 2), np.float32(np.pi))
            return np.asarray((np.cos(stretched) + 1) / 2)
        deviation = np.pi / self.orientations / OVERLAP
        part = _gaussian(distance, deviation)
        if self.orientations <= _BROAD:
            part = np.maximum(part - _gaussian(np.float32(np.pi) - distance, deviation), 0)
        return part


def _turn_between(polar_angle: Plane, angle_deg: float) -> Plane:
    """Return the angle in radians between two directions, 0..pi."""
    within_turn = (angle_deg + 180) % 360 - 180
    distance = np.abs(polar_angle - np.float32(np.radians(within_turn)))
    return np.asarray(np.minimum(distance, np.float32(2 * np.pi) - distance))


def _gaussian(distance: Plane, deviation: float) -> Plane:
    return np.asarray(np.exp(distance * distance * np.float32(-0.5 / deviation**2)))


def polar_angles(shape: tuple[int, int], rows: slice) -> Plane:
    """Return the polar angle of some rows of the frequency plane, as scipy's FFT orders it.

    Parameters
    ----------
    shape
        Height and width of the plane.
    rows
        Which rows.

    Returns
    -------
    float32 `(len(rows), width)` in -pi..pi, counter-clockwise from +x; y is up.
    """
    vertical, horizontal = (fft.fftfreq(extent).astype(np.float32) for extent in shape)
    return np.arctan2(-vertical[rows, None], horizontal)
