"""Seeing a flat map in perspective: from its rectangle to four corners in an image."""

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from skimage.transform import ProjectiveTransform, resize, warp

from algorithms.errors import InputError

Plane = NDArray[np.float32]
Corners = NDArray[np.float64]

_FINE_PX: Final = 2**20  # of the image: a smaller part is drawn finer, then averaged
_FINER: Final = 3
_STRAIGHT: Final = 1e-3  # the sine of a turn that counts as none
_ACCEPTED: Final = (
    "quad: four corners (x, y), in order, of a convex quadrilateral in the image are accepted"
)


def checked_quad(quad: ArrayLike, shape: tuple[int, ...]) -> Corners:
    """Return the corners of a quadrilateral that a map can be projected onto.

    Parameters
    ----------
    quad
        `(4, 2)`: (x, y) in pixels from the image's top left corner, in order; clockwise, or the
        other way round for the mirror image.
    shape
        Height and width of the image.

    Raises
    ------
    InputError
        If it crosses itself, is not convex, has no area, or a corner is not finite or lies outside
        the image.
    """
    corners = np.asarray(quad, dtype=np.float64)
    if corners.shape != (4, 2) or not np.isfinite(corners).all():
        raise InputError(_ACCEPTED)
    sides = np.roll(corners, -1, axis=0) - corners
    following = np.roll(sides, -1, axis=0)
    lengths = np.hypot(*sides.T)
    # Convex: all turns are to the same side. A crossing has turns to both.
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    turns *= np.sign(turns.sum())
    if (lengths < 1).any() or (turns <= _STRAIGHT * lengths * np.roll(lengths, -1)).any():
        raise InputError(f"{_ACCEPTED}; these cross, lie on a line or dent it")
    height, width = shape[:2]
    if (corners < 0).any() or (corners > [width, height]).any():
        raise InputError(f"{_ACCEPTED}; it has {width} x {height} pixels")
    return corners


def project_map(
    values: NDArray[np.floating], quad: ArrayLike, shape: tuple[int, ...]
) -> tuple[tuple[slice, slice], Plane]:
    """Project a map onto a quadrilateral of an image, without steps at its edges.

    Parameters
    ----------
    values
        `(height, width)`: the map.
    quad
        `(4, 2)`: where its corners go, clockwise from its top left one: (x, y) in pixels from the
        image's top left corner.
    shape
        Height and width of the image.

    Returns
    -------
    The rows and columns of the image that the quadrilateral is within, and the projected map there,
    float32, 0 outside of the quadrilateral.

    Raises
    ------
    InputError
        If the quadrilateral is not accepted: see `checked_quad`.
    """
    corners = checked_quad(quad, shape)
    low, high = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0))
    (left, top), (right, bottom) = low.astype(int), high.astype(int)
    height, width = bottom - top, right - left
    finer = _FINER if height * width <= _FINE_PX else 1
    drawn = _no_finer_than(values, corners * finer)
    rows, columns = drawn.shape
    edges = np.array([[0, 0], [columns, 0], [columns, rows], [0, rows]], dtype=np.float64)
    # Pixel centres have whole numbers there, and a half from the corner.
    homography = ProjectiveTransform.from_estimate((corners - low) * finer - 0.5, edges - 0.5)
    fine = warp(drawn, homography, output_shape=(height * finer, width * finer), order=1, cval=0)
    mean = fine.reshape(height, finer, width, finer).mean(axis=(1, 3))
    return (slice(top, bottom), slice(left, right)), mean.astype(np.float32)


def _no_finer_than(values: NDArray[np.floating], corners: Corners) -> Plane:
    """Reduce a map to as many pixels as its longest sides will cover, so that none is left out."""
    lengths = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    wanted = (max(lengths[1], lengths[3]), max(lengths[0], lengths[2]))
    drawn = np.asarray(values, dtype=np.float32)
    reduced = tuple(
        min(extent, math.ceil(length)) for extent, length in zip(drawn.shape, wanted, strict=True)
    )
    if reduced == drawn.shape:
        return drawn
    return np.asarray(resize(drawn, reduced, order=1, anti_aliasing=True), dtype=np.float32)
