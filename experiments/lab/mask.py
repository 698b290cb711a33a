"""The mask that follows an image: squares of random grey. The web draws the same (`mask.ts`)."""

import numpy as np
from numpy.typing import NDArray
from PIL import Image

_SQUARE_PX = 8
_ALL_BITS = 0xFFFFFFFF


def draw_mask(width_px: int, height_px: int, seed: int) -> Image.Image:
    """Return a mask of the size of an image; the same seed gives the same mask."""
    across, down = -(-width_px // _SQUARE_PX), -(-height_px // _SQUARE_PX)
    greys = mask_greys(across * down, seed).reshape(down, across)
    squares = np.kron(greys, np.ones((_SQUARE_PX, _SQUARE_PX), np.uint8))
    return Image.fromarray(squares[:height_px, :width_px]).convert("RGB")


def mask_greys(count: int, seed: int) -> NDArray[np.uint8]:
    """Return the greys of a mask's squares, row by row, by the generator mulberry32.

    NumPy's generators cannot be had in a browser, and no image may differ between the runners.
    """
    state = (np.uint64(seed) + np.arange(1, count + 1, dtype=np.uint64) * np.uint64(0x6D2B79F5)) & (
        np.uint64(_ALL_BITS)
    )
    mixed = _multiplied(state ^ (state >> np.uint64(15)), state | np.uint64(1))
    other = _multiplied(mixed ^ (mixed >> np.uint64(7)), mixed | np.uint64(61))
    mixed = mixed ^ ((mixed + other) & np.uint64(_ALL_BITS))
    mixed ^= mixed >> np.uint64(14)
    return (mixed >> np.uint64(24)).astype(np.uint8)


def _multiplied(one: NDArray[np.uint64], other: NDArray[np.uint64]) -> NDArray[np.uint64]:
    return (one * other) & np.uint64(_ALL_BITS)
