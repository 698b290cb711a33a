"""The clickable regions of a stimulus: numbering them, outlining one."""

from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Regions = NDArray[np.uint8]
"""Label image `(height, width)`: 0 for the background, 1 and more for the objects."""

Point = tuple[float, float]


def numeral_places(regions: Regions, size_px: float, gap_px: float) -> dict[int, Point]:
    """Return where the numeral of each region goes: beside it, over no region, inside the image.

    Below the region's bounding box if there is room, else above, to the right, to the left or at
    a corner; where an image is too crowded, the place that covers least. The web's front end
    follows the same rule (`placement.ts`).

    Parameters
    ----------
    regions
        The label image `(height, width)`.
    size_px
        The side of a numeral's square, in image pixels.
    gap_px
        Its distance from the bounding box, in image pixels.

    Returns
    -------
    By label, the numeral's centre (x, y) in image pixels from the upper left corner.

    Examples
    --------
    >>> regions = np.zeros((100, 100), np.uint8)
    >>> regions[20:50, 10:30] = 1
    >>> numeral_places(regions, size_px=10, gap_px=2)
    {1: (20.0, 57.0)}
    """
    places = {}
    for label, box in enumerate(ndimage.find_objects(regions), start=1):
        if box is not None:
            rows, columns = box
            candidates = _candidates(rows, columns, size_px / 2 + gap_px)
            places[label] = min(candidates, key=partial(_covered, regions, size_px))
    return places


def _candidates(rows: slice, columns: slice, away: float) -> list[Point]:
    """Below, above, to the sides, then the corners of a region's box."""
    top, bottom, left, right = rows.start, rows.stop, columns.start, columns.stop
    x, y = (left + right) / 2, (top + bottom) / 2
    return [
        (x, bottom + away),
        (x, top - away),
        (right + away, y),
        (left - away, y),
        (right, bottom + away / 2),
        (left, bottom + away / 2),
        (right, top - away / 2),
        (left, top - away / 2),
    ]


def _covered(regions: Regions, size_px: float, centre: Point) -> int:
    """Count the pixels of a square that belong to a region or lie outside the image."""
    left, top = (int(np.floor(middle - size_px / 2)) for middle in centre)
    side = int(np.ceil(size_px))
    inside = regions[max(top, 0) : max(top + side, 0), max(left, 0) : max(left + side, 0)]
    return side * side - inside.size + int(np.count_nonzero(inside))


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
    mask = np.zeros(regions.shape, bool)
    boxes = ndimage.find_objects(region.astype(np.uint8))
    if boxes:  # distances are wanted near the region alone
        near = tuple(slice(max(0, s.start - thickness_px), s.stop + thickness_px) for s in boxes[0])
        away: NDArray[Any] = ndimage.distance_transform_edt(~region[near])
        mask[near] = (away > 0) & (away <= thickness_px)
    return mask
