"""Simple solids from which scenes are built: flat polygons, boxes, gables and tubes."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stimuli.shapes.mesh import Mesh

_BOX_CORNERS: Final = np.array(list(np.ndindex(2, 2, 2))) - 0.5
# Counter-clockwise as seen from outside: left, right, bottom, top, back, front.
_BOX_SIDES: Final = (
    (0, 1, 3, 2),
    (4, 6, 7, 5),
    (0, 4, 5, 1),
    (2, 3, 7, 6),
    (0, 2, 6, 4),
    (1, 5, 7, 3),
)


def merged(meshes: Sequence[Mesh]) -> Mesh:
    """Return several meshes as one; texture coordinates are 0 where a mesh has none."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([_texture_coordinates(mesh) for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
    )


def _texture_coordinates(mesh: Mesh) -> NDArray[np.float64]:
    if mesh.texture_coordinates is None:
        return np.zeros((len(mesh.vertices), 2))
    return mesh.texture_coordinates


def polygons(outlines: Sequence[ArrayLike]) -> Mesh:
    """Return flat, convex polygons with sharp edges between them.

    Parameters
    ----------
    outlines
        The corners of each, `(k, 3)`, counter-clockwise as seen from outside. Texture coordinates
        run along the first side and the last one, both 0..1.
    """
    return merged([_polygon(np.asarray(outline, dtype=np.float64)) for outline in outlines])


def _polygon(corners: NDArray[np.float64]) -> Mesh:
    along, up = corners[1] - corners[0], corners[-1] - corners[0]
    normal = np.cross(along, up)
    normal /= np.linalg.norm(normal)
    offsets = corners - corners[0]
    across = np.cross(normal, along)
    u, v = offsets @ along / (along @ along), offsets @ across / (across @ across)
    v /= max(float(np.abs(v).max()), 1e-12)
    fan = np.arange(1, len(corners) - 1)
    return Mesh(
        corners,
        np.tile(normal, (len(corners), 1)),
        np.stack([u, 1 - v], axis=1),
        np.stack([np.zeros_like(fan), fan, fan + 1], axis=1),
    )


def box(size: ArrayLike, centre: ArrayLike = (0, 0, 0)) -> Mesh:
    """Return a closed box.

    Parameters
    ----------
    size
        Along x, y and z, more than 0.
    centre
        Where its middle is.
    """
    corners = _BOX_CORNERS * np.asarray(size, dtype=np.float64) + np.asarray(centre)
    return polygons([corners[list(side)] for side in _BOX_SIDES])


def gable(size: ArrayLike, rise: float) -> Mesh:
    """Return a closed prism with a pointed top: the body of a house, standing on y = 0.

    Parameters
    ----------
    size
        Width along x, height of the side walls along y, and depth along z.
    rise
        How far the ridge, which runs along z, is above the side walls.
    """
    width, height, depth = np.asarray(size, dtype=np.float64)
    outline = np.array(
        [
            (-width / 2, 0.0),
            (width / 2, 0.0),
            (width / 2, height),
            (0.0, height + rise),
            (-width / 2, height),
        ]
    )
    front = np.column_stack([outline, np.full(5, depth / 2)])
    back = np.column_stack([outline, np.full(5, -depth / 2)])
    turns = [(i, (i + 1) % 5) for i in range(5)]
    sides = [np.stack([front[i], back[i], back[j], front[j]]) for i, j in turns]
    return polygons([front, back[::-1], *sides])


def tube(path: ArrayLike, radii: ArrayLike, sides: int = 12) -> Mesh:
    """Return a round tube along a path, closed by flat ends.

    Parameters
    ----------
    path
        Its axis, `(n, 3)`, two or more points that differ from their neighbours.
    radii
        `(n,)` or one for all of them, 0 or more.
    sides
        Around, 3 or more.

    Notes
    -----
    The frame is carried along without twist, so that the tube does not turn about its axis.
    """
    axis = np.asarray(path, dtype=np.float64)
    radius = np.broadcast_to(np.asarray(radii, dtype=np.float64), len(axis))
    tangents = np.gradient(axis, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    first, second = _frames(tangents)
    angle = np.linspace(0, 2 * np.pi, sides + 1)[None, :, None]
    angle = np.where(angle == angle[:, -1:], 0.0, angle)
    outward = np.cos(angle) * first[:, None] + np.sin(angle) * second[:, None]
    rings = axis[:, None] + radius[:, None, None] * outward
    u, v = np.meshgrid(np.linspace(0, 1, sides + 1), np.linspace(0, 1, len(axis)))
    side = Mesh(
        rings.reshape(-1, 3),
        _side_normals(outward, tangents, axis, radius).reshape(-1, 3),
        np.stack([u, v], axis=-1).reshape(-1, 2),
        grid_faces(len(axis), sides + 1),
    )
    ends = [rings[0, :-1][::-1], rings[-1, :-1]]
    caps = [_polygon(ring) for ring, r in zip(ends, radius[[0, -1]], strict=True) if r > 0]
    return merged([side, *caps])


def _frames(tangents: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return two directions across each tangent, turning as little as possible along the path."""
    first = np.empty_like(tangents)
    helper = np.eye(3)[np.abs(tangents[0]).argmin()]
    for i, tangent in enumerate(tangents):
        across = helper - (helper @ tangent) * tangent
        helper = first[i] = across / np.linalg.norm(across)
    return first, np.cross(tangents, first)


def _side_normals(
    outward: NDArray[np.float64],
    tangents: NDArray[np.float64],
    axis: NDArray[np.float64],
    radius: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Lean the normals of a tube as its radius grows or shrinks."""
    steps = np.linalg.norm(np.diff(axis, axis=0), axis=1)
    slope = np.gradient(radius, np.concatenate([[0.0], np.cumsum(steps)]))
    normals = outward - (slope[:, None] * tangents)[:, None]
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True))


def grid_faces(rows: int, columns: int) -> NDArray[np.int64]:
    """Return the triangles `(m, 3)` of a grid of vertices `rows` x `columns`.

    They are seen from the side from which columns run to the right and rows upwards.
    """
    index: NDArray[Any] = np.arange(rows * columns).reshape(rows, columns)
    lower_left, lower_right = index[:-1, :-1].ravel(), index[:-1, 1:].ravel()
    upper_left, upper_right = index[1:, :-1].ravel(), index[1:, 1:].ravel()
    return np.concatenate(
        [
            np.stack([lower_left, lower_right, upper_right], axis=1),
            np.stack([lower_left, upper_right, upper_left], axis=1),
        ]
    )
