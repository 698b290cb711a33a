"""A layer of homogeneous fog over a scene: as Mitsuba's medium, and what is known of it exactly.

The layer fills all space below a height. Its boundary is index-matched, so that light crosses it
unbent, and the camera stands inside. Radiance along a way of length d through fog of extinction
sigma_t is attenuated by exp(-sigma_t d); in fog that is lit the same everywhere, a dark object's
radiance grows as 1 - exp(-sigma_t d) of the airlight with its distance (Koschmieder 1924).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import plane_from_pixels
from stimuli.camera import Perspective
from stimuli.shapes.mesh import Value

VISIBLE_CONTRAST: Final = 0.02
"""The contrast at which a dark object against the horizon counts as just visible (Koschmieder)."""


@dataclass(frozen=True)
class FogLayer:
    """Homogeneous fog below a height.

    Attributes
    ----------
    extinction
        sigma_t, in the inverse of the scene's unit of length, more than 0.
    albedo
        The share of the extinction that is scattering, 0..1.
    asymmetry
        g of the Henyey-Greenstein phase function, between -1 and 1: the mean cosine of the angle
        of scattering; 0 is isotropic.
    top
        The height, y, up to which it reaches.
    reach
        How far it extends in x and z from the origin, and below y = 0.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    extinction: float
    albedo: float
    asymmetry: float
    top: float
    reach: float

    def __post_init__(self) -> None:
        accepted = {
            "extinction": (0 < self.extinction < math.inf, "more than 0"),
            "albedo": (0 <= self.albedo <= 1, "0..1"),
            "asymmetry": (-1 < self.asymmetry < 1, "more than -1 and less than 1"),
            "top": (math.isfinite(self.top), "a finite height"),
            "reach": (0 < self.reach < math.inf, "more than 0"),
        }
        for name, (valid, words) in accepted.items():
            if not valid:
                raise InputError(f"{name}: {getattr(self, name)} given, {words} accepted")

    @property
    def visibility(self) -> float:
        """The distance at which contrast has fallen to `VISIBLE_CONTRAST`: about 3.9 / sigma_t."""
        return -math.log(VISIBLE_CONTRAST) / self.extinction

    def immerse(self, scene: Mapping[str, Any], sensor: Value) -> dict[str, Any]:
        """Return a scene with the fog in it, and put the camera inside.

        Parameters
        ----------
        scene
            As `mi.load_dict` takes it; nothing in it may be higher than `top`, if the fog is to be
            around all of it.
        sensor
            Mitsuba's sensor, below `top`; it remembers the medium that it stands in.

        Returns
        -------
        The description of the scene with a shape `fog_layer`; render it by `volpath`.
        """
        medium = mi.load_dict(
            {
                "type": "homogeneous",
                "sigma_t": self.extinction,
                "albedo": self.albedo,
                "phase": {"type": "hg", "g": self.asymmetry},
            }
        )
        sensor.set_medium(medium)
        middle, half = (self.top - self.reach) / 2, (self.top + self.reach) / 2
        transform = mi.ScalarTransform4f().translate([0, middle, 0])
        transform = transform.scale([self.reach, half, self.reach])
        layer = {
            "type": "cube",
            "to_world": transform,
            "bsdf": {"type": "null"},
            "interior": medium,
        }
        return {**scene, "fog_layer": layer}

    def way(self, camera: Perspective, distance: NDArray[np.floating[Any]]) -> NDArray[np.float32]:
        """Return how long the way of light to a camera in the fog is, as far as it is in the fog.

        Parameters
        ----------
        camera
            Below `top`.
        distance
            From the camera to what is seen at each pixel's centre, `(height, width)`; infinite for
            the sky, whose light enters the fog where it comes through the layer's top.

        Returns
        -------
        float32 `(height, width)`, in units of the scene, `reach` at most.
        """
        rise = _pixel_directions(camera)[..., 1]
        height = self.top - camera.position[1]
        with np.errstate(divide="ignore"):
            to_top = np.where(rise > 0, height / rise, np.inf)
        shortest = np.minimum(np.minimum(distance, to_top), self.reach)
        return np.asarray(shortest, dtype=np.float32)


def _pixel_directions(camera: Perspective) -> NDArray[np.float64]:
    """Return the unit vectors in the scene from a camera through its pixels' centres."""
    size = camera.height_px, camera.width_px
    rows, columns = np.indices(size) + 0.5
    x, y = plane_from_pixels(rows, columns, *size)
    ahead = np.full_like(x, -camera.focal_length_px)
    directions = np.stack([x, y, ahead], axis=-1) @ camera.axes
    return np.asarray(directions / np.linalg.norm(directions, axis=-1, keepdims=True))
