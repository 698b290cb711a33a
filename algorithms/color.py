"""The sRGB transfer curve, and luminance."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatImage = NDArray[np.float32]
"""Linear light, float32 `(height, width, 3)`, Rec. 709 primaries, scene- or display-referred."""

LUMINANCE_WEIGHTS = (0.2126, 0.7152, 0.0722)
"""Weights of linear red, green and blue in luminance (ITU-R BT.709)."""

_LINEAR_LIMIT = 0.0031308
_ENCODED_LIMIT = 0.04045


def encode_srgb(linear: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Encode display-referred linear light as sRGB values.

    Parameters
    ----------
    linear
        Any shape; values outside 0..1 are clipped.

    Returns
    -------
    Encoded values in 0..1, same shape.

    Notes
    -----
    IEC 61966-2-1.

    Examples
    --------
    >>> float(encode_srgb(np.array(0.5)).round(4))
    0.7354
    """
    clipped = np.clip(np.asarray(linear, dtype=np.float64), 0.0, 1.0)
    power = 1.055 * np.maximum(clipped, _LINEAR_LIMIT) ** (1 / 2.4) - 0.055
    return np.asarray(np.where(clipped <= _LINEAR_LIMIT, 12.92 * clipped, power))


def decode_srgb(encoded: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Decode sRGB values to display-referred linear light: the inverse of `encode_srgb`.

    Parameters
    ----------
    encoded
        Any shape; values outside 0..1 are clipped.

    Returns
    -------
    Linear light in 0..1, same shape.

    Notes
    -----
    IEC 61966-2-1.
    """
    clipped = np.clip(np.asarray(encoded, dtype=np.float64), 0.0, 1.0)
    power = ((clipped + 0.055) / 1.055) ** 2.4
    return np.asarray(np.where(clipped <= _ENCODED_LIMIT, clipped / 12.92, power))


def luminance(image: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Return the relative luminance of a linear image.

    Parameters
    ----------
    image
        Linear light, `(..., 3)`.

    Returns
    -------
    Luminance, `(...)`, in the image's own unit; white (1, 1, 1) gives 1.
    """
    return np.asarray(np.asarray(image, dtype=np.float64) @ np.array(LUMINANCE_WEIGHTS))


def srgb_digits(linear: NDArray[np.floating[Any]]) -> NDArray[np.uint8]:
    """Encode display-referred linear light as sRGB digits, 0..255, of the same shape.

    Parameters
    ----------
    linear
        Of one dimension or more; values outside 0..1 are clipped.
    """
    # Row by row: the curve works in double precision, which large pictures have no room for.
    digits = np.empty(np.shape(linear), np.uint8)
    for place, row in enumerate(linear):
        digits[place] = np.round(encode_srgb(row) * 255)
    return digits
