"""A surface cut into small triangles: the samples at which light enters it.

The pieces cover the surface without gap or overlap, so that their areas add up to the mesh's, and
each knows how it spreads about its centre: a sum over pieces is then exact to third order in their
size, and needs no denser sampling where triangles are narrow.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.shapes.mesh import Mesh

FEWEST_PIECES: Final = 500
MOST_PIECES: Final = 2_000_000

# Cut until no edge is longer, in units of the root of a piece's area: found by trying.
_LONGEST_EDGE: Final = 2.4
# Where an edge is cut; drawn, so that two cuttings differ like two sets of samples.
_CUT: Final = (0.4, 0.6)


@dataclass(frozen=True)
class SurfacePieces:
    """Small triangles that make up a surface.

    Attributes
    ----------
    centres, normals
        `(n, 3)`: centroids, and the smooth normals there.
    areas
        `(n,)`.
    spreads
        `(n, 3, 3)`: covariance of a piece's points about its centre.
    """

    centres: NDArray[np.float64]
    normals: NDArray[np.float64]
    areas: NDArray[np.float64]
    spreads: NDArray[np.float64]

    @property
    def spacing(self) -> float:
        """How far apart pieces of mean area would lie on a square grid."""
        return float(np.sqrt(self.areas.mean()))


def cut_surface(mesh: Mesh, count: int, generator: np.random.Generator) -> SurfacePieces:
    """Cut a mesh into about as many pieces as are wanted, or its faces where these are more.

    Parameters
    ----------
    mesh
        Of faces of any size and form.
    count
        `FEWEST_PIECES` to `MOST_PIECES`.
    generator
        Draws where edges are cut.

    Raises
    ------
    InputError
        If the count is out of range, or the mesh has no area or too many faces.

    Notes
    -----
    The longest edge of a triangle is cut again and again until all are short (Rivara 1984), which
    leaves no triangle narrower than it found it.
    """
    check_count(count)
    if len(mesh.faces) > MOST_PIECES:
        raise InputError(f"mesh: {len(mesh.faces)} faces given, {MOST_PIECES} or fewer accepted")
    area = surface_area(mesh)
    if not area:
        raise InputError("mesh: one with an area is accepted")
    triangles = np.concatenate([mesh.vertices, mesh.normals], axis=1)[mesh.faces]
    triangles = triangles[_areas(triangles) > 0]
    longest = _LONGEST_EDGE * float(np.sqrt(area / count))
    return _pieces(_cut(triangles, longest, generator))


def check_count(count: int) -> None:
    """Refuse a number of pieces that is out of range."""
    if not FEWEST_PIECES <= count <= MOST_PIECES:
        raise InputError(f"points: {count} given, {FEWEST_PIECES} to {MOST_PIECES} accepted")


def surface_area(mesh: Mesh) -> float:
    """Return the area of all faces of a mesh."""
    return float(_areas(mesh.vertices[mesh.faces]).sum())


def _cut(
    triangles: NDArray[np.float64], longest: float, generator: np.random.Generator
) -> NDArray[np.float64]:
    """Cut triangles `(n, 3, 6)`, position and normal a corner, until all edges are short."""
    short = []
    while len(triangles):
        following, last = triangles[:, [1, 2, 0]], triangles[:, [2, 0, 1]]
        lengths = np.linalg.norm((following - last)[..., :3], axis=-1)  # opposite each corner
        keep = lengths.max(axis=1) <= longest
        short.append(triangles[keep])
        rest = np.flatnonzero(~keep)
        apex = lengths[rest].argmax(axis=1)
        a, b, c = triangles[rest, apex], following[rest, apex], last[rest, apex]
        middle = b + generator.uniform(*_CUT, size=(len(rest), 1)) * (c - b)
        halves = [np.stack([a, b, middle], axis=1), np.stack([a, middle, c], axis=1)]
        triangles = np.concatenate(halves)
    return np.concatenate(short)


def _areas(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    corners = triangles[..., :3]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(np.linalg.norm(across, axis=1) / 2)


def _pieces(triangles: NDArray[np.float64]) -> SurfacePieces:
    means = triangles.mean(axis=1)
    centres, normals = means[:, :3], means[:, 3:]
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    arms = triangles[..., :3] - centres[:, None]
    spreads = np.einsum("nki,nkj->nij", arms, arms) / 12
    return SurfacePieces(centres, normals, _areas(triangles), spreads)
