"""The specular objects of a scene, which photons are aimed at, and what is asked of them."""

from dataclasses import dataclass
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.photons.kernel_values import opaque
from stimuli.photons.surface_kinds import is_glass, is_specular
from stimuli.shapes.mesh import Mesh, Value, require_closed

Vector = NDArray[np.float64]

_MARGIN: Final = 1 + 1e-5  # of a sphere's radius, for rounding


@dataclass(frozen=True)
class Aim:
    """A sphere `(3,)`, radius around a specular object, to which photons are sent."""

    centre: Vector
    radius: float

    def meets(self, ray: Value) -> Value:
        """Return which rays pass through the sphere, in front of their origin."""
        towards = mi.Point3f(opaque(self.centre)) - ray.o
        along = dr.dot(towards, ray.d)
        radius = dr.opaque(mi.Float, self.radius)
        passes = dr.norm(towards - ray.d * along) < radius
        return passes & ((along > 0) | (dr.norm(towards) < radius))


def aims_of(scene: Value) -> tuple[Aim, ...]:
    """Return a sphere around each specular object of a scene.

    Raises
    ------
    InputError
        If there is no specular object, glass is not closed, or the geometry is not finite.
    """
    shapes = [shape for shape in scene.shapes() if is_specular(shape.bsdf().flags())]
    if not shapes:
        raise InputError("scene: no specular object; glass or a mirror is accepted")
    return tuple(_aim(shape) for shape in shapes)


def _aim(shape: Value) -> Aim:
    glass = is_glass(shape.bsdf().flags())
    parameters = mi.traverse(shape)
    if "vertex_positions" in parameters:  # a `rectangle` is a mesh too, but keeps them for itself
        return _around(_vertices(shape, parameters, closed=glass))
    box = shape.bbox()
    corners = np.array([np.ravel(box.min), np.ravel(box.max)], np.float64)
    _require_finite(corners, shape)
    if shape.class_name() == "Sphere":
        return Aim(corners.mean(axis=0), float(np.ptp(corners[:, 0])) / 2 * _MARGIN)
    if glass:
        raise InputError(f"{shape.id()}: glass is accepted as a closed mesh or a sphere")
    return _around(corners)


def _around(points: Vector) -> Aim:
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    return Aim(middle, float(np.linalg.norm(points - middle, axis=1).max()) * _MARGIN)


def _vertices(shape: Value, parameters: Value, *, closed: bool) -> Vector:
    vertices = np.array(parameters["vertex_positions"], np.float64).reshape(-1, 3)
    _require_finite(vertices, shape)
    if closed:
        faces = np.array(parameters["faces"], np.int64).reshape(-1, 3)
        require_closed(Mesh(vertices, vertices, None, faces), f"{shape.id()} (glass)")
    return vertices


def _require_finite(points: Vector, shape: Value) -> None:
    if not np.isfinite(points).all():
        raise InputError(f"{shape.id()}: its geometry is not finite")
