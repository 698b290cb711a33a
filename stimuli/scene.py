"""Objects, camera and light as Mitsuba describes them, in the project's frame."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.materials import Material
from stimuli.mesh import Mesh, Value, to_mitsuba

CAMERA_DISTANCE: Final = 10.0
"""From the plane of the objects' centres to the camera's, in object radii."""

LIGHT: Final[dict[str, Any]] = {
    "light": {"type": "directional", "irradiance": {"type": "rgb", "value": 1.0}}
}
"""The scene entry of a light that `turn_light` turns."""


@dataclass(frozen=True)
class Placed:
    """One object of a scene.

    Attributes
    ----------
    mesh
        Around the origin, of radius 1 at most.
    material, albedo
        How it reflects, and its diffuse albedo over latitude and longitude `(rows, columns)`.
    centre
        Where it stands, `(x, y)` in object radii from the image's centre; y up.
    """

    mesh: Mesh
    material: Material
    albedo: NDArray[np.float64]
    centre: tuple[float, float]


@dataclass(frozen=True)
class View:
    """An orthographic camera that looks along -z: every object is seen from the same side.

    Attributes
    ----------
    width_px, height_px
        Size of the image.
    radius_px
        The length of an object's radius in the image.
    samples
        Samples a pixel on a regular grid, a square number.
    """

    width_px: int
    height_px: int
    radius_px: float
    samples: int

    def box_px(self, centre: tuple[float, float]) -> tuple[int, int, int, int]:
        """Return (left, top, right, bottom) of the pixels that an object can touch."""
        x = self.width_px / 2 + centre[0] * self.radius_px
        y = self.height_px / 2 - centre[1] * self.radius_px
        reach = self.radius_px + 1
        return (
            max(0, int(np.floor(x - reach))),
            max(0, int(np.floor(y - reach))),
            min(self.width_px, int(np.ceil(x + reach))),
            min(self.height_px, int(np.ceil(y + reach))),
        )


def scene_of(objects: Sequence[Placed], centres: Sequence[tuple[float, float]]) -> dict[str, Any]:
    """Return the scene of these objects, each at the centre given for it, without lights."""
    shapes = {
        f"object_{number}": _mesh(placed, centre, number)
        for number, (placed, centre) in enumerate(zip(objects, centres, strict=True))
    }
    return {"type": "scene", **shapes}


def _mesh(placed: Placed, centre: tuple[float, float], number: int) -> Value:
    mesh = placed.mesh.moved(np.array([*centre, 0.0]))
    shape = to_mitsuba(mesh, placed.material.plugin(placed.albedo), f"object_{number}")
    shape.add_attribute("face_number", 1, [float(number)] * len(mesh.faces))
    return shape


def turn_light(scene: Value, light: Light) -> None:
    """Turn a scene's `LIGHT` into another one."""
    parameters = mi.traverse(scene)
    target = (-light.direction).tolist()
    # Any vector that is not parallel will do: a directional light has no roll.
    up = np.eye(3)[np.argmin(np.abs(light.direction))].tolist()
    parameters["light.to_world"] = mi.ScalarTransform4f().look_at([0, 0, 0], target, up)
    parameters["light.irradiance.value"] = [light.intensity] * 3
    parameters.update()


def sensor_of(view: View, box_px: tuple[int, int, int, int] | None = None) -> Value:
    """Return the camera, or the part of it that sees a box (left, top, right, bottom)."""
    half_width = view.width_px / 2 / view.radius_px
    look = mi.ScalarTransform4f().look_at(
        origin=[0, 0, CAMERA_DISTANCE], target=[0, 0, 0], up=[0, 1, 0]
    )
    left, top, right, bottom = box_px or (0, 0, view.width_px, view.height_px)
    return mi.load_dict(
        {
            "type": "orthographic",
            "to_world": look @ mi.ScalarTransform4f().scale([half_width, half_width, 1]),
            "near_clip": 0.1,
            "far_clip": 2 * CAMERA_DISTANCE,
            "film": {
                "type": "hdrfilm",
                "width": view.width_px,
                "height": view.height_px,
                "crop_offset_x": left,
                "crop_offset_y": top,
                "crop_width": right - left,
                "crop_height": bottom - top,
                "pixel_format": "rgba",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            # A regular grid: every engine takes the same samples, and edges show no noise.
            "sampler": {"type": "stratified", "sample_count": view.samples, "jitter": False},
        }
    )
