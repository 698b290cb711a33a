"""A lane through meadows: rolling ground with its colours, grass along the lane, fallen leaves.

Metres; the viewer stands on the origin and looks along -z, y is up. `ahead` is -z.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.noise import PerlinNoise
from stimuli.shapes.mesh import Mesh
from stimuli.shapes.solids import grid_faces

Array = NDArray[np.float64]

LANE_WIDTH: Final = 4.4
REACH: Final = 900.0
"""How far the ground is modelled, ahead and to both sides."""

_NEAREST: Final = 1.2
_BEHIND: Final = 60.0
_GRAVEL: Final = ((0.30, 0.25, 0.185), (0.42, 0.36, 0.28))
_GRASS: Final = ((0.055, 0.085, 0.022), (0.16, 0.15, 0.05))
_EARTH: Final = (0.17, 0.12, 0.07)
_STRAW: Final = (0.30, 0.25, 0.11)
_WOODS: Final = ((0.045, 0.05, 0.018), (0.21, 0.115, 0.028))
_WOODS_AHEAD: Final = 430.0


@dataclass(frozen=True)
class Coloured:
    """A mesh with a diffuse albedo at each vertex, `(n, 3)`."""

    mesh: Mesh
    albedo: Array


def lane_centre(ahead: NDArray[np.floating[Any]]) -> Array:
    """Return the lane's middle, x, at distances ahead: a slow S."""
    ahead = np.asarray(ahead, dtype=np.float64)
    return np.asarray(-1.0 + 5.5 * np.sin((ahead - 6) / 52) * np.exp(-ahead / 300))


def _smoothstep(low: float, high: float, values: Array) -> Array:
    share = np.clip((values - low) / (high - low), 0, 1)
    return np.asarray(share * share * (3 - 2 * share))


