"""The density of the photons nearest to a point: a kernel as wide as these are apart (Jensen 1996).

It adapts to the density, at the cost of noise that does not vanish as photons are added.
"""

from typing import Any, Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from stimuli.photons.kernel_values import rows_of
from stimuli.photons.photon_kernel import kernel_weight, normalised
from stimuli.shapes.mesh import Value

Vectors = NDArray[np.float32]

_POINTS_AT_A_TIME: Final = 1 << 17
_LEAST_REACH: Final = 1e-12  # where so many photons lie in one point, its light is infinite


class NearestPhotons:
    """Photons for gathering those that are nearest.

    Parameters
    ----------
    positions, normals, powers
        Of the photons, as Dr.Jit's points, normals and colours; one or more.
    """

    def __init__(self, positions: Value, normals: Value, powers: Value) -> None:
        self._positions, self._normals, self._powers = positions, normals, powers
        # An unbalanced tree is built in half the time and answers as fast.
        self._tree: Any = cKDTree(
            rows_of(positions), balanced_tree=False, compact_nodes=False, leafsize=32
        )

    def irradiance(self, points: Vectors, normals: Vectors, count: int, farthest: float) -> Vectors:
        """Return the light of the photons on surfaces.

        Parameters
        ----------
        points, normals
            `(n, 3)`, of the surfaces on the side that is looked at.
        count
            The kernel reaches to the photon of this rank, 2 or more ...
        farthest
            ... but no farther than this, in scene units.

        Returns
        -------
        float32 `(n, 3)`: power by area.
        """
        parts = []
        for start in range(0, len(points), _POINTS_AT_A_TIME):
            part = slice(start, start + _POINTS_AT_A_TIME)
            distances, photons = self._tree.query(
                points[part], count, distance_upper_bound=farthest, workers=-1
            )
            # Where there are fewer photons the rank is infinitely far, and the density 0.
            reach = np.clip(distances[:, -1], _LEAST_REACH, farthest)
            found = photons.astype(np.uint32)
            parts.append(self._density(found, points[part], normals[part], reach))
        return np.concatenate(parts)

    def _density(
        self,
        photons: NDArray[np.uint32],
        points: Vectors,
        normals: Vectors,
        reach: NDArray[np.float64],
    ) -> Vectors:
        """Add up given photons `(n, k)`, where one past the last stands for none."""
        index = mi.UInt32(photons.ravel())
        point: Value = mi.Point3f(points.T)
        normal, radius = mi.Normal3f(normals.T), mi.Float(reach.astype(np.float32))
        count = dr.opaque(mi.UInt32, photons.shape[1])
        first = dr.arange(mi.UInt32, len(points)) * count

        def add(rank: Value, total: Value) -> tuple[Value, Value]:
            photon = dr.gather(mi.UInt32, index, first + rank)
            known = photon < self._tree.n
            offset = (dr.gather(mi.Point3f, self._positions, photon, known) - point) / radius
            photon_normal = dr.gather(mi.Normal3f, self._normals, photon, known)
            weight = dr.select(known, kernel_weight(offset, normal, photon_normal), 0)
            power = dr.gather(mi.Color3f, self._powers, photon, weight > 0)
            return rank + 1, total + power * weight

        state = (dr.zeros(mi.UInt32, len(points)), dr.zeros(mi.Color3f, len(points)))
        _, total = dr.while_loop(state, lambda rank, _total: rank < count, add)
        return rows_of(normalised(total, radius))
