"""Photons sorted into the cells of a grid, for the density of those within one radius of a point.

Where light is focused, thousands of photons lie within a radius. Those that share a voxel, a sixth
of the radius wide, are merged into one at their centroid, so that a point never meets more than
some hundred. That moves light by less than the voxel and loses none.
"""

from dataclasses import dataclass
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np

from stimuli.photons.photon_kernel import kernel_weight, normalised
from stimuli.shapes.mesh import Value

_VOXELS: Final = 6  # by radius
_VOXEL_BITS: Final = 8  # hold a voxel's number in its cell, below 6^3
_NEIGHBOURS: Final = 3  # cells are as wide as the radius
_BUCKET_BITS: Final = (10, 32 - _VOXEL_BITS)  # of the hash table, fewest and most
_LIKE_NORMALS: Final = 0.9  # least cosine between those that are merged
_ROW_PRIMES: Final = (0x9E3779B1, 0x85EBCA77)


@dataclass
class _Photons:
    position: Value
    normal: Value
    power: Value


class PhotonGrid:
    """Photons for gathering with one radius.

    Parameters
    ----------
    positions, normals, powers
        Of the photons, as Dr.Jit's points, normals and colours; one or more.
    radius
        Of the kernel, in scene units, more than 0.

    Notes
    -----
    Cells of one row along x follow each other in a hash table, so that the three cells about a
    point are one run of photons, and nine runs hold all that may be near. The sort is stable and
    each voxel is added up in order: sums do not depend on the order in which threads run.
    """

    def __init__(self, positions: Value, normals: Value, powers: Value, radius: float) -> None:
        self._radius = dr.opaque(mi.Float, radius)
        bits = int(np.clip(dr.width(positions).bit_length(), *_BUCKET_BITS))
        self._mask = dr.opaque(mi.UInt32, (1 << bits) - 1)
        keys = (self._bucket(self._cell(positions)) << _VOXEL_BITS) | self._voxel(positions)
        order = dr.argsort(keys)
        photons = _Photons(
            dr.gather(mi.Point3f, positions, order),
            dr.gather(mi.Normal3f, normals, order),
            dr.gather(mi.Color3f, powers, order),
        )
        dr.eval(photons)
        starts = self._starts_of_runs(photons)
        self._photons = _merged(photons, starts)
        buckets = dr.gather(mi.UInt32, keys, dr.gather(mi.UInt32, order, starts)) >> _VOXEL_BITS
        counts = dr.zeros(mi.UInt32, 1 << bits)
        dr.scatter_add(counts, mi.UInt32(1), buckets)
        self._starts = dr.prefix_sum(counts)
        self._count = dr.opaque(mi.UInt32, dr.width(starts))
        dr.eval(self._starts)

    def irradiance(self, points: Value, normals: Value, active: Value = True) -> Value:
        """Return the light of the photons on surfaces.

        Parameters
        ----------
        points, normals
            Of the surfaces, on the side that is looked at.
        active
            Where it is asked for; elsewhere it is 0.

        Returns
        -------
        Colours: power by area.
        """
        first = self._cell(points) - 1
        total = mi.Color3f(0)
        for row in range(_NEIGHBOURS**2):
            y, z = first.y + row // _NEIGHBOURS, first.z + row % _NEIGHBOURS
            total = self._add_row(total, points, normals, mi.Vector3i(first.x, y, z), active)
        return normalised(total, self._radius)

    def _add_row(
        self,
        total: Value,
        points: Value,
        normals: Value,
        cell: Value,
        active: Value,
    ) -> Value:
        """Add the photons of three cells of a row, the first of which is given."""
        _, y, z = cell
        bucket = self._bucket(cell)
        after = (bucket + _NEIGHBOURS) & self._mask
        start = dr.gather(mi.UInt32, self._starts, bucket, active)
        end = dr.gather(mi.UInt32, self._starts, after, active)
        # The table is a ring: its last bucket is followed by the first.
        left = dr.select(active & (after < bucket), self._count, 0) + end - start
        photons = self._photons

        def add(index: Value, left: Value, total: Value) -> tuple[Value, Value, Value]:
            position = dr.gather(mi.Point3f, photons.position, index)
            # Another row's cells may share the bucket.
            home = self._cell(position)
            here = (home.y == y) & (home.z == z)
            weight = kernel_weight(
                (position - points) / self._radius,
                normals,
                dr.gather(mi.Normal3f, photons.normal, index, here),
            )
            weight = dr.select(here, weight, 0)
            power = dr.gather(mi.Color3f, photons.power, index, weight > 0)
            following = dr.select(index + 1 < self._count, index + 1, 0)
            return following, left - 1, total + power * weight

        *_, total = dr.while_loop((start, left, total), lambda _, left, _total: left > 0, add)
        return total

    def _starts_of_runs(self, photons: _Photons) -> Value:
        """Return where runs of photons begin that share a voxel of one surface."""
        index = dr.arange(mi.UInt32, dr.width(photons.position))
        before = dr.maximum(index, 1) - 1
        position = dr.gather(mi.Point3f, photons.position, before)
        normal = dr.gather(mi.Normal3f, photons.normal, before)
        # Cells that share a bucket may take turns: more runs, and none with photons of both.
        same = dr.all(self._cell(position) == self._cell(photons.position))
        same &= self._voxel(position) == self._voxel(photons.position)
        same &= dr.dot(normal, photons.normal) > _LIKE_NORMALS
        return dr.compress(~same | (index == 0))

    def _cell(self, points: Value) -> Value:
        return mi.Vector3i(dr.floor(points / self._radius))

    def _bucket(self, cell: Value) -> Value:
        row = (mi.UInt32(cell.y) * _ROW_PRIMES[0]) ^ (mi.UInt32(cell.z) * _ROW_PRIMES[1])
        return (row + mi.UInt32(cell.x)) & self._mask

    def _voxel(self, points: Value) -> Value:
        """Return the number of the points' voxel in their cell."""
        place = points / self._radius
        # Below a cell's border the fraction may be rounded up to 1.
        x, y, z = dr.minimum(mi.Vector3u((place - dr.floor(place)) * _VOXELS), _VOXELS - 1)
        return (x * _VOXELS + y) * _VOXELS + z


def _merged(photons: _Photons, starts: Value) -> _Photons:
    """Merge runs of photons, given where they start."""
    number, count = dr.arange(mi.UInt32, dr.width(starts)), dr.width(starts)
    ends = dr.gather(mi.UInt32, starts, number + 1, number + 1 < count)
    ends = dr.select(number + 1 < count, ends, dr.opaque(mi.UInt32, dr.width(photons.position)))
    origin: Value = dr.gather(mi.Point3f, photons.position, starts)

    def add(index: Value, power: Value, normal: Value, moment: Value) -> tuple[Value, ...]:
        one = dr.gather(mi.Color3f, photons.power, index)
        offset = dr.gather(mi.Point3f, photons.position, index) - origin
        moment += mi.Vector3f(offset * dr.sum(one))
        normal += dr.gather(mi.Normal3f, photons.normal, index)
        return index + 1, power + one, normal, moment

    state = (starts, mi.Color3f(0), mi.Normal3f(0), mi.Vector3f(0))
    _, power, normal, moment = dr.while_loop(state, lambda index, *_: index < ends, add)
    centroid = mi.Point3f(origin + moment / dr.sum(power))
    merged = _Photons(centroid, dr.normalize(normal), power)
    dr.eval(merged)
    return merged
