"""Caustics added to the surface that they fall on."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from algorithms.caustics.settings import check_strengths, check_texture, colour_of
from algorithms.checks import checked_area, checked_image
from algorithms.color import FloatImage, luminance
from algorithms.errors import InputError
from algorithms.filters import bilateral
from algorithms.projection import Plane, project_map

_EDGE_PX: Final = 0.7
_TEXTURE_SPACE: Final = 1 / 16
_TEXTURE_RANGE: Final = 0.3  # of the logarithm of luminance
_DARK: Final = 0.1  # of the mean: less luminance has hardly a colour of its own


def add_caustics(
    image: NDArray[np.floating[Any]],
    maps: ArrayLike,
    quad: ArrayLike,
    strength: float | Sequence[float] = 1.0,
    *,
    colour: ArrayLike = (1.0, 1.0, 1.0),
    texture: float = 1.0,
    spared: ArrayLike | None = None,
) -> FloatImage:
    """Add the luminance of caustics to a surface in a photograph.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`, finite, 0 or more.
    maps
        A map `(rows, columns)`, or several `(n, rows, columns)`, finite, 0 or more, as
        `caustic_map` returns them.
    quad
        Four (x, y) in pixels from the image's top left, clockwise from where a map's top left goes.
    strength
        Of the map, or of each: the luminance added where it is 1, 0 or more; 1 is the mean
        luminance in the quadrilateral.
    colour
        Red, green and blue of the light, 0 or more; only their ratios count.
    texture
        0..1: how far the surface's own texture shows in the light that it reflects.
    spared
        bool `(height, width)`: where no light falls, such as the object itself; None for nowhere.

    Returns
    -------
    float32 `(height, width, 3)`; the image's own values where no light is added.

    Raises
    ------
    InputError
        If an image, map, number or the quadrilateral is not as described.

    Notes
    -----
    Lopez-Moreno 2011, eq. 7.2 and 7.3: added luminance; a homography is linear in the map's values,
    so that the sum of several maps is projected. The surface keeps its chromaticity and, unlike
    there, its texture, as it reflects the added light like the rest.
    """
    pixels = checked_image(image)
    planes = _checked_maps(maps)
    strengths = check_strengths(np.ravel(strength).tolist(), len(planes))
    tint = colour_of(colour)
    check_texture(texture)
    total = np.tensordot(np.asarray(strengths, np.float32), planes, axes=1)
    place, light = project_map(total, quad, pixels.shape)
    covered = project_map(np.ones_like(total), quad, pixels.shape)[1]
    if spared is not None:
        light *= 1 - _softened(checked_area("spared", spared, pixels.shape)[place])
    result = pixels.copy()
    if light.any():
        result[place] += _reflected(pixels[place], light, covered, tint, texture)
    return result


def _reflected(
    surface: FloatImage, light: Plane, covered: Plane, tint: Plane, texture: float
) -> FloatImage:
    """Return what a surface reflects of light that is relative to its mean luminance."""
    own = luminance(surface).astype(np.float32)
    colour = np.average(surface, axis=(0, 1), weights=covered)
    mean = np.float32(luminance(colour))
    added = mean * light
    if texture > 0 and mean > 0:
        dimmest = np.float32(_DARK) * mean
        added *= _texture_of(np.maximum(own, dimmest), covered > 0) ** np.float32(texture)
    # The light takes the surface's chromaticity; where it is so dark that this is mostly noise,
    # that of the whole quadrilateral.
    added /= np.maximum(own + np.float32(_DARK) * mean, np.finfo(np.float32).tiny)
    pure = surface + np.float32(_DARK) * colour.astype(np.float32)
    return np.asarray(pure * (added[..., None] * tint))


def _texture_of(own: Plane, inside: NDArray[np.bool_]) -> Plane:
    """Return the luminance relative to the neighbours' on the same side of strong edges."""
    logarithm = np.log(own)
    space_px = max(2.0, _TEXTURE_SPACE * max(own.shape))
    smooth = bilateral(logarithm, space_px, _TEXTURE_RANGE, mask=inside)
    return np.where(inside, np.exp(logarithm - smooth), 1)


def _softened(mask: NDArray[np.bool_]) -> Plane:
    return ndimage.gaussian_filter(mask.astype(np.float32), _EDGE_PX)


def _checked_maps(maps: ArrayLike) -> Plane:
    planes = np.asarray(maps, dtype=np.float32)
    planes = planes[None] if planes.ndim == 2 else planes
    if planes.ndim != 3 or planes.size == 0:
        raise InputError(f"maps: (rows, columns) or (n, rows, columns), not {np.shape(maps)}")
    if not np.isfinite(planes).all() or planes.min() < 0:
        raise InputError("maps: finite values of 0 or more are accepted")
    return planes
