"""Summing a radial profile over the clusters of an octree, on Dr.Jit: one kernel for every engine.

Jensen and Buhler 2002, sec. 3: from each point to be lit the octree is walked from its root; a
cluster is summed as one where the solid angle of its area is below a tolerance, else its parts are
looked at.
"""

import math
from collections.abc import Callable
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from stimuli.shapes.mesh import Value
from stimuli.translucency.power_octree import PowerOctree

Profile = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""From distances `(k,)` to values by colour channel `(k, 3)`."""

TOLERANCE: Final = 0.08
"""In steradians: at most 1 % of error in what can be seen (`benchmarks/dipole.py`)."""

_ENTRIES: Final = 1024
_NEGLIGIBLE: Final = 1e-30


class HierarchicalSum:
    """The sum of profile(distance) times power over all points of an octree, from anywhere.

    Parameters
    ----------
    octree
        The points.
    profile
        Smooth, and flat at distance 0.
    finest
        A distance within which the profile hardly changes, more than 0.
    farthest
        The largest distance that will be asked for.

    Notes
    -----
    Between a point and a cluster the profile is taken to second order: with the mean x and the
    covariance S of the cluster's power, E[f(|x|^2)] = f + tr(S) f' + 2 x.S.x f''. It is tabulated
    over t = log2(|x|^2 + finest^2), by a parabola through three entries, whose derivatives are f'
    and f''.
    """

    def __init__(
        self, octree: PowerOctree, profile: Profile, finest: float, farthest: float
    ) -> None:
        lowest, highest = np.log2([finest**2, farthest**2 + finest**2])
        steps = np.linspace(lowest, highest, _ENTRIES)
        values = profile(np.sqrt(np.maximum(0, np.exp2(steps) - finest**2)))
        values = np.where(values > _NEGLIGIBLE, values, 0)
        self._table = _flat(values, np.zeros(_ENTRIES))
        self._where = _flat(octree.centres, octree.powers)
        self._spread = _flat(octree.spreads[:, :3], octree.areas)
        self._slant = _flat(octree.spreads[:, 3:], np.zeros(len(octree.powers)))
        self._following = mi.UInt32(octree.following.astype(np.uint32))
        # Opaque: another medium or octree must not be another kernel to compile.
        self._count = dr.opaque(mi.UInt32, len(octree.powers))
        self._finest_squared = dr.opaque(mi.Float, finest**2)
        self._lowest = dr.opaque(mi.Float, lowest)
        self._per_octave = dr.opaque(mi.Float, (_ENTRIES - 1) / (highest - lowest))

    def __call__(self, places: Value, active: Value, tolerance: Value) -> Value:
        """Return the sums `mi.Color3f` at places `mi.Point3f`.

        Parameters
        ----------
        places, active
            Where to sum, and which of them.
        tolerance
            Solid angle above which a cluster is taken apart, in steradians; 0 sums every point.
        """
        start = dr.select(active, mi.UInt32(0), self._count)

        def unfinished(index: Value, _: Value) -> Value:
            return index < self._count

        def step(index: Value, total: Value) -> tuple[Value, Value]:
            contribution, whole = self._visit(places, index, tolerance)
            total = total + dr.select(whole, contribution, 0)
            following = dr.gather(mi.UInt32, self._following, index)
            return dr.select(whole, following, index + 1), total

        _, total = dr.while_loop((start, mi.Color3f(0)), unfinished, step, label="dipole")
        return total

    def _visit(self, places: Value, index: Value, tolerance: Value) -> tuple[Value, Value]:
        """Return what a cluster contributes, and whether it need not be taken apart."""
        where = dr.gather(mi.Vector4f, self._where, index)
        spread = dr.gather(mi.Vector4f, self._spread, index)
        slant = dr.gather(mi.Vector4f, self._slant, index)
        x, y, z = where[0] - places.x, where[1] - places.y, where[2] - places.z
        squared = x * x + y * y + z * z
        trace = spread[0] + spread[1] + spread[2]
        across = (
            spread[0] * x * x
            + spread[1] * y * y
            + spread[2] * z * z
            + 2 * (slant[0] * x * y + slant[1] * x * z + slant[2] * y * z)
        )
        value = self._expected(squared, trace, across)
        return value * where[3], spread[3] <= tolerance * squared

    def _expected(self, squared: Value, trace: Value, across: Value) -> Value:
        """Return the mean of the profile over a cluster, to second order in its size."""
        shifted = squared + self._finest_squared
        place = (dr.log2(shifted) - self._lowest) * self._per_octave
        entry = dr.clip(mi.UInt32(place + 0.5), 1, _ENTRIES - 2)
        low, middle, high = (
            mi.Color3f(dr.gather(mi.Vector4f, self._table, each)[:3])
            for each in (entry - 1, entry, entry + 1)
        )
        away = place - mi.Float(entry)
        bend = high - 2 * middle + low
        slope = (high - low) / 2 + away * bend
        value = middle + away * (high - low) / 2 + away * away / 2 * bend
        # f' = slope p, f'' = bend p^2 - slope p / shifted, where p = dt/d(squared).
        p = self._per_octave / (math.log(2) * shifted)
        first = p * (trace - 2 * across / shifted)
        second = 2 * across * p * p
        return value + slope * first + bend * second


def _flat(columns: NDArray[np.float64], last: NDArray[np.float64]) -> Value:
    """Return rows of four numbers, one after the other, as one load takes them."""
    return mi.Float(np.column_stack([columns, last]).astype(np.float32).ravel())
