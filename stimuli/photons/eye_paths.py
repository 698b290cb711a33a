"""Rays from a camera through glass and mirrors to the first matt surface."""

from dataclasses import dataclass
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.errors import InputError
from stimuli.photons.kernel_values import random_numbers
from stimuli.photons.surface_kinds import facing_normal, is_matt, is_specular
from stimuli.shapes.mesh import Value

Image = NDArray[np.float32]

BOUNCE_LIMIT: Final = 24
"""Specular surfaces that a ray may meet."""

_CHANNELS: Final = 3
_LOOKS: Final = 4  # rays across a pixel that look for specular surfaces
# Additive recurrence in three dimensions by the powers of the root of x^4 = x + 1: the samples of a
# pixel are spread over its area and over the first choice between reflection and refraction.
_ROOT: Final = 1.2207440846057596


@dataclass
class Sight:
    """What samples see: arrays of Dr.Jit's, the samples of a pixel one after the other.

    Attributes
    ----------
    valid
        Whether there is a matt surface at the end.
    position, normal
        Of that surface, on the side that is seen.
    weight
        Its albedo times what the surfaces before it let through.
    length
        Of the way to it, in scene units.
    """

    valid: Value
    position: Value
    normal: Value
    weight: Value
    length: Value


@dataclass
class _Walk:
    """The state of rays under way."""

    ray: Value
    active: Value
    choice: Value  # a uniform number for the next specular surface
    random: Value  # makes the numbers after it
    bounces: Value
    sight: Sight


