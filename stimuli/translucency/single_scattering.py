"""Light that scatters once in a translucent body, by quadrature along the refracted ray.

Jensen et al. 2001, sec. 2.2, with the reduced coefficients and equal scattering in all directions,
as nothing more is known of measured media. The ray to the light is not refracted, but its length
inside is corrected as there; the beam's narrowing where it enters and the change of radiance by
the refractive index where it leaves are kept, so that a flat surface is exact.

The dipole's total has single scattering in it already (see `stimuli.translucency.dipole`): a
picture with both is too bright, by a fifth in media that hardly absorb. What it adds is the
sharpness of thin media.
"""

from collections.abc import Sequence
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np

from algorithms.light import Light
from stimuli.shapes.mesh import Value
from stimuli.translucency.irradiance import towards, transmittance
from stimuli.translucency.media import Medium

_NODES: Final = 12


class SingleScattering:
    """The radiance of light that has scattered once.

    Parameters
    ----------
    medium, mm_per_unit
        What the body is filled with, and its size.
    lights
        By the axes of the scene.
    """

    def __init__(self, medium: Medium, mm_per_unit: float, lights: Sequence[Light]) -> None:
        self._lights = tuple(lights)
        self._index = dr.opaque(mi.Float, medium.refractive_index)
        extinction = medium.extinction_per_mm * mm_per_unit
        scattering = np.asarray(medium.scattering_per_mm) * mm_per_unit
        self._extinction, self._scattering = (
            mi.Color3f(*(dr.opaque(mi.Float, value) for value in each.tolist()))
            for each in (extinction, scattering)
        )
        # Nodes crowd where the channels' mean extinction leaves light.
        self._mean = dr.opaque(mi.Float, float(np.exp(np.log(extinction).mean())))
        nodes, weights = np.polynomial.legendre.leggauss(_NODES)
        self._nodes = mi.Float(((nodes + 1) / 2).astype(np.float32))
        self._weights = mi.Float((weights / 2).astype(np.float32))

    def __call__(self, scene: Value, hit: Value, ray: Value, active: Value) -> Value:
        """Return the radiance that leaves a surface along a ray that has met it, `mi.Color3f`."""
        normal = hit.sh_frame.n
        cosine = dr.maximum(dr.dot(normal, -ray.d), 1e-3)
        inside = self._cosine_inside(cosine)
        direction = dr.normalize(ray.d / self._index + (cosine / self._index - inside) * normal)
        beyond = scene.ray_intersect(hit.spawn_ray(direction), active)
        active = active & beyond.is_valid()
        leaves = 1 - dr.exp(-self._mean * beyond.t)

        def unfinished(node: Value, _: Value) -> Value:
            return node < _NODES

        def step(node: Value, total: Value) -> tuple[Value, Value]:
            share = dr.gather(mi.Float, self._nodes, node) * leaves
            depth = dr.minimum(-dr.log(1 - share) / self._mean, beyond.t)
            weight = dr.gather(mi.Float, self._weights, node) * leaves / (self._mean * (1 - share))
            source = self._source(scene, hit.p + depth * direction, active)
            return node + 1, total + weight * dr.exp(-self._extinction * depth) * source

        _, total = dr.while_loop(
            (mi.UInt32(0), mi.Color3f(0)), unfinished, step, label="single scattering"
        )
        leaving = transmittance(cosine, self._index) / dr.square(self._index)
        return dr.select(active, leaving * total, 0)

    def _cosine_inside(self, cosine: Value) -> Value:
        return dr.sqrt(1 - (1 - dr.square(cosine)) / dr.square(self._index))

    def _source(self, scene: Value, place: Value, active: Value) -> Value:
        """Return what a place inside scatters into a unit of solid angle and of length."""
        arriving = mi.Color3f(0)
        for light in self._lights:
            direction, _, reach = towards(light, place)
            way = mi.Ray3f(mi.Point3f(place), direction)
            entry = scene.ray_intersect(way, active)
            lit = active & entry.is_valid() & (entry.t < reach)
            _, strength, left = towards(light, entry.p)
            onwards = entry.spawn_ray(direction)
            onwards.maxt = left
            lit = lit & ~scene.ray_test(onwards, lit)
            cosine = dr.maximum(dr.dot(entry.sh_frame.n, direction), 1e-3)
            inside = self._cosine_inside(cosine)
            length = entry.t * cosine / inside
            entering = transmittance(cosine, self._index) * cosine / inside * strength
            arriving += dr.select(lit, entering * dr.exp(-self._extinction * length), 0)
        return self._scattering / (4 * dr.pi) * arriving
