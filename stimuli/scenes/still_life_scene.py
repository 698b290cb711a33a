"""The scene of the still-life set: a table before a wall, with simple and complex things on it.

Lopez-Moreno 2011, sec. 8.7 shows such a scene lit originally, from the front and from behind; what
stands in it is ours. One unit is ten centimetres; y is up, the table's top at y = 0, and the viewer
looks along -z.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from algorithms.noise import PerlinNoise
from stimuli.camera import Perspective, light_in_scene
from stimuli.shapes.displaced_spheres import AbstractShape, sphere_directions
from stimuli.shapes.figures import bull, twisted_ring
from stimuli.shapes.lathe import lathe
from stimuli.shapes.mesh import Mesh, Value, grid_mesh, to_mitsuba
from stimuli.shapes.solids import box
from stimuli.shapes.superquadric import superquadric
from stimuli.shapes.vessels import bowl, goblet, vase

OBJECTS: Final[Mapping[int, str]] = {
    1: "vase",
    2: "wine glass",
    3: "bowl",
    4: "orange",
    5: "apple",
    6: "lemon",
    7: "book",
    8: "bull",
    9: "ring",
    10: "cup",
    11: "glass ball",
    12: "plum",
}
"""The regions of the scene; table, cloth and wall belong to none."""

KEY_INTENSITY: Final = 3.0
KEY_COLOUR: Final = (1.0, 0.95, 0.87)
SKY_RADIANCE: Final = 0.16
_SKY_COLOUR: Final = (0.86, 0.95, 1.1)

LIGHTINGS: Final[Mapping[str, Light]] = {
    "original": Light(143, 33, KEY_INTENSITY),
    "front": Light(78, 66, KEY_INTENSITY),
    "back": Light(62, -24, KEY_INTENSITY),
    "left": Light(172, 14, KEY_INTENSITY),
    "right": Light(24, 26, KEY_INTENSITY),
    "above": Light(90, 8, KEY_INTENSITY),
}
"""The key light of each lighting, in the frame of the camera; those from behind pass above the
wall."""

_WALL_Z: Final = -3.4
_WALL_HEIGHT: Final = 3.9
_TABLE: Final = (11.0, 7.4)
_TEXTURE_PX: Final = 512


def camera(width_px: int) -> Perspective:
    """Return the camera that the scene is composed for, 4:3."""
    return Perspective((0.15, 2.9, 8.6), (0.0, 0.98, -0.3), 37.0, width_px, width_px * 3 // 4)


class StillLife:
    """The things on the table, made once for all lightings.

    Parameters
    ----------
    generator
        Varies shapes and textures; the same state gives the same things.

    Attributes
    ----------
    numbers
        The number of each object, by the id of its shape.
    """

    def __init__(self, generator: np.random.Generator) -> None:
        self._shapes = _things(generator) | _room(generator)
        self.numbers = {name: number for number, name in OBJECTS.items()}

    def under_key(self, view: Perspective, lighting: str) -> Value:
        """Return Mitsuba's scene under the key light alone.

        Parameters
        ----------
        view
            In whose frame the light is given.
        lighting
            One of `LIGHTINGS`.
        """
        key = key_in_scene(view, lighting)
        light = {
            "type": "directional",
            "direction": (-key.direction).tolist(),
            "irradiance": _rgb([key.intensity * share for share in KEY_COLOUR]),
        }
        return mi.load_dict({"type": "scene", **self._shapes, "key": light})

    def under_sky(self) -> Value:
        """Return Mitsuba's scene under the sky alone."""
        radiance = _rgb([SKY_RADIANCE * share for share in _SKY_COLOUR])
        sky = {"type": "constant", "radiance": radiance}
        return mi.load_dict({"type": "scene", **self._shapes, "sky": sky})


def key_in_scene(view: Perspective, lighting: str) -> Light:
    """Return the key light of a lighting by the scene's axes."""
    return light_in_scene(LIGHTINGS[lighting], view)


