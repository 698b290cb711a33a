"""The scene of the fog set: a lane between autumn trees that recedes from 2 to 400 metres.

Lopez-Moreno 2011, chapter 6 needs a high-dynamic-range outdoor picture with depth; what is in it is
ours. Metres, y up; the viewer stands near the origin and looks along -z.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.camera import Perspective, light_in_scene
from stimuli.scenes.landscape import LANE_WIDTH, Coloured, Landscape, lane_centre
from stimuli.scenes.sky import morning_sky
from stimuli.scenes.trees import grow_tree
from stimuli.scenes.village import (
    LAMP_HEIGHT,
    LAMP_RADIUS,
    church,
    fence,
    house,
    lamp_post,
    marker_post,
)
from stimuli.shapes.mesh import Mesh, Value, to_mitsuba
from stimuli.shapes.solids import merged

OBJECTS: Final[Mapping[int, str]] = {
    1: "trees",
    2: "lamps",
    3: "marker posts",
    4: "fence",
    5: "houses",
    6: "church",
}
"""The regions of the scene; the ground and the sky belong to none."""

SUN: Final = Light(azimuth_deg=142, elevation_deg=38, intensity=3.8)
"""In the frame of the camera: from the upper left behind the viewer."""

SUN_COLOUR: Final = (1.0, 0.86, 0.66)
"""The sun's irradiance in red, green and blue, relative to its intensity."""

LAMP_RADIANCE: Final = (190.0, 128.0, 60.0)
_WINDOW_RADIANCE: Final = (1.1, 0.7, 0.3)

_SAMPLING_WEIGHTS: Final = {"sun": 3.0, "sky": 1.0, "lamp": 0.12, "window": 0.03}
"""How often each light is chosen, about as it contributes: only the noise depends on it."""

_LEAF_COLOURS: Final = np.array(
    [(0.42, 0.20, 0.03), (0.50, 0.30, 0.05), (0.36, 0.12, 0.02), (0.22, 0.21, 0.05)]
)
_BARK: Final = (0.095, 0.075, 0.058)
_COLOURS: Final[Mapping[str, tuple[float, float, float]]] = {
    "plaster": (0.60, 0.53, 0.42),
    "limewash": (0.66, 0.63, 0.56),
    "ochre": (0.56, 0.40, 0.20),
    "tiles": (0.26, 0.085, 0.045),
    "slate": (0.075, 0.08, 0.09),
    "white": (0.75, 0.74, 0.70),
    "black": (0.025, 0.025, 0.025),
    "glass": (0.03, 0.035, 0.04),
    "iron": (0.035, 0.05, 0.042),
    "wood": (0.16, 0.125, 0.09),
}

_LAMP: Final = "lamp_"
_NEAR_TREES: Final = 50.0
_LAMPS_AHEAD: Final = (16.0, 33.0, 55.0, 86.0)
_POSTS_AHEAD: Final = tuple(7.2 + 7.5 * number + 0.35 * number**2 for number in range(18))
_HOUSES: Final = (
    # name, wall, ahead, beside the lane, turn in degrees, windows with light
    ("near_house", "plaster", 46.0, 14.5, -62.0, (0, 5)),
    ("middle_house", "ochre", 92.0, -16.0, 48.0, (1, 3)),
    ("far_house", "limewash", 165.0, 15.0, -35.0, (0, 2)),
)


