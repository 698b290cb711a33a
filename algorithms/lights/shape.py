"""The shape an outline suggests: a smooth, convex body that meets its outline edge-on.

The square root of the solution of Poisson's equation inside an outline is a half ellipsoid where
the outline is an ellipse, and a half sphere where it is a circle; elsewhere it bulges where the
outline does. Its normals, on a coarse grid, stand for those of the unknown object.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage, sparse
from scipy.sparse.linalg import splu

from algorithms.errors import InputError
from algorithms.lights.probe import SMALLEST_PX, Probe

GRID: Final = 72
"""Cells along the longer side of the object."""

_COVERED: Final = 0.9
_INSIDE: Final = 0.5


@dataclass(frozen=True)
class Interior:
    """The object's shading on a coarse grid.

    Attributes
    ----------
    normals
        Unit vectors `(n, 3)` of the suggested shape, in the project's frame.
    positions
        `(n, 3)`, likewise, in radii of the object from its centre.
    luminance
        `(n,)`, means over cells.
    steepness_px
        Of the whole grid, `(rows, columns)`: how fast the squared height rises where it leaves the
        outline, twice the radius of a sphere; the nearest value inside where there is none.
    step_px
        The side of a cell.
    """

    normals: NDArray[np.float64]
    positions: NDArray[np.float64]
    luminance: NDArray[np.float64]
    steepness_px: NDArray[np.float64]
    step_px: float


def interior_of(probe: Probe, grid: int = GRID) -> Interior:
    """Return shading and suggested shape of an object's interior.

    Parameters
    ----------
    probe
        The object.
    grid
        Cells along its longer side.

    Raises
    ------
    InputError
        If too little of the object is usable.
    """
    step_px = max(1.0, max(probe.mask.shape) / grid)
    coverage, _ = _cell_means(probe.mask.astype(np.float64), np.ones_like(probe.luminance), step_px)
    luminance, usable = _cell_means(probe.luminance, probe.usable.astype(np.float64), step_px)
    inside = coverage > _INSIDE
    height = _inflated(inside, probe.at_border)
    normals = _normals(height)
    chosen = inside & (coverage > _COVERED) & (usable > _COVERED / 2)
    if chosen.sum() < SMALLEST_PX**2 / 4:
        raise InputError("image: too few pixels of the object are neither clipped nor at its edge")
    rows, columns = np.nonzero(chosen)
    radius = float(np.sqrt(inside.sum() / np.pi))
    centre = np.argwhere(inside).mean(axis=0)
    positions = np.stack([columns - centre[1], centre[0] - rows, np.sqrt(height[chosen])], axis=-1)
    return Interior(
        normals[chosen],
        positions / radius,
        luminance[chosen],
        _steepness(height) * step_px,
        step_px,
    )


def _cell_means(
    values: NDArray[np.float64], weights: NDArray[np.float64], step_px: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return weighted means over square cells, and the mean weights."""
    starts = [
        np.unique(np.floor(np.arange(0, extent, step_px)).astype(int)) for extent in values.shape
    ]

    def sums(field: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(
            np.add.reduceat(np.add.reduceat(field, starts[0], axis=0), starts[1], axis=1)
        )

    weight, area = sums(weights), sums(np.ones_like(values))
    return sums(values * weights) / np.maximum(weight, 1e-12), weight / area


def _inflated(
    inside: NDArray[np.bool_], at_border: tuple[bool, bool, bool, bool]
) -> NDArray[np.float64]:
    """Solve Poisson's equation: zero outside, even across the image's border."""
    top, bottom, left, right = at_border
    padding = ((int(not top), int(not bottom)), (int(not left), int(not right)))
    wide = np.pad(inside, padding)
    number = np.full(wide.shape, -1)
    number[wide] = np.arange(wide.sum())
    diagonal = np.zeros(wide.shape)
    pairs = []
    for first, second in (
        (np.s_[:, :-1], np.s_[:, 1:]),
        (np.s_[:-1, :], np.s_[1:, :]),
    ):
        diagonal[first] += 1
        diagonal[second] += 1
        both = wide[first] & wide[second]
        pairs.append((number[first][both], number[second][both]))
    rows, columns = (np.concatenate(parts) for parts in zip(*pairs, strict=True))
    links = sparse.coo_array((-np.ones(rows.size), (rows, columns)), shape=(wide.sum(),) * 2)
    system = (links + links.T + sparse.diags_array(diagonal[wide])).tocsc()
    factors = splu(system, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    height = np.zeros(wide.shape)
    # A half sphere's squared height, r^2 - x^2 - y^2, has the Laplacian -4.
    height[wide] = factors.solve(np.full(int(wide.sum()), 4.0))
    rows_kept, columns_kept = (
        slice(before, extent - after)
        for (before, after), extent in zip(padding, wide.shape, strict=True)
    )
    return np.maximum(height[rows_kept, columns_kept], 0)


def _normals(height: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the normals of the surface whose squared height is given."""
    down, across = np.gradient(height)
    normals = np.stack([-across / 2, down / 2, np.sqrt(height)], axis=-1)
    return np.asarray(normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12))


def _steepness(height: NDArray[np.float64]) -> NDArray[np.float64]:
    slope = np.hypot(*np.gradient(height))
    nearest = ndimage.distance_transform_edt(
        height <= 0, return_distances=False, return_indices=True
    )
    return np.asarray(slope[tuple(nearest)])
