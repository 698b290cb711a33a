"""The integrator that lights each object by a key light of its own."""

from collections.abc import Sequence
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.mesh import Value

# A ray cannot leave an object of radius 1 and meet it again farther away than its diameter.
_SHADOW_REACH: Final = 2.1

SHADOW_SPACING: Final = 2 + 1.5 * _SHADOW_REACH
"""In the scene for shadows the objects' centres stand this many radii apart: from the rim of one,
no shadow ray reaches the rim of the next."""


def linked_integrator_class() -> Value:
    """Define the integrator; its base class exists only once a variant is set."""

    class LinkedIntegrator(mi.SamplingIntegrator):
        def __init__(
            self,
            shadow_scene: Value,
            shadow_offsets: NDArray[np.float64],
            ambient: Sequence[Light],
        ) -> None:
            super().__init__(mi.Properties())
            self.shadow_scene = shadow_scene
            self.offset_x, self.offset_y = (mi.Float(column) for column in shadow_offsets.T)
            self.ambient = [
                (mi.Vector3f(light.direction.tolist()), light.intensity) for light in ambient
            ]

        def link(self, keys: Sequence[Light]) -> None:
            """Give each object its key light."""
            directions = np.array([light.direction for light in keys])
            self.key_x, self.key_y, self.key_z = (mi.Float(column) for column in directions.T)
            self.key_intensity = mi.Float([light.intensity for light in keys])

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
            key = mi.Vector3f(
                *(
                    dr.gather(mi.Float, axis, number, active)
                    for axis in (self.key_x, self.key_y, self.key_z)
                )
            )
            intensity = dr.gather(mi.Float, self.key_intensity, number, active)
            radiance = mi.Spectrum(0)
            for direction, strength in [(key, intensity), *self.ambient]:
                radiance += self.reflected(hit, number, direction, strength, active)
            return radiance & active, active, []

        def reflected(
            self,
            hit: Value,
            number: Value,
            direction: Value,
            strength: Value,
            active: Value,
        ) -> Value:
            """Return the radiance towards the camera due to one directional light."""
            reflectance = hit.bsdf().eval(mi.BSDFContext(), hit, hit.to_local(direction), active)
            shadow_ray = hit.spawn_ray(direction)
            shadow_ray.o += mi.Vector3f(
                dr.gather(mi.Float, self.offset_x, number, active),
                dr.gather(mi.Float, self.offset_y, number, active),
                0,
            )
            shadow_ray.maxt = _SHADOW_REACH
            facing = active & dr.any(reflectance > 0)  # else there is nothing to be blocked
            blocked = self.shadow_scene.ray_test(shadow_ray, facing)
            return dr.select(blocked, 0, reflectance * strength)

    return LinkedIntegrator
