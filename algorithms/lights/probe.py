"""The object that tells of the light: checked, cut out, reduced to luminance.

Of several components of the mask the largest counts. Pixels that have the image's largest value in
a channel are clipped and left out, once they are more than one in a hundred.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.color import LUMINANCE_WEIGHTS
from algorithms.errors import InputError

SMALLEST_PX: Final = 12
"""The least height and width of an object."""

_FEW: Final = 0.01
_MOST: Final = 0.5
_BLACK: Final = 1e-6


@dataclass(frozen=True)
class Probe:
    """An object cut out of its image.

    Attributes
    ----------
    luminance
        float64 `(height, width)` of the box around the object with one pixel of margin, unless the
        image ends there; 0 or more.
    mask
        bool, same shape: the object.
    usable
        bool, same shape: pixels of the object that are not clipped.
    at_border
        Whether the image ends at the box's top, bottom, left and right.
    remarks
        What was left out, a sentence each.
    """

    luminance: NDArray[np.float64]
    mask: NDArray[np.bool_]
    usable: NDArray[np.bool_]
    at_border: tuple[bool, bool, bool, bool]
    remarks: tuple[str, ...]


def prepare_probe(image: NDArray[Any], mask: NDArray[Any]) -> Probe:
    """Check an image and the mask of an object in it, and cut the object out.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`, or its luminance, `(height, width)`. Values below 0
        count as 0; values outside the mask are not looked at.
    mask
        `(height, width)`, bool, or numbers of which those other than 0 are the object.

    Returns
    -------
    The object.

    Raises
    ------
    InputError
        If a shape is wrong, the mask is empty, too small or fills the image, or the object is
        black, clipped or not finite.
    """
    image, mask = np.asarray(image), np.asarray(mask)
    _check_shapes(image, mask)
    inside, remarks = _largest_component(mask != 0)
    box, at_border = _box(inside)
    if all(at_border):
        raise InputError(
            "mask: it touches the image's border on all sides; an object with background at one "
            "side at least is accepted"
        )
    inside, pixels = inside[box], np.atleast_3d(image[box])
    within = pixels[inside]
    if not np.isfinite(within).all():
        raise InputError("image: finite values are accepted inside the mask")
    usable, clipped = _usable(pixels, within, inside)
    weights = LUMINANCE_WEIGHTS if pixels.shape[2] == 3 else (1.0,)
    luminance = np.zeros(inside.shape)
    for channel, weight in enumerate(weights):
        luminance[inside] += weight * np.maximum(within[:, channel], 0)
    if luminance.max() <= _BLACK * max(1.0, float(np.abs(within).max())):
        raise InputError("image: the object is black; one that reflects light is accepted")
    if any(at_border):
        remarks.append("the object is cut off by the image's border, which is not its outline")
    return Probe(luminance, inside, usable, at_border, (*remarks, *clipped))


def _check_shapes(image: NDArray[Any], mask: NDArray[Any]) -> None:
    if image.ndim == 3 and image.shape[2] == 4:
        raise InputError(
            "image: it has an alpha channel; an opaque one, (height, width, 3), is accepted"
        )
    if image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] not in (1, 3)):
        raise InputError(
            f"image: (height, width, 3) or (height, width) is accepted, not {image.shape}"
        )
    if image.dtype.kind not in "fui":
        raise InputError(f"image: numbers are accepted, not {image.dtype}")
    if mask.shape != image.shape[:2]:
        raise InputError(
            f"mask: {mask.shape} given, the image's height and width {image.shape[:2]} accepted"
        )
    if not mask.any():
        raise InputError("mask: it is empty; one with an object is accepted")


def _largest_component(mask: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], list[str]]:
    labels, count = ndimage.label(mask)
    if count == 1:
        return mask, []
    sizes = np.bincount(labels.ravel())[1:]
    largest = int(np.argmax(sizes)) + 1
    share = 100 * sizes[largest - 1] / sizes.sum()
    return labels == largest, [
        f"the mask has {count} components; the largest is used, {share:.1f} % of it"
    ]


def _box(inside: NDArray[np.bool_]) -> tuple[Any, tuple[bool, bool, bool, bool]]:
    rows, columns = (np.flatnonzero(inside.any(axis=axis)) for axis in (1, 0))
    top, bottom, left, right = rows[0], rows[-1] + 1, columns[0], columns[-1] + 1
    if min(bottom - top, right - left) < SMALLEST_PX:
        raise InputError(
            f"mask: the object is {right - left} x {bottom - top} pixels, "
            f"at least {SMALLEST_PX} x {SMALLEST_PX} are accepted"
        )
    height, width = inside.shape
    at_border = (bool(top == 0), bool(bottom == height), bool(left == 0), bool(right == width))
    box = np.s_[max(0, top - 1) : bottom + 1, max(0, left - 1) : right + 1]
    return box, at_border


def _usable(
    pixels: NDArray[Any], within: NDArray[Any], inside: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], tuple[str, ...]]:
    clipped = inside & (pixels >= within.max()).any(axis=2)
    share = float(clipped.sum() / inside.sum())
    if share <= _FEW:
        return inside, ()
    if share > _MOST and within.max() > 0:
        raise InputError(
            f"image: {100 * share:.0f} % of the object have one and the same largest value, "
            "as where a picture is saturated; at most 50 % are accepted"
        )
    return inside & ~clipped, (f"{100 * share:.1f} % of the object are clipped and left out",)
