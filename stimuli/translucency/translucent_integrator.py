"""The integrator that sees a translucent surface: what leaves it, and its gloss."""

from collections.abc import Sequence

import drjit as dr
import mitsuba as mi

from algorithms.light import Light
from stimuli.shapes.mesh import Value
from stimuli.translucency.hierarchical_sum import HierarchicalSum
from stimuli.translucency.irradiance import towards, transmittance
from stimuli.translucency.single_scattering import SingleScattering


def translucent_integrator_class() -> Value:
    """Define the integrator; its base class exists only once a variant is set."""

    class TranslucentIntegrator(mi.SamplingIntegrator):
        def __init__(
            self,
            exitance: HierarchicalSum,
            refractive_index: float,
            tolerance: float,
            glossy_lights: Sequence[Light],
            single: SingleScattering | None,
        ) -> None:
            super().__init__(mi.Properties())
            self.exitance = exitance
            self.refractive_index = dr.opaque(mi.Float, refractive_index)
            self.tolerance = dr.opaque(mi.Float, tolerance)
            self.glossy_lights = glossy_lights
            self.single = single

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
            cosine = dr.dot(hit.sh_frame.n, -ray.d)
            leaving = transmittance(cosine, self.refractive_index) / dr.pi
            radiance = leaving * self.exitance(hit.p, active, self.tolerance)
            for light in self.glossy_lights:
                radiance += self.reflected(scene, hit, light, active)
            if self.single:
                radiance += self.single(scene, hit, ray, active)
            return radiance & active, active, []

        def reflected(self, scene: Value, hit: Value, light: Light, active: Value) -> Value:
            """Return the radiance of a light's highlight, by the material of what is hit."""
            direction, strength, reach = towards(light, hit.p)
            reflectance = hit.bsdf().eval(mi.BSDFContext(), hit, hit.to_local(direction), active)
            ray = hit.spawn_ray(direction)
            ray.maxt = reach
            facing = active & dr.any(reflectance > 0)
            return dr.select(scene.ray_test(ray, facing), 0, reflectance * strength)

    return TranslucentIntegrator
