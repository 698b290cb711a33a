"""The pattern of light that an object would cast, from the phase symmetry of its relief."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage
from skimage.transform import resize

from algorithms.caustics.settings import MAX_DIRECTIONS, check_sharpness, checked_directions
from algorithms.depth.inflation import bounding_box, checked_mask
from algorithms.errors import InputError
from algorithms.log_gabor import LogGaborBank
from algorithms.projection import Plane
from algorithms.symmetry import symmetry_by_angle, symmetry_energy

_SIDE_PX: Final = 512  # of a map's longer side: enough for its shortest wavelength
_SHORTEST_IN_SIDES: Final = 1 / 96
_SCALES: Final = 5
_GAP_IN_SIDES: Final = 1 / 8  # around the object, as the filters take a map for periodic
_SEARCH_SIDE_PX: Final = 96
_RIM_IN_SIDES: Final = 1 / 96
_SMOOTH_IN_SIDES: Final = 1 / 256  # symmetry knows no contrast: noise would make a pattern as well
_NOISE_DEVIATIONS: Final = 3.0
_BRIGHTEST: Final = 0.98  # of the pattern's points reach less than 1


def caustic_map(
    relief: NDArray[np.floating[Any]],
    mask: ArrayLike,
    directions: int | Sequence[int] = MAX_DIRECTIONS,
    *,
    sharpness: float = 3.0,
) -> Plane:
    """Return the pattern of light that an object would cast.

    Parameters
    ----------
    relief
        `(height, width)`, pixels, larger is nearer.
    mask
        bool `(height, width)`: where the object is.
    directions
        In how many directions symmetry is looked for, 1 to `MAX_DIRECTIONS`, beginning with that of
        most symmetry; of several numbers each makes a map.
    sharpness
        The power that the symmetry is raised to, more than 0.

    Returns
    -------
    float32 `(rows, columns)`, or `(n, rows, columns)` for several numbers of directions, 0..1, of
    the object's bounding box, 512 pixels along its longer side: the symmetry of the relief, 0 along
    the silhouette and outside, 1 where it is brightest (all 0 for a relief of 0).

    Raises
    ------
    InputError
        If a shape or a number is not accepted, or a value inside the mask is not finite.

    Notes
    -----
    Lopez-Moreno 2011, sec. 7.3.2: angular Gaussians whose interval is 1.2 of their standard
    deviations. The wavelengths grow with the object, so that its size in pixels does not matter.
    """
    inside = checked_mask(mask, np.shape(relief))
    counts = checked_directions(np.atleast_1d(np.asarray(directions)).tolist())
    check_sharpness(sharpness)
    box = bounding_box(inside)
    heights = np.where(inside[box], np.asarray(relief)[box], 0)
    if not np.isfinite(heights).all():
        raise InputError("relief: finite values are accepted")
    heights, within = _sized(heights, inside[box], _SIDE_PX)
    first_deg = direction_of_most_symmetry(heights, within)
    rim = _rim(within)
    maps = [
        _levelled(
            rim
            * _symmetry(
                heights, LogGaborBank(_SCALES, count, first_deg, _SIDE_PX * _SHORTEST_IN_SIDES)
            ),
            sharpness,
        )
        for count in counts
    ]
    return maps[0] if np.ndim(directions) == 0 else np.stack(maps)


def _rim(within: Plane) -> Plane:
    """Return 1 within the object, 0 at its silhouette, where a blurred mask is a half."""
    blurred = ndimage.gaussian_filter(within, _RIM_IN_SIDES * _SIDE_PX, mode="constant")
    return np.asarray(np.clip(2 * blurred - 1, 0, 1))


def _levelled(symmetry: Plane, sharpness: float) -> Plane:
    """Let all but the brightest of the pattern keep below 1."""
    if not symmetry.any():
        return symmetry
    brightest = np.quantile(symmetry[symmetry > 0], _BRIGHTEST)
    return np.asarray(np.minimum(symmetry / brightest, 1) ** np.float32(sharpness))


def _symmetry(heights: Plane, bank: LogGaborBank) -> Plane:
    gap = round(_GAP_IN_SIDES * _SIDE_PX)
    smooth = ndimage.gaussian_filter(np.pad(heights, gap), _SMOOTH_IN_SIDES * _SIDE_PX)
    return symmetry_energy(smooth, bank, _NOISE_DEVIATIONS).ratio()[gap:-gap, gap:-gap]


def direction_of_most_symmetry(heights: Plane, within: Plane) -> float:
    """Return the orientation with most energy of symmetry, degrees counter-clockwise from +x.

    Parameters
    ----------
    heights, within
        `(height, width)`: a relief, 0 outside of the object, and 1 within it.

    Notes
    -----
    All orientations are tried, a degree apart, with filters of middle size and breadth: what a
    direction is does not depend on how many are asked for.
    """
    small, inside = _sized(heights, within, _SEARCH_SIDE_PX)
    gap = round(_SEARCH_SIDE_PX * _GAP_IN_SIDES)
    bank = LogGaborBank(scales=3, orientations=6, shortest_px=_SEARCH_SIDE_PX / 16)
    energies = symmetry_by_angle(np.pad(small, gap), np.pad(inside, gap), bank, range(180))
    return float(np.argmax(energies))


def _sized(heights: Plane, within: NDArray[Any], side_px: int) -> tuple[Plane, Plane]:
    """Return heights and mask, both float32, with so many pixels along the longer side."""
    factor = side_px / max(heights.shape)
    shape = tuple(max(1, round(extent * factor)) for extent in heights.shape)
    shrinks = factor < 1
    sized = (
        resize(plane.astype(np.float32), shape, order=1, anti_aliasing=shrinks, mode="edge")
        for plane in (heights, within)
    )
    first, second = sized
    return first.astype(np.float32), second.astype(np.float32)
