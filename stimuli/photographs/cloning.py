"""Seamless cloning: an object taken from one photograph, put into another of the same scene.

Where the photographs differ around the object, their difference is carried inwards as a smooth
membrane that dies out, so that neither the rim shows nor the object's shading is changed.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from algorithms.color import FloatImage, encode_srgb, luminance
from algorithms.errors import InputError

_CORE_OF_MARGIN: Final = 0.25  # masks may be a little too small, and edges are soft
_NEIGHBOURS: Final = ((0, 1), (0, -1), (1, 0), (-1, 0))


@dataclass(frozen=True)
class Cloned:
    """A composite, and what cloning did.

    Attributes
    ----------
    image
        float32 `(height, width, 3)`: the target outside `region`.
    region
        bool `(height, width)`: where the composite may differ from the target.
    correction
        float64 `(height, width, 3)`: what was added to the source, 0 outside `region`.
    """

    image: FloatImage
    region: NDArray[np.bool_]
    correction: NDArray[np.float64]


def clone(
    target: FloatImage,
    source: FloatImage,
    mask: NDArray[np.bool_],
    *,
    margin_px: float,
    reach_px: float = np.inf,
    protected: NDArray[np.bool_] | None = None,
) -> Cloned:
    """Put an object from one photograph into another of the same scene, without a seam.

    Parameters
    ----------
    target, source
        Linear light `(height, width, 3)`, aligned.
    mask
        bool `(height, width)`: the object, clear of the image's border.
    margin_px
        Width of the band around the mask, 1 or more; its inner quarter is the source's alone, in
        the rest one photograph goes over into the other.
    reach_px
        How far the correction carries, more than 0; infinite for the plain Poisson equation.
    protected
        Where the target must stay, such as other objects; None for nowhere.

    Raises
    ------
    InputError
        If sizes differ, the mask is empty or touches the border, or a number is out of range.

    Notes
    -----
    The source plus a correction u solves the screened Poisson equation with the source's gradients
    and the target's values around the region: u = target - source there and laplace(u) =
    u / reach^2 within (Perez et al. 2003, *Poisson image editing*, eq. 5, where the reach is
    infinite; Bhat et al. 2008, *Fourier analysis of the 2D screened Poisson equation*, eq. 3). It
    is blended with the target by an alpha that is 1 on the mask and the band's inner quarter, 0
    around the region and harmonic between (after Lopez-Moreno 2011, sec. 2.5, Poisson-based alpha
    matting).
    """
    _check(target, source, mask, margin_px, reach_px)
    region = _region(mask, margin_px, protected)
    rows, columns = (slice(places.min() - 1, places.max() + 2) for places in np.nonzero(region))
    box = (rows, columns)
    gap = target[box].astype(np.float64) - source[box]
    correction = _membrane(gap, region[box], reach_px)
    core = region & (_distance_px(mask) <= _CORE_OF_MARGIN * margin_px)
    alpha = _membrane(
        core[box][..., None].astype(np.float64), region[box] & ~core[box], reach_px=np.inf
    )
    image, full = target.copy(), np.zeros(target.shape)
    inside = region[box][..., None]
    blended = target[box] + alpha * (correction - gap)
    image[box] = np.where(inside, blended, target[box])
    full[box] = np.where(inside, correction, 0)
    return Cloned(image, region, full)


def seam_of_255(
    composite: FloatImage,
    target: FloatImage,
    source: FloatImage,
    region: NDArray[np.bool_],
) -> float:
    """Return how strong the strongest edge of a composite is that neither photograph has.

    Parameters
    ----------
    composite, target, source
        Linear light `(height, width, 3)`, display-referred.
    region
        Where the composite was changed; edges within it and across its border count.

    Returns
    -------
    The 99.9th percentile over neighbouring pixels, in sRGB-encoded steps of luminance of 255.
    """
    shown, *given = (encode_srgb(luminance(image)) for image in (composite, target, source))
    extra = []
    for axis in (0, 1):
        steps = np.diff(shown, axis=axis)
        excess = [np.abs(steps - np.diff(image, axis=axis)) for image in given]
        near = np.delete(region, -1, axis) | np.delete(region, 0, axis)
        extra.append(np.minimum(*excess)[near])
    return float(255 * np.quantile(np.concatenate(extra), 0.999))


def _check(
    target: FloatImage, source: FloatImage, mask: NDArray[np.bool_], margin: float, reach: float
) -> None:
    if target.shape != source.shape or target.shape[:2] != mask.shape:
        raise InputError(
            f"source, mask: the target's size {target.shape[:2]} is accepted, not "
            f"{source.shape[:2]}, {mask.shape}"
        )
    if not mask.any():
        raise InputError("mask: one pixel or more is accepted; it is empty")
    if mask[[0, -1]].any() or mask[:, [0, -1]].any():
        raise InputError("mask: an object clear of the image's border is accepted")
    if not margin >= 1:
        raise InputError(f"margin_px: 1 or more is accepted, not {margin}")
    if not reach > 0:
        raise InputError(f"reach_px: more than 0 is accepted, not {reach}")


def _region(
    mask: NDArray[np.bool_], margin_px: float, protected: NDArray[np.bool_] | None
) -> NDArray[np.bool_]:
    region = _distance_px(mask) <= margin_px
    if protected is not None:
        region &= ~protected | mask
    # The border stays, for the equation needs values all around.
    region[[0, -1]] = False
    region[:, [0, -1]] = False
    return region


def _distance_px(mask: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Return how far each pixel is from the mask."""
    return np.asarray(distance_transform_edt(~mask))


def _membrane(
    values: NDArray[np.float64], unknown: NDArray[np.bool_], reach_px: float
) -> NDArray[np.float64]:
    """Return values `(height, width, channels)` with laplace(u) = u / reach^2 where unknown."""
    count = int(unknown.sum())
    result = values.copy()
    if not count:
        return result
    number = np.full(unknown.shape, -1)
    number[unknown] = np.arange(count)
    known = np.where(unknown[..., None], 0, values)
    pairs, right = [], np.zeros((count, values.shape[2]))
    for shift in _NEIGHBOURS:
        neighbour = np.roll(number, shift, axis=(0, 1))[unknown]
        inside = neighbour >= 0
        pairs.append(np.stack([np.flatnonzero(inside), neighbour[inside]]))
        right += np.roll(known, shift, axis=(0, 1))[unknown]
    rows, columns = np.concatenate(pairs, axis=1)
    rows, columns = np.append(rows, np.arange(count)), np.append(columns, np.arange(count))
    entries = np.full(len(rows), -1.0)
    entries[-count:] = len(_NEIGHBOURS) + 1 / reach_px**2
    matrix = csc_array((entries, (rows, columns)), shape=(count, count))
    result[unknown] = splu(matrix, permc_spec="MMD_AT_PLUS_A").solve(right)
    return result