class Landscape:
    """The ground and what grows on it.

    Parameters
    ----------
    generator
        Draws the undulation, the colours, the grass and the leaves.
    detail
        1 for full images; meshes have about `detail` squared as many parts.
    """

    def __init__(self, generator: np.random.Generator, detail: float = 1.0) -> None:
        self._noise = PerlinNoise(generator)
        self._generator = generator
        self._detail = detail

    def height(self, x: NDArray[np.floating[Any]], ahead: NDArray[np.floating[Any]]) -> Array:
        """Return the ground's height: flat at the lane, rolling beside it, hills far away."""
        beside: Array = np.abs(np.asarray(x) - lane_centre(ahead))
        far = np.stack([x / 95, ahead / 120, np.full_like(x, 0.3)], axis=-1)
        near = np.stack([x / 14, ahead / 17, np.full_like(x, 7.7)], axis=-1)
        rolling = 0.55 * _smoothstep(3, 14, beside) * self._noise(near)
        hills = (2.5 + 5.5 * self._noise.fractal(far, 2)) * _smoothstep(25, 160, beside)
        ditch = -0.22 * np.exp(-(((beside - LANE_WIDTH / 2 - 1.0) / 0.45) ** 2))
        ruts = -0.035 * np.exp(-(((beside - 0.85) / 0.28) ** 2))
        return np.asarray(rolling + hills * _smoothstep(30, 200, np.asarray(ahead)) + ditch + ruts)

    def ground(self) -> Coloured:
        """Return the ground as one mesh, as fine as it is seen."""
        x, ahead = self._grid()
        y = self.height(x, ahead)
        vertices = np.stack([x, y, -ahead], axis=-1)
        normals = np.cross(np.gradient(vertices, axis=1), np.gradient(vertices, axis=0))
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        mesh = Mesh(vertices.reshape(-1, 3), normals.reshape(-1, 3), None, grid_faces(*x.shape))
        return Coloured(mesh, self._colours(x, ahead).reshape(-1, 3))

    def _grid(self) -> tuple[Array, Array]:
        """Return x and distance ahead of the vertices, denser where they are seen larger."""
        rows = round(520 * self._detail)
        ahead = _NEAREST * (REACH / _NEAREST) ** np.linspace(0, 1, rows)
        ahead = np.concatenate([[-_BEHIND, -10, -3, 0], ahead])
        inner = np.linspace(-4.5, 4.5, 2 * round(60 * self._detail) + 1)
        outer = 4.5 * (REACH / 4.5) ** np.linspace(0, 1, round(150 * self._detail) + 1)[1:]
        offsets = np.concatenate([-outer[::-1], inner, outer])
        return lane_centre(ahead)[:, None] + offsets, np.repeat(ahead[:, None], len(offsets), 1)

    def _colours(self, x: Array, ahead: Array) -> Array:
        """Return the albedo: gravel on the lane, grass between its ruts and beside it."""
        where = np.stack([x, ahead, np.zeros_like(x)], axis=-1)
        fine = 0.5 + 0.5 * self._noise.fractal(where * 5.0, 3)
        coarse = np.clip(0.5 + 0.9 * self._noise.fractal(where / 4.0, 2), 0, 1)
        fields = np.clip(0.5 + 1.6 * self._noise(where / 60.0 + 3), 0, 1)
        offset = np.abs(x - lane_centre(ahead)) + 0.35 * self._noise(where * 0.9)
        gravel = _between(*_GRAVEL, np.clip(fine, 0, 1))
        grass = _between(*_GRASS, np.clip(0.6 * coarse + 0.4 * fine, 0, 1))
        far = _smoothstep(12, 40, np.abs(x - lane_centre(ahead)))
        grass = _mixed(grass, _STRAW, 0.75 * far * fields)
        grass = _mixed(grass, _EARTH, 0.8 * far * _smoothstep(0.75, 0.95, 1 - fields))
        verge = _smoothstep(-0.35, 0.25, offset - LANE_WIDTH / 2)
        middle = 0.55 * np.exp(-((offset / 0.42) ** 2))
        return _mixed(gravel, grass, np.maximum(verge, middle))

    def woods(self) -> Coloured:
        """Return the edge of a wood on the horizon: a wavy wall of crowns."""
        columns, rows = round(700 * self._detail), round(26 * self._detail)
        along, across = np.meshgrid(
            np.linspace(-420, 420, columns), np.linspace(0, np.pi, rows), indexing="xy"
        )
        ahead = _WOODS_AHEAD + 45 * self._noise(
            np.stack([along / 160, np.full_like(along, 0.4), np.full_like(along, 5.1)], axis=-1)
        )
        where = np.stack([along / 9, across * 2.2, np.full_like(along, 1.5)], axis=-1)
        crowns = self._noise.fractal(where, 3, 0.6)
        height = 9.0 + 2.5 * self._noise(where / 7)
        x, away = along, ahead - (9 + 5 * crowns) * np.cos(across)
        foot = self.height(x, away) - 1
        y = foot + (height * (1 + 0.25 * crowns)) * np.sin(across) ** 0.6
        vertices = np.stack([x, y, -away], axis=-1)
        normals = np.cross(np.gradient(vertices, axis=1), np.gradient(vertices, axis=0))
        normals /= np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-9)
        mesh = Mesh(vertices.reshape(-1, 3), normals.reshape(-1, 3), None, grid_faces(*x.shape))
        tint = np.clip(0.5 + 1.3 * self._noise.fractal(where * 0.7 + 9, 2), 0, 1)
        return Coloured(mesh, _between(*_WOODS, tint).reshape(-1, 3))

    def grass(self, farthest: float = 55.0) -> Coloured:
        """Return blades of grass beside the lane, thinner with distance."""
        generator, count = self._generator, round(90_000 * self._detail)
        ahead = 2.0 * (farthest / 2.0) ** generator.uniform(size=count)
        side = generator.choice([-1, 1], size=count)
        beside = LANE_WIDTH / 2 - 0.1 + generator.gamma(1.6, 0.9 + ahead / 16)
        x = lane_centre(ahead) + side * beside
        z = -ahead
        size = (0.10 + 0.20 * generator.uniform(size=count) ** 2) * np.clip(beside / 2.8, 0.5, 1.4)
        width = 0.006 + 0.0011 * ahead
        turn = generator.uniform(0, 2 * np.pi, size=count)
        foot = np.stack([x, self.height(x, ahead) - 0.02, z], axis=-1)
        across = np.stack([np.cos(turn), np.zeros(count), np.sin(turn)], axis=-1)
        lean = np.array([0.12, 1, 0]) + generator.normal(0, 0.35, size=(count, 3))
        tip = foot + size[:, None] * lean / np.linalg.norm(lean, axis=-1, keepdims=True)
        corners = [foot - across * width[:, None], foot + across * width[:, None], tip]
        dry = np.clip(generator.normal(0.45, 0.3, size=count), 0, 1)
        return _triangles(np.stack(corners, axis=1), _between(_GRASS[0], _STRAW, dry))

    def fallen_leaves(self, colours: Array, farthest: float = 60.0) -> Coloured:
        """Return leaves that lie on the lane and its verge, in colours drawn from `(n, 3)`."""
        generator, count = self._generator, round(5_000 * self._detail)
        ahead = 3.0 * (farthest / 3.0) ** generator.uniform(size=count)
        side = generator.choice([-1, 1], size=count)
        x = lane_centre(ahead) + side * np.abs(generator.normal(2.4, 1.1, size=count))
        foot = np.stack([x, self.height(x, ahead) + 0.012, -ahead], axis=-1)
        turn = generator.uniform(0, 2 * np.pi, size=count)[:, None] + np.array([0, 2.2, 4.1])
        size = 0.035 * generator.uniform(0.7, 1.4, size=count)[:, None]
        lift = 0.02 * generator.uniform(size=turn.shape)
        offsets = np.stack([size * np.cos(turn), lift, -size * np.sin(turn)], axis=-1)
        return _triangles(foot[:, None] + offsets, generator.choice(colours, size=count))


def _triangles(corners: Array, albedo: Array) -> Coloured:
    """Return separate triangles `(n, 3, 3)`, each with its albedo `(n, 3)`."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    faces = np.arange(corners.shape[0] * 3).reshape(-1, 3)
    mesh = Mesh(corners.reshape(-1, 3), np.repeat(normals, 3, axis=0), None, faces)
    return Coloured(mesh, np.repeat(albedo, 3, axis=0))


def _between(low: object, high: object, share: Array) -> Array:
    return _mixed(np.asarray(low, dtype=np.float64), high, share)


def _mixed(first: Array, second: object, share: Array) -> Array:
    return np.asarray(first + (np.asarray(second) - first) * share[..., None])