def _things(generator: np.random.Generator) -> dict[str, Value]:
    """Return the objects by name, each standing on the table."""
    orange, apple, plum = (AbstractShape(generator).mesh(96, 192) for _ in range(3))
    return {
        "vase": _placed(vase(generator), 1.35, (-1.75, -1.3), _glazed((0.10, 0.19, 0.36)), "vase"),
        "wine glass": _placed(goblet(generator), 1.02, (1.0, 0.35), _GLASS, "wine glass"),
        "bowl": _placed(bowl(generator), 0.98, (-0.25, -0.75), _glazed((0.62, 0.57, 0.47)), "bowl"),
        "orange": _placed(
            _rounded(orange), 0.42, (-0.42, -0.6), _peel((0.66, 0.25, 0.03)), "orange", lift=0.36
        ),
        "apple": _placed(
            _rounded(apple), 0.44, (0.24, -0.9), _glossy((0.42, 0.05, 0.035)), "apple", lift=0.36
        ),
        "lemon": _placed(
            superquadric((1.0, 1.0), axes=(1.0, 0.72, 0.72)),
            0.42,
            (-1.12, 1.12),
            _peel((0.70, 0.52, 0.06)),
            "lemon",
            turn_deg=28,
        ),
        "book": _placed(
            box((1.9, 0.48, 1.3)),
            1.0,
            (1.72, -0.75),
            _diffuse((0.06, 0.16, 0.10)),
            "book",
            turn_deg=-24,
        ),
        "bull": _placed(
            bull(generator),
            0.92,
            (1.78, -0.72),
            _diffuse((0.66, 0.62, 0.56)),
            "bull",
            lift=0.48,
            turn_deg=28,
        ),
        "ring": _placed(
            twisted_ring(generator),
            0.36,
            (0.22, 1.5),
            _metal("Au", 0.22),
            "ring",
            lift=0.0,
            lie=True,
        ),
        "cup": _placed(_cup(generator), 0.5, (-2.28, 0.55), _metal("Cu", 0.25), "cup"),
        "glass ball": _placed(_ball(), 0.36, (2.3, 0.95), _GLASS, "glass ball"),
        "plum": _placed(_rounded(plum), 0.30, (-0.62, 1.42), _glossy((0.055, 0.018, 0.05)), "plum"),
    }


def _room(generator: np.random.Generator) -> dict[str, Value]:
    width, depth = _TABLE
    top = box((width, 0.3, depth), (0, -0.15, _WALL_Z + depth / 2))
    wall = box((16.0, _WALL_HEIGHT + 6, 0.3), (0, (_WALL_HEIGHT - 6) / 2, _WALL_Z - 0.15))
    return {
        "table": to_mitsuba(_planar(top), _plastic_of(_planks(generator)), "table"),
        "wall": to_mitsuba(wall, _diffuse((0.34, 0.33, 0.30)), "wall"),
        "cloth": to_mitsuba(
            _cloth(generator), {"type": "twosided", "side": _diffuse_of(_weave())}, "cloth"
        ),
    }


def _placed(
    mesh: Mesh,
    radius: float,
    place: tuple[float, float],
    bsdf: Mapping[str, Any],
    name: str,
    *,
    lift: float = 0.0,
    turn_deg: float = 0.0,
    lie: bool = False,
) -> Value:
    """Return a thing of that radius that stands, or lies, at (x, z), so far above the table."""
    if lie:
        mesh = mesh.rotated(_rotation(0, 90))
    standing = mesh.rotated(_rotation(1, turn_deg)).moved(np.zeros(3), radius)
    low = standing.vertices[:, 1].min()
    x, z = place
    return to_mitsuba(standing.moved(np.array([x, lift - low + 1e-3, z])), dict(bsdf), name)


def _rotation(axis: int, angle_deg: float) -> NDArray[np.float64]:
    """Return the rotation about x, y or z by an angle."""
    cosine, sine = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    turned = np.eye(3)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turned[[first, second], [first, second]] = cosine
    turned[first, second], turned[second, first] = -sine, sine
    return turned


def _rounded(mesh: Mesh) -> Mesh:
    """Return an abstract shape that is drawn towards the sphere, as fruit is."""
    directions = mesh.vertices / np.linalg.norm(mesh.vertices, axis=1, keepdims=True)
    blended = 0.35 * mesh.vertices + 0.65 * directions
    normals = 0.35 * mesh.normals + 0.65 * directions
    return Mesh(
        blended / np.linalg.norm(blended, axis=1).max(),
        normals / np.linalg.norm(normals, axis=1, keepdims=True),
        mesh.texture_coordinates,
        mesh.faces,
    )


def _ball() -> Mesh:
    directions = sphere_directions(96, 192)
    return grid_mesh(directions, directions)


def _cup(generator: np.random.Generator) -> Mesh:
    flare = 1 + generator.uniform(-0.05, 0.05)
    profile = [
        (0.0, 0.16),
        (0.42, 0.20),
        (0.60, 0.60),
        (0.72 * flare, 1.30),
        (0.755 * flare, 1.33),
        (0.79 * flare, 1.30),
        (0.68, 0.58),
        (0.52, 0.08),
        (0.45, 0.0),
        (0.20, 0.02),
        (0.0, 0.03),
    ]
    return lathe(profile).fitted()


