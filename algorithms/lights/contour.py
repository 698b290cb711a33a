"""The outline of an object: where it is, its normals, and the luminance along it.

A surface turns edge-on at its outline, so that its normals there lie in the image plane and are
known (occluding contours, Horn 1986). Pixels that share a normal stand as one, by their median, so
that straight parts do not rule (Lopez-Moreno 2011, sec. 3.6.1 and fig. 3.2).
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage
from skimage.measure import find_contours

from algorithms.errors import InputError
from algorithms.lights.probe import Probe
from algorithms.lights.shape import Interior

BINS: Final = 72
"""Directions that are told apart, 5 degrees each."""

_DEPTH_PX: Final = 2.0  # a bilinear sample there touches no pixel that holds background
_DEPTH_IN_RADII: Final = 0.02
_SMOOTHING_PX: Final = 2.0
_SMOOTHING_IN_LENGTHS: Final = 0.006
_FEWEST_BINS: Final = 12


@dataclass(frozen=True)
class Silhouette:
    """A closed outline at steps of about a pixel.

    Attributes
    ----------
    points_px
        `(n, 2)`, rows and columns from the centre of the first pixel.
    normals
        Outward unit vectors `(n, 2)` in the image plane, x right and y up.
    length_px
        Around the object.
    """

    points_px: NDArray[np.float64]
    normals: NDArray[np.float64]
    length_px: float


@dataclass(frozen=True)
class Contour:
    """Luminance along an outline, by the direction of its normal.

    Attributes
    ----------
    azimuth_deg
        `(n,)`, -180..180, rising.
    luminance
        `(n,)`: the median where the outline has that normal.
    tilt
        `(n,)`: how far the normals lean to the viewer where the luminance was sampled, a little
        inside the outline; their z component.
    """

    azimuth_deg: NDArray[np.float64]
    luminance: NDArray[np.float64]
    tilt: NDArray[np.float64]

    @property
    def normals(self) -> NDArray[np.float64]:
        """Unit vectors `(n, 3)` where the luminance was sampled."""
        azimuth, level = np.radians(self.azimuth_deg), np.sqrt(1 - self.tilt**2)
        return np.stack([level * np.cos(azimuth), level * np.sin(azimuth), self.tilt], axis=-1)


def silhouette(mask: NDArray[np.bool_]) -> Silhouette:
    """Return the outer outline of an object at sub-pixel accuracy.

    Parameters
    ----------
    mask
        bool `(height, width)`, one component.

    Notes
    -----
    The outline runs between pixels in steps; smoothed along its length by two pixels or 0.6 %
    of it, it loses the steps and the finest bumps.
    """
    outlines = find_contours(np.pad(mask, 1).astype(np.float64), 0.5)
    steps = max(outlines, key=len) - 1
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(steps, axis=0), axis=1))])
    length_px = float(along[-1])
    places = np.linspace(0, length_px, int(length_px), endpoint=False)
    points = np.stack([np.interp(places, along, values) for values in steps.T], axis=-1)
    sigma = max(_SMOOTHING_PX, _SMOOTHING_IN_LENGTHS * length_px)
    points = ndimage.gaussian_filter1d(points, sigma, axis=0, mode="wrap")
    down, right = ((np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)) / 2).T
    normals = np.stack([-down, -right], axis=-1)
    rows, columns = points.T
    if float(np.sum(rows * right - columns * down)) < 0:  # it runs clockwise
        normals = -normals
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Silhouette(points, normals, length_px)


def contour_of(probe: Probe, interior: Interior, bins: int = BINS) -> Contour:
    """Sample the luminance just inside an object's outline.

    Parameters
    ----------
    probe
        The object.
    interior
        Its suggested shape.
    bins
        Directions that are told apart, over the full circle.

    Raises
    ------
    InputError
        If too little of the outline is usable.
    """
    outline = silhouette(probe.mask)
    radius_px = 2 * float(probe.mask.sum()) / outline.length_px
    depth_px = max(_DEPTH_PX, _DEPTH_IN_RADII * radius_px)
    inwards = np.stack([outline.normals[:, 1], -outline.normals[:, 0]], axis=-1)
    samples = (outline.points_px + depth_px * inwards).T
    luminance, usable = (
        ndimage.map_coordinates(field.astype(np.float64), samples, order=1)
        for field in (probe.luminance, probe.usable)
    )
    kept = (usable > 1 - 1e-9) & ~_on_border(outline.points_px, probe)
    tilt = _tilt(outline.points_px + max(depth_px, interior.step_px) * inwards, depth_px, interior)
    contour = _by_normal(outline.normals[kept], luminance[kept], tilt[kept], bins)
    if contour.azimuth_deg.size < _FEWEST_BINS:
        raise InputError(
            "mask: its outline is cut off, clipped or too straight; one whose normals point in "
            f"{_FEWEST_BINS} of {bins} directions at least is accepted"
        )
    return contour


def _tilt(
    points_px: NDArray[np.float64], depth_px: float, interior: Interior
) -> NDArray[np.float64]:
    """Return the z component of the normals a little inside the outline, by the suggested shape.

    Its squared height h rises from 0 with slope g, so that at depth d the normal is
    ``(g / 2, sqrt(g d))`` but for its length.
    """
    cells = ((points_px + 0.5) / interior.step_px - 0.5).T
    slope = ndimage.map_coordinates(interior.steepness_px, cells, order=1, mode="nearest")
    return np.asarray(np.sqrt(depth_px / (depth_px + np.maximum(slope, 1e-6) / 4)))


def _on_border(points_px: NDArray[np.float64], probe: Probe) -> NDArray[np.bool_]:
    """Tell where an outline runs along the image's border, which is none of the object's."""
    rows, columns = points_px.T
    height, width = probe.mask.shape
    near = 3.0
    ends = (rows < near, rows > height - 1 - near, columns < near, columns > width - 1 - near)
    cut = np.zeros(rows.shape, dtype=bool)
    for end, at_border in zip(ends, probe.at_border, strict=True):
        if at_border:
            cut |= end
    return cut


def _by_normal(
    normals: NDArray[np.float64],
    luminance: NDArray[np.float64],
    tilt: NDArray[np.float64],
    bins: int,
) -> Contour:
    """Return mean direction and medians of the bins that hold a sample."""
    azimuth = np.arctan2(normals[:, 1], normals[:, 0])
    number = np.floor((azimuth + np.pi) / (2 * np.pi) * bins).astype(int) % bins
    order = np.argsort(number, kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(number[order])) + 1)
    groups = [group for group in groups if group.size]
    means = np.array([normals[group].mean(axis=0) for group in groups]).reshape(-1, 2)
    luminance, tilt = (
        np.array([np.median(values[group]) for group in groups]) for values in (luminance, tilt)
    )
    return Contour(np.degrees(np.arctan2(means[:, 1], means[:, 0])), luminance, tilt)
