"""The clickable regions of a stimulus: reading them, numbering them, outlining one."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from scipy import ndimage

from algorithms.errors import InputError

Regions = NDArray[np.uint8]
"""Label image `(height, width)`: 0 for the background, 1 and more for the objects."""

NUMERAL_GAP = 0.02
"""From the lower edge of a region to the centre of its numeral, in image heights."""


def load_regions(path: Path) -> Regions:
    """Read a label image.

    Raises
    ------
    InputError
        If it cannot be read or is not an 8-bit image of one channel.
    """
    try:
        with Image.open(path) as image:
            if image.mode not in ("L", "P"):
                raise InputError(f"{path}: an 8-bit label image of one channel is accepted")
            return np.array(image, dtype=np.uint8)
    except (OSError, UnidentifiedImageError) as error:
        raise InputError(f"{path}: not a label image that can be read") from error


def numeral_places(regions: Regions) -> dict[int, tuple[float, float]]:
    """Return where the numeral of each region is centred, so that it names the object to press.

    It stands below the middle of the region's bounding box, `NUMERAL_GAP` image heights under its
    lower edge, and at least as far above the image's lower edge. Every runner follows this rule.

    Parameters
    ----------
    regions
        The label image.

    Returns
    -------
    By label, (x, y) as fractions of the image's width and height from its upper left corner.

    Examples
    --------
    >>> regions = np.zeros((100, 100), np.uint8)
    >>> regions[20:50, 10:30] = 1
    >>> numeral_places(regions)
    {1: (0.2, 0.52)}
    """
    height, width = regions.shape
    places = {}
    for label, box in enumerate(ndimage.find_objects(regions), start=1):
        if box is not None:
            rows, columns = box
            y = min(rows.stop / height + NUMERAL_GAP, 1 - NUMERAL_GAP)
            places[label] = ((columns.start + columns.stop) / 2 / width, y)
    return places


def outline(regions: Regions, label: int, thickness_px: int) -> NDArray[np.bool_]:
    """Return the pixels just outside one region, for showing which object was meant.

    Parameters
    ----------
    regions
        The label image `(height, width)`.
    label
        The region, 1 or more.
    thickness_px
        How wide the outline is, 1 or more.

    Returns
    -------
    Mask `(height, width)`, true on the outline.
    """
    region = regions == label
    away: NDArray[Any] = ndimage.distance_transform_edt(~region)
    return np.asarray((away > 0) & (away <= thickness_px))
