"""A cast shadow lifted: an opaque object's is full, that of glass is mostly light.

Light is a factor in linear values: within a shadow the same surface is darker by what the light
adds. The factor is read from both sides of the shadow's outline; in the penumbra the picture says
how much of it applies.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage
from skimage.measure import block_reduce
from skimage.transform import resize

from algorithms.checks import checked_area, checked_image
from algorithms.color import FloatImage, luminance
from algorithms.errors import InputError

Plane = NDArray[np.float32]
Mask = NDArray[np.bool_]

_BAND_IN_SIDES: Final = 1 / 12
_SPREAD_IN_SIDES: Final = 1 / 6
_CELLS: Final = 8  # in a standard deviation: what is so smooth needs no pixels
_FAINT: Final = 1e-4  # weight of neighbours too far away to tell
_DARKEST: Final = 1e-6


def lift_shadow(
    image: NDArray[np.floating[Any]],
    shadow: ArrayLike,
    amount: float = 1.0,
    *,
    penumbra_px: float = 3.0,
    spared: ArrayLike | None = None,
) -> FloatImage:
    """Lighten a shadow that an object casts on a surface.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`, finite, 0 or more.
    shadow
        bool `(height, width)`: where it is; drawn to about the penumbra's width.
    amount
        0..1: 1 makes the surface as bright as around the shadow.
    penumbra_px
        Half the width of the shadow's soft edge, or of what the mask may be wrong by, more than 0.
    spared
        bool `(height, width)`: what is no part of the surface, such as the object that casts the
        shadow; it stays as it is, and tells nothing. None for nothing.

    Returns
    -------
    float32 `(height, width, 3)`; the image's own values beyond the penumbra.

    Raises
    ------
    InputError
        If an array or number is not as described, or no surface without shadow is beside it.

    Notes
    -----
    The factor may change along the outline, and with the colour of the light that is left.
    """
    pixels = checked_image(image)
    dark = checked_area("shadow", shadow, pixels.shape)
    free = np.zeros_like(dark)
    if spared is not None:
        free = checked_area("spared", spared, pixels.shape)
    if not 0 <= amount <= 1:
        raise InputError("amount: 0..1 is accepted")
    if not 0 < penumbra_px < np.inf:
        raise InputError("penumbra_px: a finite number of more than 0 is accepted")
    result = pixels.copy()
    if amount == 0 or not (dark & ~free).any():
        return result
    box, band_px = _surroundings(dark, penumbra_px)
    surface, dark, free = pixels[box], dark[box], free[box]
    depth = ndimage.distance_transform_edt(dark) - ndimage.distance_transform_edt(~dark)
    inner, outer = _both_sides(surface, depth, free, penumbra_px, band_px)
    ratio = np.minimum(inner / outer, 1)
    coverage = _coverage(surface, depth, inner, outer, penumbra_px)
    coverage[free] = 0
    share = 1 - coverage[..., None] * (1 - ratio)
    factor = (share + np.float32(amount) * (1 - share)) / share
    result[box] = np.where(coverage[..., None] > 0, surface * factor, surface)
    return result


def _surroundings(dark: Mask, penumbra_px: float) -> tuple[tuple[slice, slice], float]:
    """Return the box that a shadow and the surface beside it are within, and how broad the latter.

    Its breadth is counted from the end of the penumbra.
    """
    rows, columns = np.flatnonzero(dark.any(axis=1)), np.flatnonzero(dark.any(axis=0))
    extent = max(np.ptp(rows), np.ptp(columns)) + 1
    band_px = max(3.0, _BAND_IN_SIDES * float(extent))
    margin = int(np.ceil(band_px + 4 * penumbra_px)) + 1
    top, left = (max(0, int(each[0]) - margin) for each in (rows, columns))
    box = (slice(top, int(rows[-1]) + margin + 1), slice(left, int(columns[-1]) + margin + 1))
    return box, band_px


def _both_sides(
    surface: FloatImage, depth: Plane, free: Mask, penumbra_px: float, band_px: float
) -> tuple[Plane, Plane]:
    """Return what the surface beside the outline is like in shadow and in light, everywhere."""
    clear_px = min(2 * penumbra_px, float(depth.max()) / 2)
    usable = ~ndimage.binary_dilation(free, iterations=2)
    inner = usable & (depth >= clear_px) & (depth <= clear_px + band_px)
    outer = usable & (depth <= -2 * penumbra_px) & (depth >= -2 * penumbra_px - band_px)
    if not inner.any() or not outer.any():
        raise InputError("shadow: one with the same surface in light beside it is accepted")
    logarithm = np.log(np.maximum(surface, _DARKEST))
    sigma_px = max(2.0, _SPREAD_IN_SIDES * max(surface.shape[:2]))
    dark, lit = (np.exp(_spread(logarithm, band, sigma_px)) for band in (inner, outer))
    return dark, lit


def _coverage(
    surface: FloatImage, depth: Plane, inner: Plane, outer: Plane, penumbra_px: float
) -> Plane:
    """Return how much of the light is missing, 0..1.

    A mask is rarely right to the pixel, and a factor beside its place leaves a line: near the
    outline the picture itself says how dark it is.
    """
    drawn = np.clip(0.5 + depth / (4 * penumbra_px), 0, 1)
    own, dark, lit = (luminance(each) for each in (surface, inner, outer))
    seen = np.clip((lit - own) / np.maximum(lit - dark, _DARKEST), 0, 1)
    seen[lit <= dark] = 0
    near = np.exp(-((np.maximum(np.abs(depth) - penumbra_px, 0) / penumbra_px) ** 2))
    coverage = near * seen + (1 - near) * drawn
    return np.asarray(np.where(depth > -4 * penumbra_px, coverage, 0), dtype=np.float32)


def _spread(values: Plane, known: Mask, sigma_px: float) -> Plane:
    """Return what the nearest known values are on average; their mean where none is near."""
    cell_px = max(1, int(sigma_px / _CELLS))
    cells = (cell_px, cell_px, 1)
    weight = block_reduce(known[..., None].astype(np.float32), cells, np.mean)
    sums = block_reduce(np.where(known[..., None], values, 0), cells, np.mean)
    sigma = (sigma_px / cell_px, sigma_px / cell_px, 0)
    weight, sums = (ndimage.gaussian_filter(each, sigma) for each in (weight, sums))
    coarse = (sums + _FAINT * values[known].mean(axis=0)) / (weight + _FAINT)
    whole = (coarse.shape[0] * cell_px, coarse.shape[1] * cell_px, values.shape[2])
    spread = resize(coarse, whole, order=1, mode="edge")[: values.shape[0], : values.shape[1]]
    return np.asarray(spread, dtype=np.float32)
