"""Triangle meshes, and how Mitsuba gets them."""

from dataclasses import dataclass, replace
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError

Value = Any
"""A value of Mitsuba's or Dr.Jit's, whose types depend on the variant."""

_WELD_TOLERANCE: Final = 1e-9


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh with smooth normals, in the project's frame.

    Attributes
    ----------
    vertices, normals
        `(n, 3)`; normals of unit length, on the side that the faces are seen from.
    texture_coordinates
        `(n, 2)`, both 0..1, first to the right, second down; None for a mesh that has none.
    faces
        `(m, 3)` indices, counter-clockwise as seen from outside.

    Notes
    -----
    Where texture coordinates or normals jump, vertices stand twice at one position.
    """

    vertices: NDArray[np.float64]
    normals: NDArray[np.float64]
    texture_coordinates: NDArray[np.float64] | None
    faces: NDArray[np.int64]

    @property
    def bounding_radius(self) -> float:
        """The largest distance of a vertex from the origin."""
        return float(np.linalg.norm(self.vertices, axis=1).max())

    @property
    def volume(self) -> float:
        """The volume inside a closed mesh, negative if its faces are turned inside out."""
        # The divergence theorem: each face spans a signed tetrahedron with the origin.
        return float(np.linalg.det(self.vertices[self.faces]).sum() / 6)

    @property
    def is_closed(self) -> bool:
        """Whether every edge is shared by exactly two faces, of like orientation."""
        return len(self.welded_faces()) > 0 and self.open_edges == 0

    @property
    def open_edges(self) -> int:
        """How many ways along edges are not one face's there and another's back, seams welded."""
        corners = self.welded_faces()
        edges = np.concatenate([corners[:, [i, (i + 1) % 3]] for i in range(3)])
        ways, count = np.unique(edges @ np.array([len(self.vertices), 1]), return_counts=True)
        back = ways % len(self.vertices) * len(self.vertices) + ways // len(self.vertices)
        once = ways[count == 1]
        return int(((count != 1) | ~np.isin(back, once, assume_unique=True)).sum())

    def places(self) -> NDArray[np.int64]:
        """Return a number for each vertex `(n,)`, the same for vertices at one position."""
        grid = self.bounding_radius * _WELD_TOLERANCE
        rounded = (self.vertices / grid).round() if grid else self.vertices
        order = np.lexsort(rounded.T)
        differs = (np.diff(rounded[order], axis=0) != 0).any(axis=1)
        places = np.empty(len(rounded), dtype=np.int64)
        places[order] = np.concatenate([[0], differs.cumsum()])
        return places

    def welded_faces(self) -> NDArray[np.int64]:
        """Return the faces with one index a position, `(k, 3)`, without those that have no area."""
        corners = self.places()[self.faces]
        proper = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        return np.asarray(corners[proper])

    def moved(self, offset: NDArray[np.float64], scale: float = 1.0) -> "Mesh":
        """Return the mesh scaled about the origin, then moved by `offset` `(3,)`."""
        return replace(self, vertices=self.vertices * scale + offset)

    def rotated(self, rotation: NDArray[np.float64]) -> "Mesh":
        """Return the mesh turned about the origin by a rotation matrix `(3, 3)`."""
        return replace(self, vertices=self.vertices @ rotation.T, normals=self.normals @ rotation.T)

    def fitted(self) -> "Mesh":
        """Return the mesh moved and scaled: its bounding box around the origin, its radius 1."""
        middle = (self.vertices.min(axis=0) + self.vertices.max(axis=0)) / 2
        centred = self.moved(-middle)
        return centred.moved(np.zeros(3), 1 / centred.bounding_radius)


def require_closed(mesh: Mesh, name: str) -> None:
    """Refuse a mesh without an inside, such as glass and other volumes need.

    Raises
    ------
    InputError
        If the mesh is not closed, or turned inside out; the message names it.
    """
    if not mesh.is_closed:
        raise InputError(
            f"{name}: a closed surface is accepted; {mesh.open_edges} of {3 * len(mesh.faces)} "
            "edges do not lie between just two faces of like orientation"
        )
    if mesh.volume <= 0:
        raise InputError(f"{name}: faces counter-clockwise as seen from outside are accepted")


def grid_mesh(vertices: NDArray[np.float64], normals: NDArray[np.float64]) -> Mesh:
    """Return the closed mesh of a surface laid out from pole to pole, like a globe's map.

    Parameters
    ----------
    vertices, normals
        `(rows + 1, columns + 1, 3)`: rows from the pole at +y to the one at -y, whose vertices
        are all one point; columns around y from +z over +x, the last equal to the first.

    Returns
    -------
    The mesh; its texture coordinates count columns and rows from 0 to 1.
    """
    rows, columns = vertices.shape[0] - 1, vertices.shape[1] - 1
    u, v = np.meshgrid(np.arange(columns + 1) / columns, np.arange(rows + 1) / rows)
    return Mesh(
        vertices.reshape(-1, 3),
        normals.reshape(-1, 3),
        np.stack([u, v], axis=-1).reshape(-1, 2),
        _grid_faces(rows, columns),
    )


def _grid_faces(rows: int, columns: int) -> NDArray[np.int64]:
    index = np.arange((rows + 1) * (columns + 1)).reshape(rows + 1, columns + 1)
    upper_left, upper_right = index[:-1, :-1], index[:-1, 1:]
    lower_left, lower_right = index[1:, :-1], index[1:, 1:]
    # At the poles one of a quadrilateral's two triangles has no area.
    first = np.stack([upper_left, lower_left, lower_right], axis=-1)[:-1]
    second = np.stack([upper_left, lower_right, upper_right], axis=-1)[1:]
    return np.concatenate([first.reshape(-1, 3), second.reshape(-1, 3)])


def to_mitsuba(mesh: Mesh, bsdf: Value, name: str, **parts: Value) -> Value:
    """Return a mesh as a shape of Mitsuba's, with smooth normals.

    Parameters
    ----------
    mesh
        Where it stands in the scene.
    bsdf
        Its material: a dictionary as `mi.load_dict` takes it, or the object made from one.
    name
        The shape's identifier; a scene's dictionary replaces it by its key there.
    parts
        What else it has, in the same form: `interior=` a medium, `emitter=` a light.

    Notes
    -----
    The engine must have been chosen (`stimuli.engine.choose_engine`).
    """
    properties = mi.Properties()
    properties.set_id(name)
    for part, value in {"bsdf": bsdf, **parts}.items():
        properties[part] = mi.load_dict(value) if isinstance(value, dict) else value
    shape = mi.Mesh(
        name,
        vertex_count=len(mesh.vertices),
        face_count=len(mesh.faces),
        has_vertex_normals=True,
        has_vertex_texcoords=mesh.texture_coordinates is not None,
        props=properties,
    )
    arrays: dict[str, NDArray[Any]] = {
        "vertex_positions": mesh.vertices.astype(np.float32),
        "vertex_normals": mesh.normals.astype(np.float32),
        "faces": mesh.faces.astype(np.uint32),
    }
    if mesh.texture_coordinates is not None:
        arrays["vertex_texcoords"] = mesh.texture_coordinates.astype(np.float32)
    parameters = mi.traverse(shape)
    for key, values in arrays.items():
        parameters[key] = values.ravel()
    parameters.update()
    return shape
