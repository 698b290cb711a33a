"""A body's surface as chapter 9 sees it: a front and a back, both in the pixels of one picture."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import CAMERA_DISTANCE, View
from stimuli.shapes.mesh import Value
from stimuli.translucency.irradiance import entering_irradiance

Image = NDArray[np.float32]


@dataclass(frozen=True)
class Side:
    """What meets the straight lines through the pixels' centres first, from one side.

    Attributes
    ----------
    position
        float64 `(height, width, 3)`: in the scene; 0 outside the body.
    normal
        float64 `(height, width, 3)`: unit vectors out of the body; 0 outside it.
    """

    position: NDArray[np.float64]
    normal: NDArray[np.float64]


@dataclass(frozen=True)
class TwoSides:
    """A body's front and back.

    Attributes
    ----------
    inside
        bool `(height, width)`: where the pixel's centre shows the body.
    front, back
        Its surface nearest to the viewer, and farthest from the viewer.
    """

    inside: NDArray[np.bool_]
    front: Side
    back: Side

    def relief(self, view: View) -> tuple[Image, Image]:
        """Return the relief of front and back.

        Both float32 `(height, width)`: in pixels, larger is nearer, 0 at the front's farthest
        point, NaN outside the body. The front less the back is the body's thickness.
        """
        depth = -self.front.position[..., 2]
        zero = depth[self.inside].max()
        front, back = (
            np.where(self.inside, (zero + side.position[..., 2]) * view.radius_px, np.nan)
            for side in (self.front, self.back)
        )
        return front.astype(np.float32), back.astype(np.float32)

    def irradiance(
        self, scene: Value, lights: Sequence[Light], refractive_index: float
    ) -> tuple[Image, Image]:
        """Return the irradiance that enters front and back (Lopez-Moreno 2011, eq. 9.2).

        Parameters
        ----------
        scene
            Mitsuba's scene of the body, which casts shadows on itself.
        lights, refractive_index
            See `entering_irradiance`.

        Returns
        -------
        Both float32 `(height, width)`, 0 outside the body.
        """
        return tuple(  # type: ignore[return-value]  # two sides, two maps
            self._on(side, scene, lights, refractive_index) for side in (self.front, self.back)
        )

    def _on(
        self, side: Side, scene: Value, lights: Sequence[Light], refractive_index: float
    ) -> Image:
        image = np.zeros(self.inside.shape, np.float32)
        places = side.position[self.inside], side.normal[self.inside]
        image[self.inside] = entering_irradiance(scene, *places, lights, refractive_index)
        return image


_SIGNS: Final = (1.0, -1.0)


def two_sides(scene: Value, view: View) -> TwoSides:
    """Look at a body through every pixel's centre from the viewer's side and from behind.

    Parameters
    ----------
    scene
        Mitsuba's scene of one body.
    view
        An orthographic camera, so that both looks meet along one line.

    Raises
    ------
    InputError
        If the body is nowhere to be seen.
    """
    rows, columns = np.mgrid[: view.height_px, : view.width_px] + 0.5
    x = (columns - view.width_px / 2) / view.radius_px
    y = (view.height_px / 2 - rows) / view.radius_px
    looks = [_look(scene, x, y, sign) for sign in _SIGNS]
    # A line along an edge may be met from one side only.
    inside = looks[0][0] & looks[1][0]
    if not inside.any():
        raise InputError("view: one that shows the body is accepted")
    front, back = (
        Side(*(np.where(inside[..., None], each, 0) for each in look[1:])) for look in looks
    )
    return TwoSides(inside, front, back)


def _look(
    scene: Value, x: NDArray[np.float64], y: NDArray[np.float64], sign: float
) -> tuple[NDArray[np.bool_], NDArray[np.float64], NDArray[np.float64]]:
    """Return what is hit, where and its normal, looking along z from +z (1) or -z (-1)."""
    start = mi.Point3f(
        *(mi.Float(each.ravel().astype(np.float32)) for each in (x, y)), sign * CAMERA_DISTANCE
    )
    hit = scene.ray_intersect(mi.Ray3f(start, mi.Vector3f(0, 0, -sign)))
    there = np.array(hit.is_valid()).reshape(x.shape)
    position, normal = (
        np.array(each, dtype=np.float64).T.reshape(*x.shape, 3) for each in (hit.p, hit.sh_frame.n)
    )
    return there, position, normal
