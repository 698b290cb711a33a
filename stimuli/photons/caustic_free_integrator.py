"""The base image to which caustics of area lights are added.

Mitsuba's `path` cannot find the caustics of directional and point lights, but those of an area
light it finds, by chance and with much noise. This path tracer leaves them out: what it sees of an
area light through glass or in a mirror counts only before the first surface that is not specular.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi

from stimuli.photons.surface_kinds import is_specular
from stimuli.shapes.mesh import Value


@dataclass
class _Walk:
    """The state of rays under way."""

    ray: Value
    active: Value
    bounces: Value
    radiance: Value  # found so far
    throughput: Value
    scattered: Value  # whether a surface that is not specular was met
    seen: Value  # whether any surface was met
    last: Value  # the last surface
    last_pdf: Value  # of the direction that was taken there
    last_specular: Value


def caustic_free_integrator(max_depth: int = 16) -> Value:
    """Return an integrator that finds all that `path` finds but the caustics of area lights.

    Parameters
    ----------
    max_depth
        Edges of the longest path, as of `path`.
    """

    class CausticFreeIntegrator(mi.SamplingIntegrator):
        def sample(
            self,
            scene: Value,
            sampler: Value,
            ray: Value,
            medium: Value = None,  # noqa: ARG002
            active: Value = True,
        ) -> tuple[Value, Value, list[Value]]:
            context = mi.BSDFContext()

            def step(walk: _Walk, sampler: Value) -> tuple[_Walk, Value]:
                surface = scene.ray_intersect(
                    walk.ray, mi.RayFlags.All, coherent=False, active=walk.active
                )
                bsdf = surface.bsdf(walk.ray)
                walk.radiance += _emitted(scene, surface, walk)
                walk.seen |= walk.active & surface.is_valid()
                walk.active &= surface.is_valid() & (walk.bounces + 1 < max_depth)
                walk.radiance += _reflected(scene, surface, bsdf, walk, sampler.next_2d())

                sample, factor = bsdf.sample(
                    context, surface, sampler.next_1d(), sampler.next_2d(), walk.active
                )
                walk.throughput *= factor
                walk.scattered |= ~is_specular(bsdf.flags())
                walk.last, walk.last_pdf = surface, sample.pdf
                walk.last_specular = mi.has_flag(sample.sampled_type, mi.BSDFFlags.Delta)
                walk.ray = surface.spawn_ray(surface.to_world(sample.wo))
                walk.bounces += 1
                walk.active &= dr.any(walk.throughput > 0)
                return walk, sampler

            walk = _Walk(
                ray=mi.Ray3f(ray),
                active=mi.Bool(active),
                bounces=mi.UInt32(0),
                radiance=mi.Spectrum(0),
                throughput=mi.Spectrum(1),
                scattered=mi.Bool(False),
                seen=mi.Bool(False),
                last=dr.zeros(mi.SurfaceInteraction3f),
                last_pdf=mi.Float(1),
                last_specular=mi.Bool(True),
            )
            walk, _ = dr.while_loop((walk, sampler), lambda walk, _sampler: walk.active, step)
            return walk.radiance, walk.seen, []

    return CausticFreeIntegrator(mi.Properties())


def _emitted(scene: Value, surface: Value, walk: _Walk) -> Value:
    """Return the light of emitters that rays have met."""
    direct = mi.DirectionSample3f(scene, surface, walk.last)
    emitter = surface.emitter(scene)
    of_area = mi.has_flag(emitter.flags(), mi.EmitterFlags.Surface)
    caustic = of_area & walk.last_specular & walk.scattered
    chance = scene.pdf_emitter_direction(walk.last, direct, walk.active & ~walk.last_specular)
    weight = dr.select(walk.last_specular, 1, _heuristic(walk.last_pdf, chance))
    return walk.throughput * weight * emitter.eval(surface, walk.active & ~caustic)


def _reflected(scene: Value, surface: Value, bsdf: Value, walk: _Walk, sample: Value) -> Value:
    """Return the light that comes straight from one emitter, by chance."""
    smooth = walk.active & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
    light, power = scene.sample_emitter_direction(surface, sample, True, smooth)
    lit = smooth & (light.pdf != 0)
    value, chance = bsdf.eval_pdf(mi.BSDFContext(), surface, surface.to_local(light.d), lit)
    weight = dr.select(light.delta, 1, _heuristic(light.pdf, chance))
    return dr.select(lit, walk.throughput * weight * value * power, 0)


def _heuristic(chosen: Value, other: Value) -> Value:
    """Return the power heuristic's weight, 0 where nothing can be chosen."""
    total = dr.square(chosen) + dr.square(other)
    return dr.select(total > 0, dr.square(chosen) / total, 0)