def _cloth(generator: np.random.Generator) -> Mesh:
    """Return a napkin that lies on the table in soft folds and hangs over its front edge."""
    rows, columns = 240, 320
    u, v = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    noise = PerlinNoise(generator)
    points = np.stack([u * 4.2 + v * 1.3, v * 3.1, np.zeros_like(u)], axis=-1)
    folds = 0.5 + 0.5 * np.sin(9 * u + 5 * v + 2.4 * noise.fractal(points, 2))
    height = 0.025 + 0.11 * folds**2 * (0.35 + 0.65 * np.abs(np.sin(np.pi * u)))
    x = -1.75 + 3.5 * (u - 0.5) * (1 + 0.05 * np.sin(7 * v)) + 0.5 * (v - 0.5)
    along = -0.3 + 3.1 * v
    edge = _WALL_Z + _TABLE[1]
    over = np.maximum(along - edge + 1.2, 0)
    z = np.minimum(along, edge - 1.2 + 0.9 * (1 - np.exp(-over)))
    vertices = np.stack([x, height, z], axis=-1)
    across, down = (np.gradient(vertices, axis=axis) for axis in (1, 0))
    normals = np.cross(down, across)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    faces = np.concatenate(
        [np.stack([a, c, d], axis=-1).reshape(-1, 3), np.stack([a, d, b], axis=-1).reshape(-1, 3)]
    )
    return Mesh(
        vertices.reshape(-1, 3),
        normals.reshape(-1, 3),
        np.stack([u, v], axis=-1).reshape(-1, 2),
        faces,
    )


def _planar(mesh: Mesh) -> Mesh:
    """Return a mesh with texture coordinates from above."""
    x, z = mesh.vertices[:, 0], mesh.vertices[:, 2]
    coordinates = np.stack([x / _TABLE[0] + 0.5, (z - _WALL_Z) / _TABLE[1]], axis=1)
    return Mesh(mesh.vertices, mesh.normals, coordinates, mesh.faces)


def _planks(generator: np.random.Generator) -> NDArray[np.float32]:
    """Return the albedo of five boards of oak, `(rows, columns, 3)`."""
    rows, columns = _TEXTURE_PX, 2 * _TEXTURE_PX
    v, u = np.mgrid[:rows, :columns] / np.array([rows, columns])[:, None, None]
    board = np.floor(v * 5)
    shift = generator.uniform(0, 40, size=5)[board.astype(int)]
    noise = PerlinNoise(generator)
    place = np.stack([2.5 * u + shift, 26 * v + shift, 0.7 * shift], axis=-1)
    grain = noise.fractal(place, 4)
    rings = 0.5 + 0.5 * np.sin(40 * (v * 5 - board) + 9 * grain)
    tone = generator.uniform(0.8, 1.1, size=5)[board.astype(int)]
    value = tone * (0.72 + 0.18 * rings + 0.22 * grain)
    gap = np.abs(v * 5 - board - 0.5) > 0.494
    value = np.where(gap, 0.25 * value, value)
    return np.asarray(value[..., None] * np.array([0.30, 0.185, 0.10]), np.float32)


def _weave() -> NDArray[np.float32]:
    """Return the albedo of a cloth with woven stripes along its edges, `(rows, columns, 3)`."""
    v, u = np.mgrid[:_TEXTURE_PX, :_TEXTURE_PX] / _TEXTURE_PX
    edge = np.minimum.reduce([u, 1 - u, v, 1 - v])
    stripe = ((edge > 0.06) & (edge < 0.085)) | ((edge > 0.1) & (edge < 0.108))
    cream, red = np.array([0.68, 0.64, 0.56]), np.array([0.42, 0.07, 0.06])
    return np.asarray(np.where(stripe[..., None], red, cream), np.float32)


def _rgb(colour: Sequence[float]) -> dict[str, Any]:
    return {"type": "rgb", "value": list(colour)}


def _bitmap(albedo: NDArray[np.float32]) -> dict[str, Any]:
    return {"type": "bitmap", "bitmap": mi.Bitmap(albedo), "raw": True}


def _diffuse(colour: Sequence[float]) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": _rgb(colour)}


def _diffuse_of(albedo: NDArray[np.float32]) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": _bitmap(albedo)}


def _plastic(reflectance: dict[str, Any], roughness: float) -> dict[str, Any]:
    return {
        "type": "roughplastic",
        "distribution": "ggx",
        "alpha": roughness,
        "diffuse_reflectance": reflectance,
        "nonlinear": True,
    }


def _plastic_of(albedo: NDArray[np.float32]) -> dict[str, Any]:
    return _plastic(_bitmap(albedo), 0.28)


def _glazed(colour: Sequence[float]) -> dict[str, Any]:
    return _plastic(_rgb(colour), 0.09)


def _glossy(colour: Sequence[float]) -> dict[str, Any]:
    return _plastic(_rgb(colour), 0.14)


def _peel(colour: Sequence[float]) -> dict[str, Any]:
    return _plastic(_rgb(colour), 0.32)


def _metal(material: str, roughness: float) -> dict[str, Any]:
    return {
        "type": "roughconductor",
        "material": material,
        "distribution": "ggx",
        "alpha": roughness,
    }


_GLASS: Final[Mapping[str, Any]] = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