def camera(width_px: int) -> Perspective:
    """Return the camera that the scene is composed for, 4:3."""
    return Perspective((0.4, 1.85, 0.0), (0.0, 2.75, -14.0), 52.0, width_px, width_px * 3 // 4)


def scene_of(
    view: Perspective, generator: np.random.Generator, detail: float = 1.0
) -> tuple[dict[str, Any], dict[str, int]]:
    """Return the scene without fog as `mi.load_dict` takes it, and the number of each object.

    Parameters
    ----------
    view
        In whose frame the sun is given.
    generator
        Draws ground, plants and clouds.
    detail
        1 for full images; less makes coarser meshes.
    """
    land = Landscape(generator, detail)
    shapes: dict[str, Value] = {}
    for name, part in {
        "ground": land.ground(),
        "woods": land.woods(),
        "grass": land.grass(),
        "fallen": land.fallen_leaves(_LEAF_COLOURS),
    }.items():
        shapes[name] = _coloured(part, name)
    numbers: dict[str, int] = {}
    for number, parts in {
        1: _trees(land, generator, detail),
        2: _lamps(land),
        3: _marker_posts(land),
        4: _fence(land),
        5: _houses(land),
        6: _church(land),
    }.items():
        shapes |= parts
        numbers |= dict.fromkeys(parts, number)
    return {"type": "scene", **shapes, **_lights(view, generator)}, numbers


def lamps_in_frame(view: Perspective, scene: Mapping[str, Any]) -> list[Light]:
    """Return the street lamps of a scene as lights in the camera's frame.

    Their intensity is the irradiance, mean of the colours, where they are seen from: the camera;
    their distance is that from the camera.
    """
    lamps = []
    for name, shape in scene.items():
        if name.startswith(_LAMP):
            offset = np.subtract(shape["center"], view.position)
            distance = float(np.linalg.norm(offset))
            irradiance = float(np.mean(LAMP_RADIANCE)) * np.pi * (LAMP_RADIUS / distance) ** 2
            lamps.append(Light.from_direction(view.axes @ offset, irradiance, distance))
    return lamps


def _lights(view: Perspective, generator: np.random.Generator) -> dict[str, Any]:
    sun = light_in_scene(SUN, view)
    irradiance = [SUN.intensity * share for share in SUN_COLOUR]
    return {
        "sun": {
            "type": "directional",
            "direction": (-sun.direction).tolist(),
            "irradiance": {"type": "rgb", "value": irradiance},
            "sampling_weight": _SAMPLING_WEIGHTS["sun"],
        },
        "sky": {
            "type": "envmap",
            "bitmap": mi.Bitmap(morning_sky(sun.direction, generator)),
            "sampling_weight": _SAMPLING_WEIGHTS["sky"],
        },
    }


def _diffuse(colour: Sequence[float]) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(colour)}}


def _painted(mesh: Mesh, colour: str, name: str, **parts: Value) -> dict[str, Value]:
    bsdf = {"type": "twosided", "side": _diffuse(_COLOURS[colour])}
    return {name: to_mitsuba(mesh, bsdf, name, **parts)}


def _coloured(part: Coloured, name: str) -> Value:
    """Return a mesh with an albedo at each vertex, seen from both sides."""
    reflectance = {"type": "mesh_attribute", "name": "vertex_albedo"}
    bsdf = {"type": "twosided", "side": {"type": "diffuse", "reflectance": reflectance}}
    shape = to_mitsuba(part.mesh, bsdf, name)
    shape.add_attribute("vertex_albedo", 3, part.albedo.astype(np.float32).ravel())
    return shape


def _beside(land: Landscape, ahead: float, beside: float) -> NDArray[np.float64]:
    """Return the place on the ground that far ahead and to the right of the lane's middle."""
    x = float(lane_centre(np.array(ahead))) + beside
    return np.array([x, float(land.height(np.array(x), np.array(ahead))), -ahead])


def _turned(mesh: Mesh, degrees: float) -> Mesh:
    angle = np.radians(degrees)
    cosine, sine = np.cos(angle), np.sin(angle)
    return mesh.rotated(np.array([(cosine, 0, sine), (0, 1, 0), (-sine, 0, cosine)]))


def _trees(land: Landscape, generator: np.random.Generator, detail: float) -> dict[str, Value]:
    """Return an avenue on both sides, and a few trees in the meadows."""
    levels = 6 if detail > 0.5 else 5
    near = [grow_tree(generator, levels, 26, 0.0125) for _ in range(4)]
    far = [grow_tree(generator, levels, 9, 0.021) for _ in range(4)]
    wood, leaves = [], []
    for ahead, beside in _tree_places(generator):
        kinds = near if ahead < _NEAR_TREES else far
        tree = kinds[int(generator.integers(len(kinds)))]
        height, turn = generator.uniform(8.3, 10.6), generator.uniform(0, 360)
        foot = _beside(land, ahead, beside)
        wood.append(_turned(tree.wood, turn).moved(foot, height))
        leaves.append(_turned(tree.leaves, turn).moved(foot, height))
    foliage = merged(leaves)
    return {
        "wood": to_mitsuba(merged(wood), _diffuse(_BARK), "wood"),
        "leaves": _coloured(Coloured(foliage, _leaf_albedo(foliage)), "leaves"),
    }


