"""What is behind an object: a hole in a picture filled with what is around it."""

import importlib
import math
from types import ModuleType
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage
from skimage.transform import resize

from algorithms.checks import checked_image
from algorithms.color import FloatImage
from algorithms.depth.inflation import bounding_box, checked_mask
from algorithms.errors import InputError, UnavailableError

Mask = NDArray[np.bool_]

_HOLE_PX: Final = 24_000  # a larger hole is filled at a smaller size
_CONTEXT_IN_SIDES: Final = 0.75
_PATCH_RADIUS_PX: Final = 4
_RIM_PX: Final = 2  # pixels along an outline show a part of the object
_DARKEST: Final = 1e-6
_BRIGHTEST: Final = 254 / 255
_SEED: Final = 0


def fill_behind(image: NDArray[np.floating[Any]], mask: ArrayLike) -> FloatImage:
    """Replace an object by a background that could be behind it.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`, finite, 0 or more.
    mask
        bool `(height, width)`: where the object is; not all of the image.

    Returns
    -------
    float32 `(height, width, 3)`; the image's own values but for the object and two pixels around.

    Raises
    ------
    InputError
        If an image or mask is not as described.
    UnavailableError
        If PatchMatch is not installed.

    Notes
    -----
    Patches from around the object are put together so that they agree (Barnes et al. 2009). Large
    holes are filled at a smaller size, at which no hole is seen behind what bends the light.
    """
    pixels = checked_image(image)
    hole = ndimage.binary_dilation(checked_mask(mask, pixels.shape[:2]), iterations=_RIM_PX)
    if hole.all():
        raise InputError("mask: a part of the image must show the background")
    box = _with_context(bounding_box(hole), hole.shape)
    within, around = hole[box], pixels[box]
    # PatchMatch takes 8 bits: a curve with an inverse keeps a high dynamic range within them.
    grey = np.float32(max(float(np.median(around[~within])), _DARKEST))
    factor = min(1.0, math.sqrt(_HOLE_PX / float(within.sum())))
    filled = _filled(around / (around + grey), within, factor)
    result = pixels.copy()
    result[box][within] = (filled * grey / (1 - filled))[within]
    return result


def _filled(shown: FloatImage, within: Mask, factor: float) -> FloatImage:
    """Fill a hole in a picture of 0..1 at a fraction of its size; less than 1."""
    shape = tuple(max(1, round(extent * factor)) for extent in within.shape)
    small, hole = shown, within
    if factor < 1:
        small = _without(shown, within, shape)
        hole = resize(within.astype(np.float32), shape, order=1, anti_aliasing=True) > 0.01
    digits = np.round(small * 255).astype(np.uint8)
    patches = _patchmatch().inpaint(digits, hole, patch_size=_PATCH_RADIUS_PX)
    filled = np.minimum(patches / np.float32(255), np.float32(_BRIGHTEST))
    if factor < 1:
        filled = resize(filled, within.shape, order=1)
    return np.asarray(filled, dtype=np.float32)


def _without(shown: FloatImage, within: Mask, shape: tuple[int, ...]) -> FloatImage:
    """Reduce a picture without what is within a mask: it does not bleed into its neighbours."""
    weights = resize((~within).astype(np.float32), shape, order=1, anti_aliasing=True)[..., None]
    seen = resize(np.where(within[..., None], 0, shown), shape, order=1, anti_aliasing=True)
    return np.asarray(seen / np.maximum(weights, 1e-6), dtype=np.float32).clip(0, 1)


def _patchmatch() -> ModuleType:
    """Return the library, ready to give the same for the same."""
    try:
        patchmatch = importlib.import_module("patchmatch")
    except ImportError as error:
        raise UnavailableError("filling a background needs: pip install pypatchmatch") from error
    if not patchmatch.patchmatch_available:
        raise UnavailableError(
            "filling a background needs PatchMatch's compiled library: "
            "pip install --force-reinstall --no-cache-dir pypatchmatch"
        )
    patchmatch.set_random_seed(_SEED)
    return patchmatch


def _with_context(box: tuple[slice, slice], shape: tuple[int, ...]) -> tuple[slice, slice]:
    """Return a box with as much around it as patches are taken from."""
    margin_px = round(_CONTEXT_IN_SIDES * max(side.stop - side.start for side in box))
    rows, columns = (
        slice(max(0, side.start - margin_px), min(extent, side.stop + margin_px))
        for side, extent in zip(box, shape, strict=True)
    )
    return rows, columns
