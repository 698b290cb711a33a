"""Stored photons, what became of the others, and the radiance that a density of photons means."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import reduce
from operator import add
from typing import Self

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError
from stimuli.photons.kernel_values import rows_of
from stimuli.photons.nearest_photons import NearestPhotons
from stimuli.photons.photon_grid import PhotonGrid
from stimuli.shapes.mesh import Value

Vectors = NDArray[np.float32]
Power = NDArray[np.float64]


@dataclass(frozen=True)
class EnergyBalance:
    """Where the power of the emitted photons went, red, green and blue `(3,)` each.

    Attributes
    ----------
    emitted
        Sent towards the specular objects; the sum of all that follow.
    stored
        Reached a surface that scatters light, after a specular one.
    missed
        Met no surface, or another one first.
    escaped
        Left the scene after a specular surface.
    absorbed
        Taken by coloured glass, by mirrors, or by the black side of a surface.
    bounce_limit
        Still under way after as many specular surfaces as are followed.
    """

    emitted: Power
    stored: Power
    missed: Power
    escaped: Power
    absorbed: Power
    bounce_limit: Power

    def __add__(self, other: "EnergyBalance") -> "EnergyBalance":
        names = [field.name for field in fields(self)]
        return EnergyBalance(*(getattr(self, name) + getattr(other, name) for name in names))


@dataclass(frozen=True)
class PhotonMap:
    """Photons on the surfaces of a scene that scatter light, kept where the engine computes.

    Attributes
    ----------
    position, normal, origin, power
        Dr.Jit's points, normals, vectors and colours: the place on a surface where each photon has
        come to rest, its unit normal and the unit vector to where the photon came from, both on
        the same side, and what it carries.
    energy
        Where the emitted power went.
    """

    position: Value
    normal: Value
    origin: Value
    power: Value
    energy: EnergyBalance

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Return the photons of several maps in one."""
        energy = reduce(add, [part.energy for part in parts])
        parts = [part for part in parts if len(part)] or parts[:1]
        return cls(
            _concatenated([part.position for part in parts]),
            _concatenated([part.normal for part in parts]),
            _concatenated([part.origin for part in parts]),
            _concatenated([part.power for part in parts]),
            energy,
        )

    def __len__(self) -> int:
        return int(dr.width(self.position))

    @property
    def positions(self) -> Vectors:
        """Where the photons are, float32 `(n, 3)`."""
        return rows_of(self.position)

    @property
    def powers(self) -> Vectors:
        """What they carry, float32 `(n, 3)`."""
        return rows_of(self.power)

    def radiance(
        self,
        points: NDArray[np.floating],
        normals: NDArray[np.floating],
        albedo: ArrayLike,
        *,
        radius: float | None = None,
        nearest: int | None = None,
    ) -> Vectors:
        """Return the radiance of diffuse surfaces due to the photons.

        Parameters
        ----------
        points, normals
            `(n, 3)`, of the surfaces on the side that is looked at; unit normals.
        albedo
            Diffuse, 0..1; one number, `(3,)` or `(n, 3)`.
        radius
            Of the kernel, in scene units, more than 0.
        nearest
            Instead of or beside the radius: the kernel reaches to the photon of this rank from each
            point, but no farther than the radius; 2 or more. See `stimuli.photons.nearest_photons`.

        Returns
        -------
        float32 `(n, 3)`: albedo / pi times the density of power under Epanechnikov's kernel; see
        `stimuli.photons.photon_kernel`.

        Raises
        ------
        InputError
            If neither radius nor nearest is given, or an argument is out of range.
        """
        points, normals = _checked(points, "points"), _checked(normals, "normals")
        _check_reach(radius, nearest)
        if len(self) == 0 or len(points) == 0:
            return np.zeros(points.shape, np.float32)
        photons = (self.position, self.normal, self.power)
        if nearest is not None:
            farthest = np.inf if radius is None else radius
            tree = NearestPhotons(*photons)
            irradiance = tree.irradiance(points, normals, nearest, farthest)
        else:
            grid = PhotonGrid(*photons, float(radius or 0))
            irradiance = rows_of(grid.irradiance(mi.Point3f(points.T), mi.Normal3f(normals.T)))
        return np.asarray(irradiance * np.asarray(albedo, np.float32) / np.float32(np.pi))


def _concatenated(vectors: Sequence[Value]) -> Value:
    axes = (dr.concat([vector[axis] for vector in vectors]) for axis in range(3))
    return type(vectors[0])(*axes)


def _check_reach(radius: float | None, nearest: int | None) -> None:
    if radius is None and nearest is None:
        raise InputError("radius, nearest: one of them or both are accepted")
    if radius is not None and not 0 < radius < np.inf:
        raise InputError(f"radius: {radius} given, more than 0 accepted")
    if nearest is not None and nearest < 2:
        raise InputError(f"nearest: {nearest} given, 2 or more accepted")


def _checked(vectors: NDArray[np.floating], name: str) -> Vectors:
    rows = np.asarray(vectors, np.float32)
    if rows.ndim != 2 or rows.shape[1] != 3 or not np.isfinite(rows).all():
        raise InputError(f"{name}: finite numbers of shape (n, 3) are accepted, not {rows.shape}")
    return rows
