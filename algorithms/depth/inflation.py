"""What an outline alone tells of a shape: heights and normals of a body blown up inside it.

The square root of the solution of Poisson's equation inside an outline is half a sphere where the
outline is a circle and half an ellipsoid where it is an ellipse; it meets every outline edge-on.
Lumo (Johnston 2002) spreads the outline's normals over the inside instead.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy import ndimage

from algorithms.depth.poisson import Mask, Plane, Sides, solve_poisson
from algorithms.errors import InputError

_NORMAL_SMOOTHING_PX: Final = 2.0


def silhouette_relief(mask: ArrayLike) -> Plane:
    """Inflate an outline to a body.

    Parameters
    ----------
    mask
        bool `(height, width)`: where the object is. Where it touches the image's border it is
        taken to go on beyond it, level.

    Returns
    -------
    float32 `(height, width)`, pixels, larger is nearer, 0 outside: half a sphere for a disc. A mask
    without any outline, all of the image, is a plane: a quarter of the shorter side everywhere.

    Raises
    ------
    InputError
        If the mask is not of two dimensions or holds nothing.

    Notes
    -----
    Lopez-Moreno 2011, sec. 4.2.1: the inflation that the contour alone gives, the simplest
    baseline of fig. 4.2.
    """
    inside = checked_mask(mask)
    if inside.all():
        return np.full(inside.shape, min(inside.shape) / 4, dtype=np.float32)
    relief = np.zeros(inside.shape, dtype=np.float32)
    box = bounding_box(inside)
    # A half sphere's squared height, r^2 - x^2 - y^2, has the Laplacian -4.
    squared = solve_poisson(inside[box], _at_border(box, inside.shape), source=1.0)
    relief[box] = np.sqrt(np.maximum(squared, 0))
    return relief


def contour_normals(mask: ArrayLike) -> Plane:
    """Spread the normals of an outline over what it encloses.

    Parameters
    ----------
    mask
        bool `(height, width)`: where the object is.

    Returns
    -------
    float32 `(height, width, 3)`: unit vectors in the project's frame (x right, y up, z towards the
    viewer), 0 outside. Along the outline they lie in the image plane.

    Raises
    ------
    InputError
        If the mask is not of two dimensions or holds nothing.

    Notes
    -----
    Lumo (Johnston 2002): the x and y components are harmonic, z follows from the unit length.
    """
    inside = checked_mask(mask)
    normals = np.zeros((*inside.shape, 3), dtype=np.float32)
    box = bounding_box(inside)
    even = _at_border(box, inside.shape)
    rim = (inside & ~ndimage.binary_erosion(inside, border_value=1))[box]
    soft = ndimage.gaussian_filter(inside.astype(np.float32), _NORMAL_SMOOTHING_PX, mode="nearest")
    down, across = np.gradient(soft[box])
    length = np.maximum(np.hypot(down, across), 1e-6)
    nearest = ndimage.distance_transform_edt(~rim, return_distances=False, return_indices=True)
    outward = (side[tuple(nearest)] for side in (-across / length, down / length))
    x, y = (solve_poisson(inside[box], even, fixed=(rim, side)) for side in outward)
    beyond = np.maximum(np.hypot(x, y), 1)
    towards = np.sqrt(np.maximum(1 - (x / beyond) ** 2 - (y / beyond) ** 2, 0))
    normals[box] = np.stack([x / beyond, y / beyond, towards], axis=-1)
    normals[~inside] = 0
    return normals


def checked_mask(mask: ArrayLike, shape: tuple[int, ...] | None = None) -> Mask:
    """Return a mask as bool `(height, width)`.

    Raises
    ------
    InputError
        If it is not of two dimensions, not of the given shape, or holds nothing.
    """
    inside = np.asarray(mask).astype(bool)
    if inside.ndim != 2 or (shape is not None and inside.shape != shape):
        wanted = "(height, width)" if shape is None else shape
        raise InputError(f"mask: {wanted} is accepted, not {inside.shape}")
    if not inside.any():
        raise InputError("mask: at least one pixel of the object is accepted")
    return inside


def bounding_box(inside: Mask) -> tuple[slice, slice]:
    """Return rows and columns of the smallest box around what a mask holds."""
    rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
    return slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1)


def _at_border(box: tuple[slice, slice], shape: tuple[int, ...]) -> Sides:
    """Tell on which sides a box touches the border of its image: top, bottom, left, right."""
    rows, columns = box
    return rows.start == 0, rows.stop == shape[0], columns.start == 0, columns.stop == shape[1]
