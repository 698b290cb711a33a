"""Highlights: where they begin, and what an object would look like without them.

The dichromatic model: a highlight has the light's colour and is added to the surface's own. In a
colour space with one axis along the light's colour the other two are free of it (Mallick et al.
2005). Where the surface's colour is known from neighbours that show no highlight, the rest is the
highlight (Yang, Wang and Ahuja 2010). A grey surface under white light tells nothing of its
highlights; it is left as it is.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from algorithms.errors import InputError
from algorithms.filters import bilateral

Array = NDArray[np.float64]

WHITE: Final = (1.0, 1.0, 1.0)

_BINS: Final = 64
_SMOOTHING_BINS: Final = 1.5
_GREY: Final = 0.02
_DARK: Final = 1e-6
_SPACE_IN_SIDES: Final = 1 / 8
_RANGE: Final = 0.04
_ROUNDS: Final = 10
_SETTLED: Final = 0.003


@dataclass(frozen=True)
class Separation:
    """An image taken apart.

    Attributes
    ----------
    diffuse
        Linear light without highlights, float32 `(height, width, 3)`.
    specular
        The highlights, float32 `(height, width, 3)`, of the light's colour; the sum of both is the
        image.
    """

    diffuse: NDArray[np.float32]
    specular: NDArray[np.float32]


def highlight_threshold(luminance: ArrayLike) -> float:
    """Return the luminance at which an object's highlights begin.

    Parameters
    ----------
    luminance
        Of the object's pixels, any shape, linear.

    Returns
    -------
    Where their histogram falls fastest: the minimum of its derivative.

    Raises
    ------
    InputError
        If there is no value, or one is not finite.

    Notes
    -----
    Khan et al. 2006; Lopez-Moreno 2011, sec. 6.3 and 9.3.1. The histogram has 64 bins and is
    smoothed, as noise has steep places everywhere.
    """
    values = np.asarray(luminance, dtype=np.float64).ravel()
    if values.size == 0 or not np.isfinite(values).all():
        raise InputError("luminance: one or more finite values are accepted")
    counts, edges = np.histogram(values, bins=_BINS)
    smooth = ndimage.gaussian_filter1d(counts.astype(np.float64), _SMOOTHING_BINS, mode="constant")
    fall = np.gradient(smooth)
    return float((edges[:-1] + edges[1:])[np.argmin(fall)] / 2)


def specular_free(image: NDArray[np.floating[Any]], light_colour: ArrayLike = WHITE) -> Array:
    """Return what of an image no highlight reaches.

    Parameters
    ----------
    image
        Linear light, `(..., 3)`.
    light_colour
        Red, green and blue of the light, each more than 0; only their ratios count.

    Returns
    -------
    The length of the part of each colour that is perpendicular to the light's, `(...)`: albedo
    times shading times the saturation of the surface. A length does not depend on how the two axes
    perpendicular to the light's colour are chosen.

    Raises
    ------
    InputError
        If a shape or the light's colour is not as described.

    Notes
    -----
    Mallick, Zickler, Kriegman and Belhumeur 2005, eq. 6.
    """
    colour = _light_colour(light_colour)
    pixels = _checked(image)
    axis = colour / np.linalg.norm(colour)
    across = pixels - (pixels @ axis)[..., None] * axis
    return np.asarray(np.linalg.norm(across, axis=-1))


def separate_highlights(
    image: NDArray[np.floating[Any]],
    mask: NDArray[np.bool_] | None = None,
    light_colour: ArrayLike = WHITE,
) -> Separation:
    """Take the highlights off an image.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`.
    mask
        bool `(height, width)`: where it is to be done; None for everywhere.
    light_colour
        Red, green and blue of the light, each more than 0; only their ratios count.

    Returns
    -------
    The image without highlights, and these.

    Raises
    ------
    InputError
        If a shape or the light's colour is not as described.

    Notes
    -----
    Yang, Wang and Ahuja 2010. The largest chromaticity of a pixel is the lower, the more highlight
    there is in it; an edge-aware filter, guided by what the highlight does not change, lifts it to
    that of its neighbours, until nothing rises any more.
    """
    colour = _light_colour(light_colour)
    pixels = _checked(image)
    inside = np.ones(pixels.shape[:2], bool) if mask is None else np.asarray(mask, bool)
    if pixels.ndim != 3 or inside.shape != pixels.shape[:2]:
        raise InputError("mask: the image's height and width are accepted")
    balanced = np.maximum(pixels / colour, 0)
    total = balanced.sum(axis=2)
    coloured = inside & (total > _DARK * max(float(total.max()), _DARK))
    share = balanced / np.maximum(total, 1e-12)[..., None]
    white = 1 - 3 * share.min(axis=2)
    coloured &= white > _GREY
    guide = (share.max(axis=2) - share.min(axis=2)) / np.maximum(white, _GREY)
    largest = _lifted(share.max(axis=2), np.clip(guide, 0, 1), coloured)
    excess = largest * total - balanced.max(axis=2)
    per_channel = np.where(coloured, excess / np.maximum(3 * largest - 1, _GREY), 0)
    specular = np.clip(per_channel, 0, balanced.min(axis=2))[..., None] * colour
    return Separation(
        (pixels - specular).astype(np.float32),
        np.broadcast_to(specular, pixels.shape).astype(np.float32),
    )


def _lifted(largest: Array, guide: Array, inside: NDArray[np.bool_]) -> Array:
    """Lift the largest chromaticity to that of neighbours whose surface has the same colour."""
    lifted = np.where(inside, largest, 0)
    space_px = max(1.0, max(largest.shape) * _SPACE_IN_SIDES)
    for _ in range(_ROUNDS):
        smooth = bilateral(lifted, space_px, _RANGE, mask=inside, guide=guide, cells_per_sigma=1)
        rise = np.maximum(smooth - lifted, 0)
        lifted = lifted + rise
        if rise.max() < _SETTLED:
            break
    return lifted


def _light_colour(light_colour: ArrayLike) -> Array:
    colour = np.asarray(light_colour, dtype=np.float64)
    if colour.shape != (3,) or not np.isfinite(colour).all() or (colour <= 0).any():
        raise InputError("light_colour: three finite numbers of more than 0 are accepted")
    return np.asarray(colour / colour.mean())


def _checked(image: NDArray[np.floating[Any]]) -> Array:
    pixels = np.asarray(image, dtype=np.float64)
    if pixels.ndim == 0 or pixels.shape[-1] != 3:
        raise InputError(f"image: (height, width, 3) is accepted, not {pixels.shape}")
    if not np.isfinite(pixels).all():
        raise InputError("image: finite values are accepted")
    return pixels
