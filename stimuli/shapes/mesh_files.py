"""Meshes of the user's: PLY and OBJ files, checked when they are read."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.shapes.mesh import Mesh
from stimuli.shapes.obj_file import parse_obj
from stimuli.shapes.ply_file import parse_ply
from stimuli.shapes.polygons import Polygons

MAX_BYTES: Final = 256 * 1024**2
"""Larger mesh files are refused unread."""

_PARSERS: Final[dict[str, Callable[[bytes], Polygons]]] = {".ply": parse_ply, ".obj": parse_obj}


def read_mesh(path: str | Path) -> Mesh:
    """Read a triangle mesh.

    Parameters
    ----------
    path
        A PLY file (ascii or binary) or a Wavefront OBJ file, at most 256 MiB and five million
        faces; faces of more than three corners are split into fans. Materials are not read.

    Returns
    -------
    The mesh in the file's own unit and frame (`Mesh.fitted` brings it to radius 1). Its normals are
    the file's; where it has none, the mean of the faces' around a position, weighted by the angle
    of their corners. A closed surface that is inside out is turned.

    Raises
    ------
    InputError
        If the file is missing, too large, damaged, of another format, without faces or with
        nothing but faces without area, or if a number is not finite or an index out of range.

    Notes
    -----
    Thuermer and Wuethrich 1998, *Computing vertex normals from polygonal facets*.
    """
    path = Path(path)
    parse = _PARSERS.get(path.suffix.lower())
    if parse is None:
        raise InputError(f"{path}: a mesh file ending in {' or '.join(_PARSERS)} is accepted")
    try:
        if path.stat().st_size > MAX_BYTES:
            raise InputError(f"{path}: at most {MAX_BYTES // 1024**2} MiB are accepted")
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    try:
        return _mesh(parse(content))
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _mesh(polygons: Polygons) -> Mesh:
    polygons.check()
    used, number = np.unique(polygons.faces, return_inverse=True)
    vertices, faces = polygons.vertices[used], number.reshape(-1, 3)
    # Corners that coincide, as at the poles of a globe: such a face bounds nothing.
    corners = vertices[faces]
    faces = faces[(corners != np.roll(corners, 1, axis=1)).any(axis=2).all(axis=1)]
    across = _across(vertices, faces)
    if not across.any():
        raise InputError("faces: some with an area are accepted")
    bare = Mesh(vertices, np.zeros_like(vertices), None, faces)
    if bare.is_closed and bare.volume < 0:
        bare = replace(bare, faces=np.ascontiguousarray(faces[:, ::-1]))
    normals = _smooth_normals(bare)
    if polygons.normals is not None:
        normals = _given_normals(polygons.normals[used], normals)
    coordinates = polygons.texture_coordinates
    if coordinates is not None:
        # From below in files, from above in Mitsuba.
        coordinates = coordinates[used] * [1, -1] + [0, 1]
    return replace(bare, normals=normals, texture_coordinates=coordinates)


def _across(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return vectors at right angles to the faces, outwards, as long as twice their area."""
    corners = vertices[faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def _smooth_normals(mesh: Mesh) -> NDArray[np.float64]:
    across = _unit(_across(mesh.vertices, mesh.faces))
    place = mesh.places()
    total = np.zeros_like(mesh.vertices)
    for corner in range(3):
        here, ahead, behind = (mesh.vertices[mesh.faces[:, (corner + i) % 3]] for i in range(3))
        cosines = np.einsum("ij,ij->i", _unit(ahead - here), _unit(behind - here))
        angles = np.arccos(np.clip(cosines, -1, 1))
        np.add.at(total, place[mesh.faces[:, corner]], across * angles[:, None])
    return _unit(total)[place]


def _given_normals(
    given: NDArray[np.float64], computed: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a file's normals, on the faces' side, the computed ones where they say nothing."""
    proper = (np.isfinite(given).all(axis=1) & given.any(axis=1)).reshape(-1, 1)
    normals = np.where(proper, _unit(np.where(proper, given, 1)), computed)
    side = np.sign(np.einsum("ij,ij->", normals, computed))
    return np.asarray(normals if side >= 0 else -normals)


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors of length 1, and +y in place of none."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 0, vectors / np.where(lengths > 0, lengths, 1), [0.0, 1.0, 0.0])
