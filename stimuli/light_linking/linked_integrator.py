"""The integrator that lights each object by lights of its own."""

from collections.abc import Sequence
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.shapes.mesh import Value

# A ray cannot leave an object of radius 1 and meet it again farther away than its diameter.
_SHADOW_REACH: Final = 2.1
_UNBLOCKED: Final = 1 - 1e-4  # of the way to a point light: the ray ends before the light

SHADOW_SPACING: Final = 2 + 1.5 * _SHADOW_REACH
"""In the scene for shadows the objects' centres stand this many radii apart: from the rim of one,
no shadow ray reaches the rim of the next."""


def linked_integrator_class() -> Value:
    """Define the integrator; its base class exists only once a variant is set."""

    class LinkedIntegrator(mi.SamplingIntegrator):
        def __init__(
            self,
            shadow_scene: Value,
            centres: NDArray[np.float64],
            shadow_centres: NDArray[np.float64],
        ) -> None:
            super().__init__(mi.Properties())
            self.shadow_scene = shadow_scene
            self.centres = [mi.Float(column) for column in centres.T]
            self.shadow_offsets = [mi.Float(column) for column in (shadow_centres - centres).T]

        def link(self, rigs: Sequence[Sequence[Light]], hands: int) -> None:
            """Give each object its lights, to each of them equally many.

            They are dealt out to so many hands, the samples of a pixel; to one hand if each sample
            is to see all of them.
            """
            lights = [light for rig in rigs for light in rig]
            self.hands = dr.opaque(mi.UInt32, hands)
            self.count = dr.opaque(mi.UInt32, len(lights) // len(rigs))
            directions = np.array([light.direction for light in lights])
            self.directions = [mi.Float(column) for column in directions.T]
            self.intensities = mi.Float([light.intensity for light in lights])
            self.distances = mi.Float([light.distance or np.inf for light in lights])

        def aov_names(self) -> list[str]:
            return ["shading"]

        def sample(
            self,
            scene: Value,
            sampler: Value,  # noqa: ARG002
            ray: Value,
            medium: Value = None,  # noqa: ARG002
            active: Value = True,
        ) -> tuple[Value, Value, list[Value]]:
            hit = scene.ray_intersect(ray, active)
            active = active & hit.is_valid()
            number = mi.UInt32(hit.shape.eval_attribute_1("face_number", hit, active))
            hand = dr.arange(mi.UInt32, dr.width(ray.o)) % self.hands

            def add(index: Value, radiance: Value, shading: Value) -> tuple[Value, Value, Value]:
                more, white = self.reflected(hit, number, number * self.count + index, active)
                return index + self.hands, radiance + more, shading + white

            _, radiance, shading = dr.while_loop(
                (hand, mi.Spectrum(0), mi.Float(0)), lambda index, *_: index < self.count, add
            )
            share: Value = mi.Float(self.hands)
            return (radiance * share) & active, active, [(shading * share) & active]

        def reflected(
            self, hit: Value, number: Value, light: Value, active: Value
        ) -> tuple[Value, Value]:
            """Return what the surface, and what a white matt one, reflects of one light."""
            direction, irradiance, reach = self.incident(hit, number, light, active)
            local = hit.to_local(direction)
            reflectance = hit.bsdf().eval(mi.BSDFContext(), hit, local, active)
            white = dr.select(hit.wi.z > 0, dr.maximum(local.z, 0) / dr.pi, 0)
            shadow_ray = hit.spawn_ray(direction)
            shadow_ray.o += mi.Vector3f(*self.gathered(self.shadow_offsets, number, active), 0)
            shadow_ray.maxt = reach
            facing = active & (white > 0)  # else there is nothing to be blocked
            blocked = self.shadow_scene.ray_test(shadow_ray, facing)
            strength = dr.select(blocked, 0, irradiance)
            return reflectance * strength, white * strength

        def incident(
            self, hit: Value, number: Value, light: Value, active: Value
        ) -> tuple[Value, Value, Value]:
            """Return where the light is, its irradiance, and how far away it may be blocked."""
            direction = mi.Vector3f(*self.gathered(self.directions, light, active))
            intensity, distance = self.gathered([self.intensities, self.distances], light, active)
            near = dr.isfinite(distance)
            place = mi.Point3f(*self.gathered(self.centres, number, active), 0)
            way = place + direction * dr.select(near, distance, 0) - hit.p
            length = dr.norm(way)
            return (
                dr.select(near, way / length, direction),
                dr.select(near, intensity * dr.square(distance / length), intensity),
                dr.select(near, dr.minimum(length * _UNBLOCKED, _SHADOW_REACH), _SHADOW_REACH),
            )

        def gathered(
            self, columns: Sequence[Value], index: Value, active: Value
        ) -> tuple[Value, ...]:
            return tuple(dr.gather(mi.Float, column, index, active) for column in columns)

    return LinkedIntegrator
