"""What a mesh file says, before anything is known of the surface."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError

MAX_FACES: Final = 5_000_000
"""Larger meshes are refused, as soon as their file tells."""


@dataclass(frozen=True)
class Polygons:
    """Vertices and triangles as a file has them.

    Attributes
    ----------
    vertices
        `(n, 3)`.
    faces
        `(m, 3)` indices.
    normals, texture_coordinates
        `(n, 3)` and `(n, 2)`, the latter from the left and from below; None where there are none.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]
    normals: NDArray[np.float64] | None
    texture_coordinates: NDArray[np.float64] | None

    def check(self) -> None:
        """Raise InputError unless there is something, in range and finite."""
        for name, values in (("vertices", self.vertices), ("faces", self.faces)):
            if not len(values):
                raise InputError(f"{name}: one or more are accepted; there are none")
        if not np.isfinite(self.vertices).all():
            raise InputError("vertices: finite positions are accepted")
        if self.faces.min() < 0 or self.faces.max() >= len(self.vertices):
            raise InputError(f"faces: indices of the {len(self.vertices)} vertices are accepted")


def check_count(name: str, count: int) -> None:
    """Raise InputError if there are too many faces or vertices."""
    if not 0 <= count <= MAX_FACES:
        raise InputError(f"{name}: at most {MAX_FACES} are accepted, not {count}")


def fans(corners: NDArray[Any], counts: NDArray[Any]) -> NDArray[np.int64]:
    """Split polygons into triangles around the first corner of each.

    Parameters
    ----------
    corners
        `(k,)` indices, one polygon after the other.
    counts
        `(m,)`: the number of corners of each, 3 or more.

    Returns
    -------
    `(k - 2 m, 3)` indices.

    Raises
    ------
    InputError
        If a polygon has fewer corners.
    """
    if (counts < 3).any():
        raise InputError("faces: three or more corners are accepted")
    triangles = counts - 2
    starts = np.repeat(np.cumsum(counts) - counts, triangles)
    step = np.arange(triangles.sum()) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    places = np.stack([starts, starts + step + 1, starts + step + 2], axis=1)
    return np.asarray(corners[places], dtype=np.int64)