def _tree_places(generator: np.random.Generator) -> list[tuple[float, float]]:
    avenue = [
        (start + 12.5 * number + generator.uniform(-1.2, 1.2), side * generator.uniform(6.2, 7.0))
        for side, start in ((-1, 11.0), (1, 19.0))
        for number in range(17)
    ]
    meadow = [
        (generator.uniform(70, 330), side * generator.uniform(26, 110))
        for side in (-1, 1)
        for _ in range(11)
    ]
    return avenue + meadow


def _leaf_albedo(foliage: Mesh) -> NDArray[np.float64]:
    coordinates = foliage.texture_coordinates
    assert coordinates is not None
    places = coordinates[:, 0] * (len(_LEAF_COLOURS) - 1)
    index = np.minimum(places.astype(int), len(_LEAF_COLOURS) - 2)
    share = (places - index)[:, None]
    return np.asarray(_LEAF_COLOURS[index] * (1 - share) + _LEAF_COLOURS[index + 1] * share)


def _lamps(land: Landscape) -> dict[str, Value]:
    feet = [_beside(land, ahead, LANE_WIDTH / 2 + 0.9) for ahead in _LAMPS_AHEAD]
    posts = merged([lamp_post().moved(foot) for foot in feet])
    shapes: dict[str, Value] = _painted(posts, "iron", "posts_of_lamps")
    for number, foot in enumerate(feet):
        shapes[f"{_LAMP}{number}"] = {
            "type": "sphere",
            "center": (foot + np.array([0, LAMP_HEIGHT, 0])).tolist(),
            "radius": LAMP_RADIUS,
            "bsdf": _diffuse(_COLOURS["black"]),
            "emitter": _area_light(LAMP_RADIANCE, "lamp"),
        }
    return shapes


def _area_light(radiance: Sequence[float], kind: str) -> dict[str, Any]:
    return {
        "type": "area",
        "radiance": {"type": "rgb", "value": list(radiance)},
        "sampling_weight": _SAMPLING_WEIGHTS[kind],
    }


def _marker_posts(land: Landscape) -> dict[str, Value]:
    feet = [
        _beside(land, ahead, side * (LANE_WIDTH / 2 + 0.35))
        for ahead in _POSTS_AHEAD
        for side in (-1, 1)
    ]
    white, black = (merged([part.moved(foot) for foot in feet]) for part in marker_post())
    return _painted(white, "white", "posts_white") | _painted(black, "black", "posts_black")


def _fence(land: Landscape) -> dict[str, Value]:
    feet = np.array([_beside(land, ahead, -9.5) for ahead in np.arange(7.0, 120.0, 2.6)])
    return _painted(fence(feet), "wood", "fence")


def _houses(land: Landscape) -> dict[str, Value]:
    shapes: dict[str, Value] = {}
    for name, wall, ahead, beside, turn, lit in _HOUSES:
        parts = house(lit_windows=lit)
        place = _beside(land, ahead, beside)
        for part, colour in (
            ("walls", wall),
            ("roof", "tiles"),
            ("frames", "white"),
            ("panes", "glass"),
        ):
            mesh = _turned(getattr(parts, part), turn).moved(place)
            shapes |= _painted(mesh, colour, f"{name}_{part}")
        windows = _turned(parts.lit, turn).moved(place)
        light = _area_light(_WINDOW_RADIANCE, "window")
        shapes |= _painted(windows, "black", f"{name}_lit", emitter=light)
    return shapes


def _church(land: Landscape) -> dict[str, Value]:
    walls, roof = (_turned(part, 8).moved(_beside(land, 255.0, 9.0)) for part in church())
    return _painted(walls, "limewash", "church_walls") | _painted(roof, "slate", "church_roof")
