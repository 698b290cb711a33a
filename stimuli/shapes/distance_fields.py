"""Limbs, ellipsoids and rings as distances: what implicit shapes are put together from."""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from stimuli.shapes.implicit import Field

_SAMPLES_A_SPAN: Final = 8
_NEWTON_STEPS: Final = 2
_CHUNK: Final = 1 << 13


def capsule(start: ArrayLike, end: ArrayLike, radius: float) -> Field:
    """Return a straight limb with round ends, from `start` to `end` `(3,)`."""
    origin, way = np.asarray(start, dtype=float), np.subtract(end, start).astype(float)
    square = float(way @ way)

    def field(points: NDArray[np.float64]) -> NDArray[np.float64]:
        offset = points - origin
        share = np.clip(offset @ way / square, 0, 1)
        return np.asarray(np.linalg.norm(offset - share[..., None] * way, axis=-1) - radius)

    return field


def ellipsoid(
    centre: ArrayLike, axes: ArrayLike, rotation: NDArray[np.float64] | None = None
) -> Field:
    """Return an ellipsoid by its half axes `(3,)` along the columns of a rotation matrix."""
    middle, lengths = np.asarray(centre, dtype=float), np.asarray(axes, dtype=float)
    frame = np.eye(3) if rotation is None else rotation

    def field(points: NDArray[np.float64]) -> NDArray[np.float64]:
        offset = (points - middle) @ frame
        level = np.linalg.norm(offset / lengths, axis=-1)
        slope = np.linalg.norm(offset / lengths**2, axis=-1)
        # The distance to first order: exact on the surface, the smallest axis in the centre.
        return np.asarray(
            np.where(slope > 0, level * (level - 1) / np.where(slope > 0, slope, 1), -lengths.min())
        )

    return field


def tube(points: ArrayLike, radii: ArrayLike, closed: bool = False) -> Field:
    """Return a limb along a smooth curve.

    Parameters
    ----------
    points, radii
        `(k, 3)` and `(k,)`: the curve's control points, which it passes through, and its radius at
        each; for a closed curve the last differs from the first, which follows it.
    closed
        Whether the curve is a ring; else its ends are round.
    """
    controls = np.column_stack([points, radii])
    if closed:
        controls = np.vstack([controls, controls[:1]])
    chords = np.linalg.norm(np.diff(controls[:, :3], axis=0), axis=1)
    knots = np.concatenate([[0], chords.cumsum()])
    # The radius ends level, or the limb would have a crease where its round end begins.
    ends = (controls[1] - controls[0]) / chords[0], (controls[-1] - controls[-2]) / chords[-1]
    level = np.array([1.0, 1.0, 1.0, 0.0])
    curve = CubicSpline(
        knots,
        controls,
        bc_type="periodic" if closed else ((1, ends[0] * level), (1, ends[1] * level)),
    )
    places = np.linspace(0, knots[-1], _SAMPLES_A_SPAN * len(chords) + 1)
    samples = curve(places)[:, :3]
    squares = np.einsum("ij,ij->i", samples, samples)

    def chunk(offsets: NDArray[np.float64]) -> NDArray[np.float64]:
        # Three columns are too few for a matrix product to pay.
        products = sum(offsets[:, i, None] * samples[:, i] for i in range(3))
        place = places[(squares - 2 * products).argmin(axis=1)]
        for _ in range(_NEWTON_STEPS):
            gap = offsets - curve(place)[:, :3]
            first, second = curve(place, 1)[:, :3], curve(place, 2)[:, :3]
            slope = np.einsum("ij,ij->i", gap, first)
            bend = np.einsum("ij,ij->i", first, first) - np.einsum("ij,ij->i", gap, second)
            # Beyond the curve's centre of curvature there is no nearest place to be found.
            step = np.where(bend > 0, slope / np.where(bend > 0, bend, 1), 0)
            place = place + np.clip(step, -places[1], places[1])
            place = place % knots[-1] if closed else np.clip(place, 0, knots[-1])
        nearest = curve(place)
        gap = offsets - nearest[:, :3]
        return np.asarray(np.sqrt(np.einsum("ij,ij->i", gap, gap)) - nearest[:, 3])

    def field(positions: NDArray[np.float64]) -> NDArray[np.float64]:
        flat = positions.reshape(-1, 3)
        parts = [chunk(flat[i : i + _CHUNK]) for i in range(0, len(flat), _CHUNK)]
        return np.concatenate(parts).reshape(positions.shape[:-1])

    return field


def torus(ring_radius: float, tube_radius: float) -> Field:
    """Return a torus around y."""

    def field(points: NDArray[np.float64]) -> NDArray[np.float64]:
        from_ring = np.hypot(points[..., 0], points[..., 2]) - ring_radius
        return np.asarray(np.hypot(from_ring, points[..., 1]) - tube_radius)

    return field
