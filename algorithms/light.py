"""The project's one frame for directions, and the light that lives in it.

x points right, y up, z towards the viewer. Every conversion from or to another frame is here.
"""

import math
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError


@dataclass(frozen=True)
class Light:
    """A directional light, or a point light where a distance is given.

    Parameters
    ----------
    azimuth_deg
        Angle in the image plane, counter-clockwise from +x; any finite number.
    elevation_deg
        Angle out of the image plane towards the viewer, -90..90; negative means behind the object.
    intensity
        Irradiance on a surface facing the light, 0 or more, in the unit of the scene.
    distance
        From the object's centre in scene units, more than 0; None for a directional light.

    Raises
    ------
    InputError
        If a value is outside its range.

    Examples
    --------
    >>> Light(azimuth_deg=90, elevation_deg=0).direction.round(3).tolist()
    [0.0, 1.0, 0.0]
    """

    azimuth_deg: float
    elevation_deg: float
    intensity: float = 1.0
    distance: float | None = None

    def __post_init__(self) -> None:
        if not math.isfinite(self.azimuth_deg):
            raise InputError(f"azimuth_deg: a finite number is accepted, not {self.azimuth_deg}")
        if not -90 <= self.elevation_deg <= 90:
            raise InputError(f"elevation_deg: -90..90 is accepted, not {self.elevation_deg}")
        if not 0 <= self.intensity < math.inf:
            raise InputError(f"intensity: 0 or more is accepted, not {self.intensity}")
        if self.distance is not None and not 0 < self.distance < math.inf:
            raise InputError(f"distance: more than 0 or None is accepted, not {self.distance}")

    @property
    def direction(self) -> NDArray[np.float64]:
        """The unit vector `(3,)` from the object to the light."""
        azimuth, elevation = math.radians(self.azimuth_deg), math.radians(self.elevation_deg)
        return np.array(
            [
                math.cos(elevation) * math.cos(azimuth),
                math.cos(elevation) * math.sin(azimuth),
                math.sin(elevation),
            ]
        )

    @classmethod
    def from_direction(
        cls, direction: ArrayLike, intensity: float = 1.0, distance: float | None = None
    ) -> Self:
        """Make a light from the vector towards it.

        Parameters
        ----------
        direction
            Vector `(3,)` of any positive length, from the object to the light.
        intensity, distance
            As of the class.

        Returns
        -------
        The light, its azimuth in 0..360 (360 excluded).

        Raises
        ------
        InputError
            If the direction is not a finite vector other than zero.
        """
        vector = np.asarray(direction, dtype=np.float64)
        if vector.shape != (3,) or not np.isfinite(vector).all() or not vector.any():
            raise InputError("direction: a finite, non-zero vector of three numbers is accepted")
        x, y, z = vector / np.abs(vector).max()
        azimuth_deg = math.degrees(math.atan2(y, x)) % 360 % 360
        elevation_deg = math.degrees(math.atan2(z, math.hypot(x, y)))
        return cls(azimuth_deg, elevation_deg, intensity, distance)


def angle_between_deg(first: Light, second: Light) -> float:
    """Return the great-circle angle between two lights' directions, 0..180 degrees."""
    a, b = first.direction, second.direction
    return math.degrees(math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b)))


def plane_from_pixels(
    rows_px: ArrayLike, columns_px: ArrayLike, height_px: int, width_px: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Turn positions in an image into offsets from its centre, x right and y up.

    Parameters
    ----------
    rows_px, columns_px
        Positions from the top left corner of the image, in pixels; the centre of the first pixel
        is at 0.5. Any shape.
    height_px, width_px
        Size of the image.

    Returns
    -------
    x and y in pixels, of the same shape.
    """
    x: NDArray[Any] = np.asarray(columns_px, dtype=np.float64) - width_px / 2
    y: NDArray[Any] = height_px / 2 - np.asarray(rows_px, dtype=np.float64)
    return x, y
