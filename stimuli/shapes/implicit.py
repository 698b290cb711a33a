"""Surfaces where a function of space is zero: their smooth unions, and their meshes."""

from collections.abc import Callable, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp
from skimage.measure import marching_cubes

from algorithms.errors import InputError
from stimuli.shapes.mesh import Mesh

Field = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""A function of points `(..., 3)`: below 0 inside, above 0 outside, about a distance near 0."""

_DIFFERENCE_STEP: Final = 1e-4
_NEWTON_STEPS: Final = 3
_BLOCK: Final = 4


def surface_of(field: Field, cells: int = 128, reach: float = 1.05) -> Mesh:
    """Return the surface where a field is zero as a closed mesh, without texture coordinates.

    Parameters
    ----------
    field
        Smooth near its surface; sampled in the cube `-reach..reach`.
    cells
        Samples along an edge of the cube, a multiple of 4: what is thinner than two may be lost.
    reach
        Half the cube's edge; the surface must lie inside.

    Raises
    ------
    InputError
        If the field has no surface in the cube, or one that leaves it.

    Notes
    -----
    Marching cubes (Lewiner et al. 2003) by scikit-image; then each vertex is moved onto the surface
    along the field's gradient by Newton's method, and the normals are that gradient.
    """
    values, spacing = _sampled(field, cells, reach)
    outside = values > 0
    accepted = f"field: a surface within -{reach}..{reach} is accepted"
    if outside.all() or not outside.any():
        raise InputError(f"{accepted}; there is none")
    if not all(np.take(outside, [0, -1], axis=i).all() for i in range(3)):
        raise InputError(f"{accepted}; it leaves that")
    vertices, faces, *_ = marching_cubes(values, 0.0, gradient_direction="descent")
    points = _snapped(field, vertices.astype(np.float64) * spacing - reach, spacing)
    gradient = gradient_of(field, points)
    normals = gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)
    return Mesh(points, normals, None, faces.astype(np.int64))


def gradient_of(field: Field, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the gradient of a field at points `(..., 3)` by central differences."""
    steps = np.eye(3) * _DIFFERENCE_STEP
    ahead = np.stack([field(points + step) for step in steps], axis=-1)
    behind = np.stack([field(points - step) for step in steps], axis=-1)
    return np.asarray((ahead - behind) / (2 * _DIFFERENCE_STEP))


def smooth_union(fields: Sequence[Field], softness: float) -> Field:
    """Return what several fields enclose, with fillets where they meet.

    Parameters
    ----------
    fields
        One or more.
    softness
        The fillets' size, more than 0: two surfaces in the same place grow by 0.7 of it.

    Notes
    -----
    Blinn 1982, *A generalization of algebraic surface drawing*: exponential densities that add up,
    here of distances instead of squared ones.
    """

    def field(points: NDArray[np.float64]) -> NDArray[np.float64]:
        exponents: Any = np.stack([-part(points) / softness for part in fields])
        return np.asarray(-softness * logsumexp(exponents, axis=0))

    return field


def _sampled(field: Field, cells: int, reach: float) -> tuple[NDArray[np.float64], float]:
    """Return the field on a grid, exactly only where it may be 0, and the grid's spacing."""
    axis, spacing = np.linspace(-reach, reach, cells), 2 * reach / (cells - 1)
    middles = axis.reshape(-1, _BLOCK).mean(axis=1)
    coarse = field(np.stack(np.meshgrid(middles, middles, middles, indexing="ij"), axis=-1))
    # Twice what a distance can change from a block's middle to its corner.
    near = np.abs(coarse) < np.sqrt(3) * _BLOCK * spacing
    values = np.asarray(np.kron(coarse, np.ones((_BLOCK,) * 3)), dtype=np.float64)
    index = np.nonzero(np.kron(near, np.ones((_BLOCK,) * 3, dtype=bool)))
    values[index] = field(np.stack([axis[i] for i in index], axis=-1))
    return values, spacing


def _snapped(field: Field, points: NDArray[np.float64], spacing: float) -> NDArray[np.float64]:
    # What is so near the surface hardly turns away from the first gradient.
    gradient = gradient_of(field, points)
    square = np.maximum(np.einsum("ij,ij->i", gradient, gradient), 1e-6)
    for _ in range(_NEWTON_STEPS):
        step = -(field(points) / square)[:, None] * gradient
        length = np.linalg.norm(step, axis=1, keepdims=True)
        # A step beyond the cell that the vertex was found in would fold the mesh.
        points = points + step * np.minimum(1, spacing / 2 / np.maximum(length, 1e-300))
    return points
