"""Lathe objects: a profile revolved around the y axis."""

from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d, label

from algorithms.errors import InputError
from stimuli.shapes.displaced_spheres import check_complexity
from stimuli.shapes.mesh import Mesh, grid_mesh

_FINE: Final = 4096
_COSINES: Final = 6
_LARGEST_SWELL: Final = 0.6
_SLENDERNESS: Final = (0.45, 0.65)


def lathe(profile: ArrayLike, rows: int = 256, columns: int = 256) -> Mesh:
    """Return the closed surface of a profile that is revolved around the y axis.

    Parameters
    ----------
    profile
        `(k, 2)`: radius and height of three or more control points, in order from the axis above
        the body to the axis below it, or the other way; the surface passes smoothly through them.
    rows, columns
        Quadrilaterals along the profile, closer where it turns, and around the axis.

    Returns
    -------
    The mesh in the profile's unit; `Mesh.fitted` brings it to radius 1.

    Raises
    ------
    InputError
        If the ends are not on the axis, a radius between them is not above 0, or the curve crosses
        itself.
    """
    controls = _checked(np.asarray(profile, dtype=np.float64))
    curve = _through(controls)
    half = curve.x[-1] / 2
    fine = np.linspace(0, half, _FINE + 1)
    if (curve(fine)[1:-1, 0] <= 0).any() or _crosses_itself(curve(np.linspace(0, half, 513))):
        raise InputError("profile: a curve that crosses neither itself nor the axis is accepted")
    place = _evenly(curve, fine, rows)
    points, tangents = curve(place), curve(place, 1)
    points[[0, -1], 0] = 0
    outward = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
    outward[[0, -1], 0] = 0
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    return grid_mesh(_revolved(points, columns), _revolved(outward, columns))


def lathe_from_silhouette(
    mask: NDArray[np.bool_], smoothing_px: float | None = None, rows: int = 256, columns: int = 256
) -> Mesh:
    """Return an object's silhouette revolved around an upright axis.

    Parameters
    ----------
    mask
        `(height, width)`: where the object is seen; one region, at least 4 pixels wide and high.
    smoothing_px
        Standard deviation of the smoothing along the outline, that pixels do not become rings;
        None for a hundredth of the outline's length.
    rows, columns
        As of `lathe`.

    Returns
    -------
    The closed mesh in pixels from the image's centre, x right and y up, so that it is seen where
    the silhouette is. Its radius in each row is half the distance between the silhouette's
    outermost edges there; its axis is their mean middle.

    Raises
    ------
    InputError
        If the mask is empty, too small, not boolean or in several pieces.

    Notes
    -----
    The simple alternative to caustics from shading (Lopez-Moreno 2011, sec. 7.5.1), which takes
    objects for globally convex.
    """
    _check_mask(mask)
    rows_px = np.flatnonzero(mask.any(axis=1))
    part = mask[rows_px]
    left, right = part.argmax(axis=1), mask.shape[1] - part[:, ::-1].argmax(axis=1)
    widths = right - left
    axis_px = np.average((left + right) / 2, weights=widths) - mask.shape[1] / 2
    heights = mask.shape[0] / 2 - rows_px - 0.5
    profile = np.column_stack([widths / 2, heights])
    ends = np.array([[0, heights[0] + 0.5], [0, heights[-1] - 0.5]])
    smooth = _smoothed(np.vstack([ends[:1], profile, ends[1:]]), smoothing_px)
    return lathe(smooth, rows, columns).moved(np.array([axis_px, 0.0, 0.0]))


def random_lathe(generator: np.random.Generator, complexity: float) -> Mesh:
    """Return a turned body, of radius 1 around the origin: from an egg to a baluster.

    Parameters
    ----------
    generator
        Draws the profile's bulges; the same for every complexity.
    complexity
        0..1: how far they stand out. 0 is an ellipsoid; the bending energy
        (`stimuli.shapes.curvature`) grows with it.

    Raises
    ------
    InputError
        If the complexity is outside 0..1.
    """
    check_complexity(complexity)
    orders = np.arange(3, _COSINES + 3)
    weights = generator.normal(size=_COSINES) / np.sqrt(orders)
    slenderness = generator.uniform(*_SLENDERNESS)
    polar = np.linspace(0, np.pi, 97)
    bulges = np.cos(polar[:, None] * orders) @ weights
    swell = np.exp(complexity * _LARGEST_SWELL * bulges / np.abs(bulges).max())
    profile = np.column_stack([slenderness * swell * np.sin(polar), np.cos(polar)])
    profile[[0, -1], 0] = 0
    return lathe(profile).fitted()


