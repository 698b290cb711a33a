"""Objects, camera and light as Mitsuba describes them, in the project's frame."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.light_linking.materials import Material
from stimuli.shapes.mesh import Mesh, Value, to_mitsuba

_ONE: Final = {"type": "rgb", "value": 1.0}
LIGHTS: Final[dict[str, Any]] = {
    "directional": {"light": {"type": "directional", "irradiance": _ONE}},
    "point": {"light": {"type": "point", "position": [0, 0, 0], "intensity": _ONE}},
}
"""The scene entries of lights that `set_light` sets."""


@dataclass(frozen=True)
class Placed:
    """One object of a scene.

    Attributes
    ----------
    mesh
        Around the origin, of radius 1 at most.
    material, albedo
        How it reflects, and its diffuse albedo over latitude and longitude, `(rows, columns)` or,
        where it has a colour, `(rows, columns, 3)`.
    centre
        Where it stands, `(x, y)` in object radii from the image's centre; y up.
    """

    mesh: Mesh
    material: Material
    albedo: NDArray[np.float64]
    centre: tuple[float, float]


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


def set_light(scene: Value, light: Light, centre: tuple[float, float]) -> None:
    """Make a light of a scene's entry of `LIGHTS`, for the object at that centre."""
    parameters = mi.traverse(scene)
    if light.distance is None:
        target = (-light.direction).tolist()
        # Any vector that is not parallel will do: a directional light has no roll.
        up = np.eye(3)[np.argmin(np.abs(light.direction))].tolist()
        parameters["light.to_world"] = mi.ScalarTransform4f().look_at([0, 0, 0], target, up)
        parameters["light.irradiance.value"] = [light.intensity] * 3
    else:
        place = np.array([*centre, 0.0]) + light.distance * light.direction
        parameters["light.position"] = place.tolist()
        parameters["light.intensity.value"] = [light.intensity * light.distance**2] * 3
    parameters.update()
