"""Whether photographs under different lights are alike in everything else.

A light that moves changes shading, shadows and highlights, so that what is compared here is what
it leaves alone: where edges are, and how bright the surfaces are that face it.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from skimage.filters import scharr, window
from skimage.registration import phase_cross_correlation

from algorithms.color import FloatImage, encode_srgb, luminance
from algorithms.errors import InputError

CLIPPED_LIMIT: Final = 0.001
"""The share of a photograph's pixels that may be at the top of the scale."""

_EDGE_SCALE_PX: Final = 2.0
_SHIFT_STEPS: Final = 20
_FACING_QUANTILE: Final = 0.98
_DARK_SHARE: Final = 0.01


def shift_px(first: FloatImage, second: FloatImage) -> float:
    """Return how far one photograph is out of line with another, in pixels.

    Parameters
    ----------
    first, second
        Linear light `(height, width, 3)`, display-referred, of one size.

    Returns
    -------
    The length of the displacement. For lights up to 50 degrees apart it is good to 0.3 pixels;
    turning and zooming are seen only as far as they move the picture as a whole.

    Notes
    -----
    Phase correlation of gradient magnitudes (Kuglin and Hines 1975; Guizar-Sicairos et al. 2008 for
    parts of a pixel): the sign and the strength of edges change with the light, their places
    hardly. Smoothing keeps the sensor's fixed pattern, which does not move, from being found.
    """
    edges = []
    for image in (first, second):
        smooth = gaussian_filter(encode_srgb(luminance(image)), _EDGE_SCALE_PX)
        magnitude = scharr(smooth)
        edges.append((magnitude - magnitude.mean()) * window("hann", magnitude.shape))
    shift, *_ = phase_cross_correlation(*edges, upsample_factor=_SHIFT_STEPS)
    return float(np.hypot(*shift))


def exposure_stops(
    first: FloatImage, second: FloatImage, masks: Sequence[NDArray[np.bool_]]
) -> float:
    """Return by how many stops the exposures of two photographs seem to differ.

    Parameters
    ----------
    first, second
        Linear light `(height, width, 3)`.
    masks
        bool `(height, width)`: where each of the scene's objects is, one or more.

    Returns
    -------
    The largest difference among the three channels, 0 or more.

    Notes
    -----
    Compared is the light of the surfaces that face the lamp: the 98th percentile over each object,
    and among the objects the median. Of a Lambertian sphere it changes by less than 0.2 stops while
    the light goes from the camera to 90 degrees from it, where the mean changes by 1.7 stops; the
    median of eight objects of all kinds changed by 0.13 stops at most over 140 degrees.
    """
    levels = np.array(
        [
            [np.quantile(image[mask], _FACING_QUANTILE, axis=0) for mask in masks]
            for image in (first, second)
        ],
        dtype=np.float64,
    )
    # A channel that is dark in all objects tells nothing.
    floor = _DARK_SHARE * levels.max()
    if floor == 0:
        return 0.0
    one, other = np.log2(np.maximum(levels, floor))
    return float(np.abs(np.median(one - other, axis=0)).max())


def check_alike(
    name: str,
    photograph: FloatImage,
    reference: FloatImage,
    masks: Sequence[NDArray[np.bool_]],
    *,
    max_shift_px: float,
    max_exposure_stops: float,
) -> dict[str, float]:
    """Check one photograph against the reference and return what was measured.

    Parameters
    ----------
    name
        What the messages call the photograph.
    photograph, reference
        Linear light `(height, width, 3)`.
    masks
        bool `(height, width)`: where each of the scene's objects is.
    max_shift_px, max_exposure_stops
        What is accepted.

    Returns
    -------
    `shift_px` and `exposure_stops`.

    Raises
    ------
    InputError
        If the photographs are out of line or not equally exposed.
    """
    stops = exposure_stops(photograph, reference, masks)
    if stops > max_exposure_stops:
        raise InputError(
            f"{name}: its exposure or white balance differs from the reference's by {stops:.2f}"
            f" stops; at most {max_exposure_stops:g} are accepted (max_exposure_stops)"
        )
    shift = shift_px(photograph, reference)
    if shift > max_shift_px:
        raise InputError(
            f"{name}: out of line with the reference by {shift:.1f} pixels; at most"
            f" {max_shift_px:g} are accepted (max_shift_px)"
        )
    return {"shift_px": round(shift, 3), "exposure_stops": round(stops, 3)}


def check_clipping(name: str, photograph: FloatImage) -> None:
    """Raise InputError if a display-referred photograph has too many pixels at the top."""
    share = float((photograph >= 1).any(axis=-1).mean())
    if share > CLIPPED_LIMIT:
        raise InputError(
            f"{name}: {share:.2%} of its pixels are overexposed; at most {CLIPPED_LIMIT:.1%} are"
            " accepted"
        )