def _checked(controls: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the control points from above to below, as seen from outside."""
    if controls.ndim != 2 or controls.shape[1] != 2 or len(controls) < 3:
        raise InputError(f"profile: three or more points (k, 2) are accepted, not {controls.shape}")
    radii = controls[:, 0]
    if not np.isfinite(controls).all() or radii[[0, -1]].any() or (radii[1:-1] <= 0).any():
        raise InputError("profile: radii above 0 between two ends on the axis are accepted")
    if (np.linalg.norm(np.diff(controls, axis=0), axis=1) == 0).any():
        raise InputError("profile: points that differ from the next are accepted")
    squares = radii**2
    downward = -((squares[1:] + squares[:-1]) * np.diff(controls[:, 1])).sum()
    return controls if downward > 0 else controls[::-1]


def _through(controls: NDArray[np.float64]) -> CubicSpline[Any]:
    """Return the curve through the points and, back on the other side, through their images.

    Since it is closed and symmetric it meets the axis at right angles, and its curvature is
    continuous there too: no dents at the poles.
    """
    back = controls[-2::-1] * [-1, 1]
    ring = np.vstack([controls, back])
    # Centripetal: no loops where a long span follows a short one (Lee 1989).
    steps = np.linalg.norm(np.diff(ring, axis=0), axis=1) ** 0.5
    return CubicSpline(np.concatenate([[0], steps.cumsum()]), ring, bc_type="periodic")


def _evenly(curve: CubicSpline[Any], fine: NDArray[np.float64], rows: int) -> NDArray[np.float64]:
    """Return places along the curve that divide its length and its turning evenly."""
    tangents = curve(fine, 1)
    lengths = np.linalg.norm(np.diff(curve(fine), axis=0), axis=1)
    turns = np.abs(np.diff(np.unwrap(np.arctan2(tangents[:, 1], tangents[:, 0]))))
    share = np.concatenate([[0], (lengths / lengths.sum() + turns / turns.sum()).cumsum()])
    return np.interp(np.linspace(0, share[-1], rows + 1), share, fine)


def _crosses_itself(points: NDArray[np.float64]) -> bool:
    start, way = points[:-1], np.diff(points, axis=0)
    apart = start[None] - start[:, None]
    cross = way[:, None, 0] * way[None, :, 1] - way[:, None, 1] * way[None, :, 0]
    safe = np.where(cross == 0, np.inf, cross)
    first = (apart[..., 0] * way[None, :, 1] - apart[..., 1] * way[None, :, 0]) / safe
    second = (apart[..., 0] * way[:, None, 1] - apart[..., 1] * way[:, None, 0]) / safe
    meet = (first > 0) & (first < 1) & (second > 0) & (second < 1)
    return bool(np.triu(meet, 2).any())


def _revolved(points: NDArray[np.float64], columns: int) -> NDArray[np.float64]:
    longitude = np.linspace(0, 2 * np.pi, columns + 1)
    longitude[-1] = 0
    radii, heights = points[:, :1], points[:, 1:]
    x, z = radii * np.sin(longitude), radii * np.cos(longitude)
    return np.stack([x, np.broadcast_to(heights, x.shape), z], axis=-1)


def _check_mask(mask: NDArray[np.bool_]) -> None:
    if mask.ndim != 2 or mask.dtype != np.bool_:
        raise InputError(f"mask: bool (height, width) is accepted, not {mask.dtype}")
    if min(mask.any(axis=0).sum(), mask.any(axis=1).sum()) < 4:
        raise InputError("mask: an object of at least 4 x 4 pixels is accepted")
    if label(mask, structure=np.ones((3, 3)))[1] > 1:
        raise InputError("mask: an object in one piece is accepted")


def _smoothed(profile: NDArray[np.float64], smoothing_px: float | None) -> NDArray[np.float64]:
    ring = np.vstack([profile, profile[-2::-1] * [-1, 1]])
    lengths = np.linalg.norm(np.diff(ring, axis=0), axis=1)
    way = np.concatenate([[0], lengths.cumsum()])
    count = 2 * int(np.clip(way[-1], 64, 2048) / 2)
    even = np.linspace(0, way[-1], count, endpoint=False)
    points = np.column_stack([np.interp(even, way, column) for column in ring.T])
    sigma = (way[-1] / 100 if smoothing_px is None else smoothing_px) * count / way[-1]
    half = gaussian_filter1d(points, sigma, axis=0, mode="wrap")[: count // 2 + 1]
    half[[0, -1], 0] = 0
    return np.asarray(half)