class Eye:
    """A camera in a scene.

    Parameters
    ----------
    scene, sensor
        Mitsuba's.
    samples
        Rays by pixel.
    directly
        Whether matt surfaces count that are seen in a straight line. If not, only pixels that show
        something specular, or are beside one that does, get samples.
    """

    def __init__(self, scene: Value, sensor: Value, samples: int, *, directly: bool = True) -> None:
        self._scene, self._sensor, self._samples = scene, sensor, samples
        self._directly = directly
        width, height = (int(extent) for extent in sensor.film().crop_size())
        self.shape = (height, width, _CHANNELS)
        self._pixels = mi.UInt32(np.arange(height * width))
        if not directly:
            self._pixels = mi.UInt32(np.flatnonzero(self._show_specular_surfaces()))

    @property
    def is_blind(self) -> bool:
        """Whether no pixel gets samples, so that there is nothing to look at."""
        return len(self._pixels) == 0

    def look(self, seed: int) -> Sight:
        """Follow the rays of every pixel; different seeds give independent rays."""
        count = len(self._pixels) * self._samples
        index = dr.arange(mi.UInt32, count)
        samples = dr.opaque(mi.UInt32, self._samples)
        pixel, rank = dr.gather(mi.UInt32, self._pixels, index // samples), index % samples
        shifts = _shifts(pixel, seed)
        jitter = [
            _fraction(shift + mi.Float(rank) * dr.opaque(mi.Float, _ROOT**-power))
            for power, shift in enumerate(shifts, start=1)
        ]
        place = self._place(pixel, jitter[0], jitter[1])
        random = random_numbers(count, seed)
        lens = mi.Point2f(random.next_float32(), random.next_float32())
        ray, weight = self._sensor.sample_ray(0.0, 0.5, place, lens)
        return self._follow(ray, weight, jitter[2], random)

    def image(self, radiance: Value) -> Image:
        """Return the means over the samples of each pixel."""
        channels = [dr.block_sum(channel, self._samples) for channel in radiance]
        image = np.zeros((self.shape[0] * self.shape[1], _CHANNELS), np.float32)
        image[np.array(self._pixels)] = np.stack([np.array(each) for each in channels], axis=-1)
        return image.reshape(self.shape) / np.float32(self._samples)

    def footprint(self) -> float:
        """Return the size of a pixel on the matt surfaces in view, in scene units: the median.

        Raises
        ------
        InputError
            If no matt surface is in view.
        """
        sight = self.look(0)
        valid = np.array(sight.valid)
        if not valid.any():
            raise InputError("sensor: no matt surface is in its view")
        ray, _ = self._sensor.sample_ray_differential(0.0, 0.5, mi.Point2f(0.5), mi.Point2f(0.5))
        length = float(np.median(np.array(sight.length)[valid]))
        # Differentials are a fixed step in the film's plane.
        there, beside = ray.o + ray.d * length, ray.o_x + ray.d_x * length
        return float(dr.norm(beside - there)[0])

    def _show_specular_surfaces(self) -> NDArray[np.bool_]:
        """Return which pixels do `(height, width)`, and those beside them."""
        height, width, _ = self.shape
        index = dr.arange(mi.UInt32, height * width * _LOOKS**2)
        look: Value = index % _LOOKS**2
        across, down = ((mi.Float(k) + 0.5) / _LOOKS for k in (look % _LOOKS, look // _LOOKS))
        place = self._place(index // _LOOKS**2, across, down)
        ray, _ = self._sensor.sample_ray(0.0, 0.5, place, mi.Point2f(0.5))
        surface = self._scene.ray_intersect(mi.Ray3f(ray))
        specular = surface.is_valid() & is_specular(surface.bsdf().flags())
        shows = np.any(np.array(specular).reshape(height, width, -1), axis=-1)
        return np.asarray(ndimage.binary_dilation(shows, ndimage.generate_binary_structure(2, 2)))

    def _place(self, pixel: Value, across: Value, down: Value) -> Value:
        """Return places on the film, 0..1, from pixels' numbers and places in them, 0..1."""
        height, width, _ = self.shape
        return mi.Point2f((pixel % width + across) / width, (pixel // width + down) / height)

    def _follow(self, ray: Value, weight: Value, choice: Value, random: Value) -> Sight:
        scene, context = self._scene, mi.BSDFContext()
        nothing = Sight(mi.Bool(False), mi.Point3f(0), mi.Normal3f(0), weight, mi.Float(0))

        def step(walk: _Walk) -> tuple[_Walk]:
            surface = scene.ray_intersect(walk.ray, walk.active)
            bsdf = surface.bsdf(walk.ray)
            hit = walk.active & surface.is_valid()
            flags = bsdf.flags()
            rests = hit & is_matt(surface, flags)
            sight = walk.sight
            sight.valid |= rests & (self._directly | (walk.bounces > 0))
            sight.position = dr.select(rests, surface.p, sight.position)
            sight.normal = dr.select(rests, facing_normal(surface, walk.ray), sight.normal)
            sight.length += dr.select(hit, surface.t, 0)
            albedo = bsdf.eval_diffuse_reflectance(surface, rests)
            walk.active = hit & is_specular(flags) & (walk.bounces < BOUNCE_LIMIT)
            sample, through = bsdf.sample(
                context, surface, walk.choice, mi.Point2f(0.5), walk.active
            )
            factor = dr.select(walk.active, through, 1)
            sight.weight *= dr.select(rests, albedo, factor)
            walk.ray = surface.spawn_ray(surface.to_world(sample.wo))
            walk.choice = walk.random.next_float32()
            walk.bounces += 1
            return (walk,)

        walk = _Walk(mi.Ray3f(ray), mi.Bool(True), choice, random, mi.UInt32(0), nothing)
        (ended,) = dr.while_loop((walk,), lambda walk: walk.active, step)
        return ended.sight


def _shifts(pixel: Value, seed: int) -> list[Value]:
    """Return three uniform numbers for each pixel."""
    keys: list[Value] = [dr.opaque(mi.UInt32, (3 * seed + axis) % 2**32) for axis in range(3)]
    return [mi.sample_tea_float32(pixel, key) for key in keys]


def _fraction(number: Value) -> Value:
    return number - dr.floor(number)
