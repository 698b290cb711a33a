"""Tracing photons through glass and mirrors to the first surface that scatters light.

Only paths L S+ D are stored, in Heckbert's notation: light, one or more specular surfaces, one that
scatters, matt or glossy. Under directional and point lights these are exactly the paths to such a
surface that Mitsuba's `path` cannot find, so that a path-traced image plus these caustics counts
every path once. Area lights can be hit by chance: their base image is that of
`stimuli.photons.caustic_free_integrator`. What the light of a caustic does after that surface is
left out of both, and so is what rough glass does to it.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.engine import require_kernels
from stimuli.photons.kernel_values import random_numbers
from stimuli.photons.photon_emission import Source, sources_of
from stimuli.photons.photon_map import EnergyBalance, PhotonMap
from stimuli.photons.specular_objects import aims_of
from stimuli.photons.surface_kinds import facing_normal, is_specular, scatters
from stimuli.shapes.mesh import Value

BOUNCE_LIMIT: Final = 24
"""Specular surfaces that a photon may meet; what is left then, trapped in glass, is below 1e-5 of
the light for a sphere."""

# The choice between reflection and refraction at the first two surfaces is stratified together with
# the direction; what comes later is too mixed to gain from it.
_STRATIFIED_CHOICES: Final = 2
_POINTS_AT_A_TIME: Final = 1 << 18
_BELOW_ONE: Final = float(np.nextafter(np.float32(1), np.float32(0)))

_ENDS: Final = range(5)
_MISSED, _STORED, _ESCAPED, _ABSORBED, _LIMITED = _ENDS


class PhotonTracer:
    """Traces photons in one scene; made once, it checks the scene once.

    Parameters
    ----------
    scene
        Mitsuba's scene. Every shape whose material is purely specular (`dielectric`,
        `thindielectric`, `conductor` ...) casts caustics, every other one receives them.
    lights
        By the scene's axes, see `photon_emission.sources_of`; None for the scene's own emitters.

    Raises
    ------
    InputError
        If there is no light or no specular object, glass is not closed, or the geometry is not
        finite.
    UnavailableError
        With the scalar engine, which has no kernels.
    """

    def __init__(self, scene: Value, lights: Sequence[Light] | None = None) -> None:
        require_kernels("photons")
        self.scene = scene
        self.aims = aims_of(scene)
        box = scene.bbox()
        ends = np.array([np.ravel(box.min), np.ravel(box.max)], np.float64)
        if not np.isfinite(ends).all():
            raise InputError("scene: its geometry is not finite")
        corners = np.array(np.meshgrid(*ends.T)).reshape(3, -1).T
        self.sources = sources_of(scene, lights, corners)

    def trace(self, count: int, generator: np.random.Generator) -> PhotonMap:
        """Send photons from the lights, and keep those that caustics are made of.

        Parameters
        ----------
        count
            Photons to emit, 1 or more, shared out among lights and objects by their power.
        generator
            Draws the scrambling of the low-discrepancy points and all later choices.

        Returns
        -------
        The stored photons, the same for the same state of the generator.

        Raises
        ------
        InputError
            If the count is out of range.
        """
        if count < 1:
            raise InputError(f"count: {count} given, 1 or more accepted")
        pairs = [(source, number) for source in self.sources for number in range(len(self.aims))]
        fluxes = np.array([source.flux(self.aims[number]) for source, number in pairs])
        if fluxes.sum() == 0:
            raise InputError("lights: no light reaches a specular object")
        bounds = np.round(count * np.cumsum(fluxes) / fluxes.sum()).astype(int)
        counts = np.diff(bounds, prepend=0)
        parts = [
            self._trace_part(source, number, int(share), generator)
            for (source, number), share in zip(pairs, counts, strict=True)
            if share
        ]
        return PhotonMap.joined(parts)

    def _trace_part(
        self, source: Source, number: int, count: int, generator: np.random.Generator
    ) -> PhotonMap:
        """Trace the photons from one light to one object."""
        samples = _stratified(count, source.dimensions + _STRATIFIED_CHOICES, generator)
        ray, flux = source.emit(self.aims[number], samples[: source.dimensions])
        active = dr.any(flux > 0)
        for earlier in self.aims[:number]:
            active &= ~earlier.meets(ray)
        share = flux / dr.opaque(mi.Float, count)
        power = dr.select(active, share, dr.zeros(mi.Color3f, count))
        flight = _Flight(
            ray=ray,
            power=power,
            active=active,
            choices=mi.Point2f(*samples[source.dimensions :]),
            random=random_numbers(count, int(generator.integers(2**63))),
            bounces=mi.UInt32(0),
            absorbed=mi.Color3f(0),
            end=mi.UInt32(_MISSED),
            position=mi.Point3f(0),
            normal=mi.Normal3f(0),
            origin=mi.Vector3f(0),
        )
        return _stored(_follow(self.scene, flight), power)


def trace_photons(
    scene: Value,
    count: int,
    generator: np.random.Generator,
    lights: Sequence[Light] | None = None,
) -> PhotonMap:
    """Trace photons in a scene once; see `PhotonTracer`."""
    return PhotonTracer(scene, lights).trace(count, generator)


@dataclass
class _Flight:
    """The state of photons under way."""

    ray: Value
    power: Value
    active: Value
    choices: Value  # uniform numbers: x is for the next specular surface, y for the one after it
    random: Value  # makes the numbers after them
    bounces: Value
    absorbed: Value  # the power that specular surfaces have taken
    end: Value  # why the flight ended
    position: Value  # of the last surface
    normal: Value  # its unit normal, on the side that the photon came from
    origin: Value  # the unit vector to where the photon came from


def _follow(scene: Value, flight: _Flight) -> _Flight:
    """Return photons as they are when their flights have ended."""
    context = mi.BSDFContext(mi.TransportMode.Importance)

    def step(flight: _Flight) -> tuple[_Flight]:
        surface = scene.ray_intersect(
            flight.ray, mi.RayFlags.All, coherent=False, active=flight.active
        )
        bsdf = surface.bsdf(flight.ray)
        hit = flight.active & surface.is_valid()
        specular = hit & is_specular(bsdf.flags())
        flight.end = dr.select(flight.active, _end(flight, surface, bsdf, hit), flight.end)
        flight.position = dr.select(hit, surface.p, flight.position)
        flight.normal = dr.select(hit, facing_normal(surface, flight.ray), flight.normal)
        flight.origin = dr.select(hit, -flight.ray.d, flight.origin)

        sample, weight = bsdf.sample(context, surface, flight.choices.x, mi.Point2f(0.5), specular)
        after = dr.select(specular, flight.power * weight, flight.power)
        flight.absorbed += flight.power - after
        flight.power = after
        flight.ray = surface.spawn_ray(surface.to_world(sample.wo))
        flight.bounces = dr.select(specular, flight.bounces + 1, flight.bounces)
        flight.active = specular & (flight.bounces <= BOUNCE_LIMIT)
        flight.choices = mi.Point2f(flight.choices.y, flight.random.next_float32())
        return (flight,)

    (ended,) = dr.while_loop((flight,), lambda flight: flight.active, step)
    return ended


def _end(flight: _Flight, surface: Value, bsdf: Value, hit: Value) -> Value:
    """Return why flights would end at a surface, or behind the last one."""
    flags = bsdf.flags()
    at_rest = dr.select(scatters(surface, flags), _STORED, _ABSORBED)
    at_surface = dr.select(is_specular(flags), _LIMITED, at_rest)
    after_specular = dr.select(hit, at_surface, _ESCAPED)
    first_specular = hit & is_specular(flags)
    return dr.select((flight.bounces > 0) | first_specular, after_specular, _MISSED)


def _stored(ended: _Flight, emitted: Value) -> PhotonMap:
    """Keep the photons that were stored, and add up what became of all."""
    dr.eval(ended)
    powers = {end: _sum(dr.select(ended.end == end, ended.power, 0)) for end in _ENDS}
    energy = EnergyBalance(
        emitted=_sum(emitted),
        stored=powers[_STORED],
        missed=powers[_MISSED],
        escaped=powers[_ESCAPED],
        absorbed=powers[_ABSORBED] + _sum(ended.absorbed),
        bounce_limit=powers[_LIMITED],
    )
    kept: Value = dr.compress((ended.end == _STORED) & dr.any(ended.power > 0))
    photons = PhotonMap(
        dr.gather(mi.Point3f, ended.position, kept),
        dr.gather(mi.Normal3f, ended.normal, kept),
        dr.gather(mi.Vector3f, ended.origin, kept),
        dr.gather(mi.Color3f, ended.power, kept),
        energy,
    )
    dr.eval(photons.position, photons.normal, photons.origin, photons.power)
    return photons


def _sum(power: Value) -> NDArray[np.float64]:
    return np.array([dr.sum(mi.Float64(channel))[0] for channel in power])


def _stratified(count: int, dimensions: int, generator: np.random.Generator) -> list[Value]:
    """Return points of a scrambled Sobol sequence, an array for each dimension."""
    sequence = qmc.Sobol(dimensions, rng=generator)
    points = np.empty((dimensions, count), np.float32)
    with warnings.catch_warnings():
        # Other counts than powers of two are a little less even; that is no mistake.
        warnings.simplefilter("ignore", UserWarning)
        for start in range(0, count, _POINTS_AT_A_TIME):
            part = sequence.random(min(_POINTS_AT_A_TIME, count - start))
            points[:, start : start + len(part)] = part.T
    return [mi.Float(column) for column in np.minimum(points, _BELOW_ONE)]
