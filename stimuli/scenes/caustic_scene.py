"""The scene of the caustics set: one object on a table, under one key light and a studio's sky.

One unit is the radius of an object's bounding sphere before it is scaled; y is up, the table's top
at y = 0, and the camera looks at the middle from +z and above.
"""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.camera import Perspective, light_in_frame
from stimuli.scenes.sky import map_directions
from stimuli.shapes.figures import bull, doll, dolphin, pebble, vertebra
from stimuli.shapes.lathe import lathe_from_silhouette
from stimuli.shapes.mesh import Mesh, Value, to_mitsuba
from stimuli.truth import ground_truth

FIGURES: Final[Mapping[str, tuple[Callable[[np.random.Generator], Mesh], float]]] = {
    "pebble": (pebble, 0.8),
    "vertebra": (vertebra, 0.95),
    "dolphin": (dolphin, 1.25),
    "bull": (bull, 1.1),
    "doll": (doll, 0.8),
}
"""What makes each object, and its radius in the scene, at which they look about equally large."""

REFRACTIVE_INDEX: Final = 1.5
LIGHT_ELEVATION_DEG: Final = 48.0
CAMERA_ELEVATION_DEG: Final = 28.0

_KEY_IRRADIANCE: Final = (4.0, 3.85, 3.6)
_ALBEDO: Final = 0.5
_TABLE_ALBEDO: Final = ((0.40, 0.37, 0.33), (0.10, 0.095, 0.09))  # in the middle, far away
_TABLE_FADE: Final = 3.0
_TABLE_HALF_WIDTH: Final = 20.0
_TABLE_PX: Final = 512
_GAP: Final = 2e-3  # glass that touched the table would let light in where there is no surface
_CAMERA_DISTANCE: Final = 8.0
_CAMERA_TARGET: Final = (0.0, 0.45, 0.1)  # in front of the object, for its shadow
_FIELD_OF_VIEW_DEG: Final = 28.0
_OUTLINE_PX: Final = 640
_SKY_ROWS: Final = 128
_HORIZON, _ZENITH, _SKY_EXPONENT = 0.08, 0.42, 0.6
_SKY_COLOUR: Final = (0.92, 0.98, 1.1)
_PANELS: Final = (  # azimuth and elevation in degrees, half width and height, radiance
    (-50.0, 40.0, 0.35, 0.25, 3.0),
    (120.0, 25.0, 0.12, 0.5, 2.0),
)
_PANEL_EDGE: Final = 0.02
_MAP_SIDE: Final = 1.5
_MAP_GAP: Final = 0.05

_GLASS: Final[Mapping[str, Any]] = {"type": "dielectric", "int_ior": REFRACTIVE_INDEX}
_MATT: Final[Mapping[str, Any]] = {
    "type": "diffuse",
    "reflectance": {"type": "rgb", "value": _ALBEDO},
}


def camera(width_px: int) -> Perspective:
    """Return the camera that the scene is composed for, 4:3."""
    target = np.array(_CAMERA_TARGET)
    position = target + _CAMERA_DISTANCE * _direction(0, CAMERA_ELEVATION_DEG)
    return Perspective(
        (float(position[0]), float(position[1]), float(position[2])),
        _CAMERA_TARGET,
        _FIELD_OF_VIEW_DEG,
        width_px,
        width_px * 3 // 4,
    )


def key_light(light_deg: float) -> Light:
    """Return the key light by the scene's axes; 0 degrees is above the camera, 90 to its right."""
    direction = _direction(light_deg, LIGHT_ELEVATION_DEG)
    return Light.from_direction(direction, float(np.mean(_KEY_IRRADIANCE)))


def key_in_frame(light_deg: float, view: Perspective) -> Light:
    """Return the key light in the project's frame of the camera."""
    return light_in_frame(key_light(light_deg), view)


def map_corners(light_deg: float) -> NDArray[np.float64]:
    """Return where on the table a map of caustics goes.

    Parameters
    ----------
    light_deg
        Of the key light.

    Returns
    -------
    `(4, 3)`: a square that begins under the object and lies on the side away from the light, from
    where the map's top left goes. What is above in the map, as in a picture of the object, lies
    farther away from the light. Clockwise as seen from above where the light is on the camera's
    side of the object; behind it, the other way round: there the light sees the mirror image of
    the outline that the camera sees, and that is the shadow's.
    """
    away = -_direction(light_deg, 0)
    right = np.cross(away, [0, 1, 0])
    near, far = _MAP_GAP * away, (_MAP_GAP + _MAP_SIDE) * away
    half = right * _MAP_SIDE / 2
    if np.cos(np.radians(light_deg)) < 0:
        half = -half
    return np.stack([far - half, far + half, near + half, near - half])


