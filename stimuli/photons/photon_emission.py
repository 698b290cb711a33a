"""How photons leave the lights: only towards the specular objects, with exactly their power.

Each specular object has a bounding sphere, and each light sends photons to each sphere. A ray that
meets several spheres is emitted for the first of them only, so that no light is counted twice.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any, Final

import drjit as dr
import mitsuba as mi
import numpy as np

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.photons.kernel_values import opaque
from stimuli.photons.specular_objects import Aim, Vector
from stimuli.shapes.mesh import Value

# Of the first kind the shapes are asked; the light of the others behind glass is found by `path`.
_SEND_NONE: Final = (
    "AreaLight",
    "ConstantBackgroundEmitter",
    "EnvironmentMapEmitter",
    "SunskyEmitter",
)


class Source(ABC):
    """A light that can send photons to a sphere."""

    dimensions: int
    """How many random numbers a photon takes."""

    @abstractmethod
    def flux(self, aim: Aim) -> float:
        """Return about how much power goes to a sphere: decides how many photons it gets."""

    @abstractmethod
    def emit(self, aim: Aim, samples: Sequence[Value]) -> tuple[Value, Value]:
        """Return rays through a sphere, and what each would carry if it were the only one.

        Parameters
        ----------
        aim
            The sphere.
        samples
            As many arrays of uniform numbers as there are dimensions.
        """


class DirectionalSource(Source):
    """Parallel light.

    Parameters
    ----------
    direction
        Unit vector `(3,)` towards the light.
    irradiance
        `(3,)`, on a surface that faces the light.
    corners
        `(n, 3)` points whose convex hull holds the scene: photons start outside.
    """

    dimensions = 2

    def __init__(self, direction: Vector, irradiance: Vector, corners: Vector) -> None:
        self._direction, self._irradiance = direction, irradiance
        self._outside = float((corners @ direction).max())

    def flux(self, aim: Aim) -> float:  # noqa: D102  # as of the base class
        return float(self._irradiance.mean() * np.pi * aim.radius**2)

    def emit(self, aim: Aim, samples: Sequence[Value]) -> tuple[Value, Value]:  # noqa: D102
        towards = mi.Vector3f(opaque(self._direction))
        away = max(self._outside - float(aim.centre @ self._direction), 0) + 2 * aim.radius
        start = mi.Point3f(opaque(aim.centre + away * self._direction))
        disk = _disk(samples) * dr.opaque(mi.Float, aim.radius)
        frame = mi.Frame3f(towards)
        ray = mi.Ray3f(start + frame.s * disk.x + frame.t * disk.y, -towards)
        return ray, mi.Color3f(opaque(self._irradiance * np.pi * aim.radius**2))


class PointSource(Source):
    """Light from a point `(3,)` of radiant intensity `(3,)`, the same in every direction."""

    dimensions = 2

    def __init__(self, position: Vector, intensity: Vector) -> None:
        self._position, self._intensity = position, intensity

    def flux(self, aim: Aim) -> float:  # noqa: D102
        away = float(np.linalg.norm(aim.centre - self._position))
        sine = min(aim.radius / away, 1.0) if away > 0 else 1.0
        return float(self._intensity.mean() * 2 * np.pi * (1 - np.sqrt(1 - sine**2)))

    def emit(self, aim: Aim, samples: Sequence[Value]) -> tuple[Value, Value]:  # noqa: D102
        position = mi.Point3f(opaque(self._position))
        direction, solid_angle = _cone(position, aim, samples)
        intensity = mi.Color3f(opaque(self._intensity))
        return mi.Ray3f(position, direction), intensity * solid_angle


class AreaSource(Source):
    """A shape of Mitsuba's that emits light, with a texture or without."""

    dimensions = 4

    def __init__(self, shape: Value) -> None:
        self._shape, self._emitter = shape, shape.emitter()

    def flux(self, aim: Aim) -> float:  # noqa: D102
        # Only for sharing out photons: measured from a few rays.
        generator = np.random.default_rng(0)
        samples = [mi.Float(each) for each in generator.random((4, 1024)).astype(np.float32)]
        return float(np.array(self.emit(aim, samples)[1]).mean())

    def emit(self, aim: Aim, samples: Sequence[Value]) -> tuple[Value, Value]:  # noqa: D102
        place = self._shape.sample_position(0.0, mi.Point2f(samples[0], samples[1]))
        direction, solid_angle = _cone(place.p, aim, samples[2:])
        cosine = dr.dot(place.n, direction)
        spot = dr.zeros(mi.SurfaceInteraction3f)
        spot.p, spot.n, spot.uv = place.p, place.n, place.uv
        spot.wi = mi.Frame3f(place.n).to_local(direction)
        radiance = mi.Color3f(self._emitter.eval(spot))
        power = radiance * dr.maximum(cosine, 0) * solid_angle / place.pdf
        return spot.spawn_ray(direction), power


