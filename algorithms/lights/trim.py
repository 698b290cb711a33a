"""A mask that is too large takes in background; the edge it should follow lies inside it.

Just inside the outline of a well-masked object luminance changes slowly, or fastest at the outline
itself. If it jumps further in, all around, that is where the object ends.
"""

from dataclasses import replace
from typing import Final

import numpy as np
from scipy import ndimage

from algorithms.lights.contour import silhouette
from algorithms.lights.probe import Probe

_REACH_IN_RADII: Final = 0.1
_LEAST_REACH_PX: Final = 8
_STEEPNESS: Final = 3.0


def trimmed(probe: Probe) -> Probe:
    """Return the probe with a mask that ends where the object does.

    Parameters
    ----------
    probe
        Its mask may be too large by up to a twentieth of its radius, at least 4 pixels, the same
        all around.

    Returns
    -------
    The same, unless the mean step of luminance across one depth is three times that of greater
    depths; then all that is less deep is taken off, and a remark says so.
    """
    outline = silhouette(probe.mask)
    radius_px = 2 * float(probe.mask.sum()) / outline.length_px
    reach_px = max(_LEAST_REACH_PX, round(_REACH_IN_RADII * radius_px))
    if reach_px > radius_px / 2:
        return probe
    inwards = np.stack([outline.normals[:, 1], -outline.normals[:, 0]], axis=-1)
    depths_px = np.arange(reach_px + 1) + 0.5
    places = outline.points_px[:, None] + depths_px[:, None] * inwards[:, None]
    luminance = ndimage.map_coordinates(probe.luminance, np.moveaxis(places, -1, 0), order=1)
    steps = np.abs(np.diff(luminance, axis=1)).mean(axis=0)
    half = reach_px // 2
    edge = int(np.argmax(steps[:half]))
    if edge == 0 or steps[edge] < _STEEPNESS * np.median(steps[half:]):
        return probe
    taken_px = edge + 1
    mask = ndimage.distance_transform_edt(np.pad(probe.mask, 1, mode="edge"))[1:-1, 1:-1] > taken_px
    remark = f"the mask reaches about {taken_px} pixels beyond the object's edge and is trimmed"
    return replace(probe, mask=mask, usable=probe.usable & mask, remarks=(*probe.remarks, remark))