class CausticScene:
    """One object on the table.

    Parameters
    ----------
    name
        One of `FIGURES`.
    generator
        Varies its proportions a little.
    """

    def __init__(self, name: str, generator: np.random.Generator) -> None:
        self.name = name
        self._generator = generator

    @cached_property
    def _mesh(self) -> Mesh:
        figure, radius = FIGURES[self.name]
        return _standing(figure(self._generator).moved(np.zeros(3), radius))

    def opaque(self, light_deg: float | None = None) -> Value:
        """Return the scene with a matt object, under the key light, or under the sky (None)."""
        return _scene(self.name, self._mesh, _MATT, light_deg)

    def transparent(self, light_deg: float | None = None) -> Value:
        """Return the scene with an object of glass, under the key light, or the sky (None)."""
        return _scene(self.name, self._mesh, _GLASS, light_deg)

    def revolved(self, light_deg: float) -> Value:
        """Return the scene with the object's outline revolved, of glass, under the key light.

        The outline, as the camera sees it, is scaled as at the object's distance, and stands
        upright.
        """
        return _scene(self.name, self._revolved_mesh, _GLASS, light_deg)

    @cached_property
    def _revolved_mesh(self) -> Mesh:
        view = camera(_OUTLINE_PX)
        truth = ground_truth(self.opaque(None), view, {self.name: 1})
        px_per_unit = view.pixels_per_unit(float(view.depth(np.array(_CAMERA_TARGET))))
        return _standing(
            lathe_from_silhouette(truth.regions > 0).moved(np.zeros(3), 1 / px_per_unit)
        )


def _standing(mesh: Mesh) -> Mesh:
    return mesh.moved(np.array([0.0, _GAP - mesh.vertices[:, 1].min(), 0.0]))


def _scene(name: str, mesh: Mesh, bsdf: Mapping[str, Any], light_deg: float | None) -> Value:
    light = _sky() if light_deg is None else _key(light_deg)
    shapes = {name: to_mitsuba(mesh, dict(bsdf), name), "table": _table()}
    return mi.load_dict({"type": "scene", **shapes, "light": light})


def _key(light_deg: float) -> dict[str, Any]:
    return {
        "type": "directional",
        "direction": (-key_light(light_deg).direction).tolist(),
        "irradiance": {"type": "rgb", "value": list(_KEY_IRRADIANCE)},
    }


def _table() -> dict[str, Any]:
    """Return a large table that darkens away from the middle: glass shows where it bends light."""
    transform: Any = mi.ScalarTransform4f
    place = np.linspace(-1, 1, _TABLE_PX) * _TABLE_HALF_WIDTH
    near = np.exp(-((np.hypot(*np.meshgrid(place, place)) / _TABLE_FADE) ** 2))[..., None]
    middle, far = (np.array(albedo) for albedo in _TABLE_ALBEDO)
    bitmap = mi.Bitmap((far + (middle - far) * near).astype(np.float32))
    return {
        "type": "rectangle",
        "to_world": transform().rotate([1, 0, 0], -90).scale(_TABLE_HALF_WIDTH),
        "bsdf": {
            "type": "diffuse",
            "reflectance": {"type": "bitmap", "bitmap": bitmap, "raw": True},
        },
    }


def _sky() -> dict[str, Any]:
    """Return a studio's light: a gradient from horizon to zenith, and two soft panels."""
    directions = map_directions(_SKY_ROWS)
    height = np.clip(directions[..., 1], 0, 1)
    grey = _HORIZON + (_ZENITH - _HORIZON) * height**_SKY_EXPONENT
    radiance = grey[..., None] * np.array(_SKY_COLOUR)
    for azimuth_deg, elevation_deg, half_width, half_height, panel in _PANELS:
        ahead = _direction(azimuth_deg, elevation_deg)
        right = np.cross([0, 1, 0], ahead) / np.cos(np.radians(elevation_deg))
        cosine = directions @ ahead
        across, along = (
            np.abs(directions @ axis) / np.maximum(cosine, 1e-9)
            for axis in (right, np.cross(ahead, right))
        )
        inside = _soft_step(half_width - across) * _soft_step(half_height - along)
        radiance += (panel * inside * (cosine > 0))[..., None]
    return {"type": "envmap", "bitmap": mi.Bitmap(radiance.astype(np.float32))}


def _soft_step(distance: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.clip(0.5 + distance / _PANEL_EDGE / 2, 0, 1)


def _direction(azimuth_deg: float, elevation_deg: float) -> NDArray[np.float64]:
    """Return a unit vector of the scene; azimuth 0 is +z, towards the camera, 90 is +x."""
    azimuth, elevation = np.radians([azimuth_deg, elevation_deg])
    return np.array(
        [
            np.sin(azimuth) * np.cos(elevation),
            np.sin(elevation),
            np.cos(azimuth) * np.cos(elevation),
        ]
    )
