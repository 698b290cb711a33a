"""Translucent media: the twelve that Jensen et al. measured, and what follows from a measurement.

Everything is per colour channel (R, G, B) and reduced: forward scattering is folded into the
coefficients, so that what is left scatters alike in all directions.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError

Channels = tuple[float, float, float]


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium that scatters more than it absorbs, or less.

    Attributes
    ----------
    name
        As users write it.
    scattering_per_mm
        Reduced scattering coefficient (sigma_s'), more than 0.
    absorption_per_mm
        Absorption coefficient (sigma_a), 0 or more.
    refractive_index
        Relative to the air around it (eta), 1 to 2.
    measured_reflectance
        Diffuse reflectance, 0..1, of the sample that was measured; None where none was.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    name: str
    scattering_per_mm: Channels
    absorption_per_mm: Channels
    refractive_index: float
    measured_reflectance: Channels | None = None

    def __post_init__(self) -> None:
        if not all(0 < value < np.inf for value in self.scattering_per_mm):
            raise InputError(
                f"scattering_per_mm: more than 0 accepted, not {self.scattering_per_mm}"
            )
        if not all(0 <= value < np.inf for value in self.absorption_per_mm):
            raise InputError(f"absorption_per_mm: 0 or more accepted, not {self.absorption_per_mm}")
        if not 1 <= self.refractive_index <= 2:
            raise InputError(f"refractive_index: 1 to 2 accepted, not {self.refractive_index}")

    @property
    def extinction_per_mm(self) -> NDArray[np.float64]:
        """Reduced extinction coefficient (sigma_t') `(3,)`."""
        return np.add(self.scattering_per_mm, self.absorption_per_mm)

    @property
    def albedo(self) -> NDArray[np.float64]:
        """Reduced albedo (alpha') `(3,)`: the share of extinction that is scattering."""
        return np.asarray(self.scattering_per_mm) / self.extinction_per_mm

    @property
    def transport_extinction_per_mm(self) -> NDArray[np.float64]:
        """Effective transport extinction (sigma_tr) `(3,)`: at which diffuse light dies away."""
        return np.sqrt(3 * np.asarray(self.absorption_per_mm) * self.extinction_per_mm)

    @property
    def mean_free_path_mm(self) -> NDArray[np.float64]:
        """How far light goes straight on (1 / sigma_t') `(3,)`."""
        return np.asarray(1 / self.extinction_per_mm)


def medium_named(name: str) -> Medium:
    """Return a medium of `MEASURED`.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name not in MEASURED:
        raise InputError(f"medium: {name!r} given, {', '.join(MEASURED)} accepted")
    return MEASURED[name]


_MEASUREMENTS: Final[dict[str, tuple[Channels, Channels, Channels, float]]] = {
    "apple": ((2.29, 2.39, 1.97), (0.0030, 0.0034, 0.046), (0.85, 0.84, 0.53), 1.3),
    "chicken1": ((0.15, 0.21, 0.38), (0.015, 0.077, 0.19), (0.31, 0.15, 0.10), 1.3),
    "chicken2": ((0.19, 0.25, 0.32), (0.018, 0.088, 0.20), (0.32, 0.16, 0.10), 1.3),
    "cream": ((7.38, 5.47, 3.15), (0.0002, 0.0028, 0.0163), (0.98, 0.90, 0.73), 1.3),
    "ketchup": ((0.18, 0.07, 0.03), (0.061, 0.97, 1.45), (0.16, 0.01, 0.00), 1.3),
    "marble": ((2.19, 2.62, 3.00), (0.0021, 0.0041, 0.0071), (0.83, 0.79, 0.75), 1.5),
    "potato": ((0.68, 0.70, 0.55), (0.0024, 0.0090, 0.12), (0.77, 0.62, 0.21), 1.3),
    "skimmilk": ((0.70, 1.22, 1.90), (0.0014, 0.0025, 0.0142), (0.81, 0.81, 0.69), 1.3),
    "skin1": ((0.74, 0.88, 1.01), (0.032, 0.17, 0.48), (0.44, 0.22, 0.13), 1.3),
    "skin2": ((1.09, 1.59, 1.79), (0.013, 0.070, 0.145), (0.63, 0.44, 0.34), 1.3),
    "spectralon": ((11.6, 20.4, 14.9), (0.00, 0.00, 0.00), (1.00, 1.00, 1.00), 1.3),
    "wholemilk": ((2.55, 3.21, 3.77), (0.0011, 0.0024, 0.014), (0.91, 0.88, 0.76), 1.3),
}

MEASURED: Final[dict[str, Medium]] = {
    name: Medium(name, scattering, absorption, index, reflectance)
    for name, (scattering, absorption, reflectance, index) in _MEASUREMENTS.items()
}
"""By name (Jensen, Marschner, Levoy and Hanrahan 2001, *A Practical Model for Subsurface Light
Transport*, fig. 5)."""