def sources_of(scene: Value, lights: Sequence[Light] | None, corners: Vector) -> tuple[Source, ...]:
    """Return what sends photons.

    Parameters
    ----------
    scene
        Mitsuba's scene.
    lights
        Directional and point lights by the scene's axes; a point light stands at its distance from
        the origin, where its intensity is the irradiance. None for the scene's own emitters:
        `directional`, `point` and `area`. The surroundings (`constant`, `envmap`) send none.
    corners
        `(n, 3)` points whose convex hull holds the scene.

    Raises
    ------
    InputError
        If there is no light that sends photons, or an emitter of another kind.
    """
    if lights is not None:
        sources: list[Source] = [
            _source_of_light(light, corners) for light in lights if light.intensity > 0
        ]
    else:
        sources = [AreaSource(shape) for shape in scene.shapes() if shape.is_emitter()]
        others = [each for each in scene.emitters() if each.class_name() not in _SEND_NONE]
        sources += [_source_of_emitter(emitter, corners) for emitter in others]
    if not sources:
        raise InputError(
            "lights: none that casts caustics; a directional, point or area light is accepted"
        )
    return tuple(sources)


def _source_of_light(light: Light, corners: Vector) -> Source:
    irradiance = np.full(3, light.intensity)
    if light.distance is None:
        return DirectionalSource(light.direction, irradiance, corners)
    return PointSource(light.direction * light.distance, irradiance * light.distance**2)


def _source_of_emitter(emitter: Value, corners: Vector) -> Source:
    kind, parameters = emitter.class_name(), mi.traverse(emitter)
    if kind == "DirectionalEmitter":
        to_world = np.array(parameters["to_world"].matrix, np.float64).reshape(4, 4)
        towards = -to_world[:3, 2] / np.linalg.norm(to_world[:3, 2])
        return DirectionalSource(towards, _rgb(parameters["irradiance.value"]), corners)
    if kind == "PointLight":
        position = np.array(parameters["position"], np.float64).ravel()
        return PointSource(position, _rgb(parameters["intensity.value"]))
    raise InputError(
        f"lights: emitter {emitter.id()!r} is a {kind}; directional, point and area are accepted"
    )


def _cone(origin: Value, aim: Aim, samples: Sequence[Value]) -> tuple[Value, Value]:
    """Return directions uniform over the solid angle of a sphere, and that solid angle."""
    towards = mi.Point3f(opaque(aim.centre)) - origin
    sine_squared = dr.opaque(mi.Float, aim.radius**2) / dr.squared_norm(towards)
    inside = sine_squared >= 1
    # 1 - cos, without the cancellation of a small or distant sphere; inside, all directions.
    height = dr.select(inside, 2, sine_squared / (1 + dr.sqrt(dr.maximum(1 - sine_squared, 0))))
    disk = _disk(samples)
    down = dr.squared_norm(disk) * height
    across = disk * dr.sqrt(height * (2 - down))
    local = mi.Vector3f(across.x, across.y, 1 - down)
    axis = dr.select(dr.norm(towards) > 0, dr.normalize(towards), mi.Vector3f(0, 0, 1))
    return mi.Frame3f(axis).to_world(local), 2 * dr.pi * height


def _disk(samples: Sequence[Value]) -> Value:
    return mi.warp.square_to_uniform_disk_concentric(mi.Point2f(samples[0], samples[1]))


def _rgb(value: Any) -> Vector:  # noqa: ANN401  # a colour or a number of Mitsuba's
    return np.broadcast_to(np.array(value, np.float64).ravel(), 3).copy()
