"""Perceptual relief: a plausible shape from one picture of an object and its mask.

People take dark for deep and objects for globally convex (Langer and Bülthoff 2000). The luminance
is split into a base layer, the large features, and a detail layer (Bae et al. 2006); the base is
reshaped so that the object bulges and meets its silhouette at zero (Khan et al. 2006). The result
is wrong in ways that nobody sees from where the picture was taken (the bas-relief ambiguity).
"""

from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.color import luminance
from algorithms.depth.body import slope_within
from algorithms.depth.inflation import bounding_box, checked_mask, silhouette_relief
from algorithms.depth.poisson import Mask, Plane
from algorithms.errors import InputError
from algorithms.filters import bilateral

_SHADING: Final = 0.5
_SPACE_IN_SIDES: Final = 1 / 16
_SMALLEST_SPACE_PX: Final = 2.0
_GRADIENT_PERCENTILE: Final = 90
_SMALLEST_RANGE: Final = 1 / 256
_RESPONSE_EXPONENT: Final = 0.73
_DARKEST: Final = 1e-6


def perceptual_relief(
    image: NDArray[np.floating[Any]],
    mask: ArrayLike,
    *,
    base_weight: float = 1.0,
    detail_weight: float = 0.3,
    inflation: float = 1.0,
    shading: float = _SHADING,
) -> Plane:
    """Estimate the relief of an object that people find plausible.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)` or luminance alone `(height, width)`, finite, 0 or more;
        of any exposure.
    mask
        bool `(height, width)`: where the object is.
    base_weight, detail_weight
        F_b and F_d, 0..1: how much large and small features count.
    inflation
        How much of the base comes from the silhouette, 0 or more; 0 leaves the luminance alone,
        which still meets the silhouette at zero.
    shading
        How much of the base comes from the luminance, 0 or more; 1 lets black and white differ by
        the height of the inflated silhouette.

    Returns
    -------
    float32 `(height, width)`, pixels, larger is nearer, 0 outside. A disc without shading becomes
    half a sphere.

    Raises
    ------
    InputError
        If a shape or a value is not as described.

    Notes
    -----
    Lopez-Moreno 2011, eq. 4.1 and 8.1, weights of sec. 8.7. The bilateral filter has Bae et al.'s
    sizes: a sixteenth of the object's shorter side (the print drops the 16), and the 90th
    percentile of the gradient. Luminance counts as the eye responds to it (Khan et al. 2006), so
    that exposure does not matter and high dynamic range is allowed. What slopes over the whole
    object is taken for the light's direction, and left out of the base.
    """
    inside = checked_mask(mask, np.shape(image)[:2])
    for name, value in (("base_weight", base_weight), ("detail_weight", detail_weight)):
        if not 0 <= value <= 1:
            raise InputError(f"{name}: 0..1 is accepted, not {value}")
    for name, value in (("inflation", inflation), ("shading", shading)):
        if not 0 <= value < np.inf:
            raise InputError(f"{name}: a finite number of 0 or more is accepted, not {value}")
    box = bounding_box(inside)
    response = _response(_luminance(image)[box], inside[box])
    base, detail = _layers(response, inside[box])
    relief = silhouette_relief(inside)
    height_px = float(relief.max())
    bulge = relief[box] / height_px
    # Convex, zero at the silhouette, and level where the object is highest.
    reach = bulge * (2 - bulge)
    shaped = inflation * bulge + shading * reach * _levelled(base, inside[box])
    relief[box] = height_px * (base_weight * shaped + detail_weight * reach * detail)
    return relief


def _luminance(image: NDArray[np.floating[Any]]) -> Plane:
    pixels = np.asarray(image)
    if pixels.ndim != 2 and (pixels.ndim != 3 or pixels.shape[2] != 3):
        raise InputError(f"image: (height, width, 3) is accepted, not {pixels.shape}")
    values = (pixels if pixels.ndim == 2 else luminance(pixels)).astype(np.float32)
    if not np.isfinite(values).all() or values.min() < 0:
        raise InputError("image: finite values of 0 or more are accepted")
    return values


def _response(values: Plane, inside: Mask) -> Plane:
    """Return the eye's response to luminance, 0..1; 0.5 at the object's geometric mean."""
    mean = np.exp(np.log(np.maximum(values[inside], _DARKEST), dtype=np.float64).mean())
    power = (values / np.float32(mean)) ** np.float32(_RESPONSE_EXPONENT)
    return np.where(inside, power / (power + 1), 0)


def _layers(response: Plane, inside: Mask) -> tuple[Plane, Plane]:
    """Split into base and detail; both are 0 outside."""
    slopes = slope_within(response, inside), slope_within(response.T, inside.T).T
    gradient = np.hypot(*slopes)[inside]
    sigma_range = max(float(np.percentile(gradient, _GRADIENT_PERCENTILE)), _SMALLEST_RANGE)
    sigma_px = max(min(response.shape) * _SPACE_IN_SIDES, _SMALLEST_SPACE_PX)
    base = bilateral(response, sigma_px, sigma_range, mask=inside)
    return base, response - base


def _levelled(base: Plane, inside: Mask) -> Plane:
    """Subtract the plane that fits best, 0 outside."""
    rows, columns = (np.arange(extent, dtype=np.float64) / extent - 0.5 for extent in base.shape)
    weight = inside.astype(np.float64)
    monomials = ((0, 0), (1, 0), (0, 1))

    def moment(plane: NDArray[np.floating[Any]], down: int, across: int) -> float:
        return float((rows**down) @ plane @ (columns**across))

    system = np.array([[moment(weight, a + c, b + d) for c, d in monomials] for a, b in monomials])
    target = [moment(base, a, b) for a, b in monomials]
    level, down, across = np.linalg.lstsq(system, target, rcond=None)[0]
    plane = level + down * rows[:, None] + across * columns
    return np.where(inside, base - plane, 0).astype(np.float32)
