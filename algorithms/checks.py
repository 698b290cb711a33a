"""What edits of photographs accept."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.color import FloatImage
from algorithms.errors import InputError


def checked_image(image: NDArray[np.floating[Any]]) -> FloatImage:
    """Return linear light as float32 `(height, width, 3)`, the same array if it is so already.

    Raises
    ------
    InputError
        If the shape is another one, or a value is negative or not finite.
    """
    pixels = np.asarray(image, dtype=np.float32)
    if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.size == 0:
        raise InputError(f"image: (height, width, 3) is accepted, not {pixels.shape}")
    if not np.isfinite(pixels).all() or pixels.min() < 0:
        raise InputError("image: finite values of 0 or more are accepted")
    return pixels


def checked_area(name: str, area: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return a mask that may be empty as bool `(height, width)`.

    Raises
    ------
    InputError
        If it has not the height and width of an image's shape; the message begins with the name.
    """
    inside = np.asarray(area).astype(bool)
    if inside.shape != shape[:2]:
        raise InputError(f"{name}: {shape[:2]} is accepted, not {inside.shape}")
    return inside
