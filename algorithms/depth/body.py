"""A closed body from the relief of its visible side: normals, and the far side as its mirror."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.depth.inflation import checked_mask
from algorithms.depth.poisson import Mask, Plane
from algorithms.errors import InputError


@dataclass(frozen=True)
class Body:
    """Both sides of an object, float32, 0 outside of it.

    Attributes
    ----------
    front, back
        `(height, width)`: heights of the surfaces that face the viewer and the far side, pixels,
        larger is nearer.
    front_normals, back_normals
        `(height, width, 3)`: unit vectors that point out of the body, in the project's frame.
    """

    front: Plane
    back: Plane
    front_normals: Plane
    back_normals: Plane


def mirrored_body(relief: NDArray[np.floating[Any]], mask: ArrayLike) -> Body:
    """Close a relief by its mirror image in the plane of the picture.

    Parameters
    ----------
    relief
        `(height, width)`, pixels, larger is nearer.
    mask
        bool `(height, width)`: where the object is.

    Raises
    ------
    InputError
        If a shape is not as described, or a value inside the mask is not finite.

    Notes
    -----
    Lopez-Moreno 2011, sec. 3.8: global convexity; what is wrong with it nobody sees.
    """
    inside = checked_mask(mask, np.shape(relief))
    normals = relief_normals(relief, inside)
    front = np.where(inside, relief, 0).astype(np.float32)
    return Body(front, -front, normals, normals * np.array([1, 1, -1], dtype=np.float32))


def relief_normals(relief: NDArray[np.floating[Any]], mask: ArrayLike) -> Plane:
    """Return the normals of a relief.

    Parameters
    ----------
    relief
        `(height, width)`, pixels, larger is nearer.
    mask
        bool `(height, width)`: where the object is.

    Returns
    -------
    float32 `(height, width, 3)`: unit vectors in the project's frame (x right, y up, z towards the
    viewer), 0 outside. Nothing outside the mask plays a part.

    Raises
    ------
    InputError
        If a shape is not as described, or a value inside the mask is not finite.
    """
    inside = checked_mask(mask, np.shape(relief))
    heights = np.where(inside, relief, 0).astype(np.float32)
    if not np.isfinite(heights).all():
        raise InputError("relief: finite values are accepted")
    normals = np.zeros((*heights.shape, 3), dtype=np.float32)
    # Rows grow downwards, y upwards.
    normals[..., 0] = -slope_within(heights, inside)
    normals[..., 1] = slope_within(heights.T, inside.T).T
    normals[..., 2] = 1
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals[~inside] = 0
    return normals


def slope_within(heights: Plane, inside: Mask) -> Plane:
    """Return differences from column to column, `(height, width)`; 0 where there is no neighbour.

    The mean of those to the left and to the right, if both neighbours are inside.
    """
    step = np.where(inside[:, 1:] & inside[:, :-1], np.diff(heights, axis=1), np.nan)
    nothing = np.full((len(heights), 1), np.nan, dtype=np.float32)
    left, right = np.hstack([nothing, step]), np.hstack([step, nothing])
    left, right = np.where(np.isnan(left), right, left), np.where(np.isnan(right), left, right)
    return np.asarray(np.nan_to_num((left + right) / 2))
