"""Photons that a pinhole camera sees directly, each one counted in the pixel where it appears.

That is the mean over the pixel's area without any blur: nothing is estimated but the light itself.
Surfaces may be of any material that scatters light, matt or glossy.
"""

from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from stimuli.photons.photon_map import PhotonMap
from stimuli.shapes.mesh import Value

Image = NDArray[np.float32]

_STEP: Final = 1e-4  # back from a photon to where its surface is seen, in its coordinates' size


def can_project(sensor: Value) -> bool:
    """Return whether photons can be projected onto a camera's pixels: a `perspective` one."""
    return bool(sensor.class_name() == "PerspectiveCamera")


def projected(photons: PhotonMap, scene: Value, sensor: Value) -> Image:
    """Return the radiance of the photons' surfaces as seen in straight lines.

    Parameters
    ----------
    photons
        On surfaces of the scene; those of surfaces that it has not do not count.
    scene
        Hides photons behind its shapes.
    sensor
        Mitsuba's pinhole camera.

    Returns
    -------
    float32 `(height, width, 3)`.
    """
    width, height = (int(extent) for extent in sensor.film().crop_size())
    surface = _surfaces(photons, scene)
    direct, importance = sensor.sample_direction(surface, mi.Point2f(0.5), surface.is_valid())
    column, row = mi.UInt32(direct.uv.x), mi.UInt32(direct.uv.y)
    seen = surface.is_valid() & (direct.pdf > 0) & (column < width) & (row < height)
    seen &= dr.dot(photons.normal, direct.d) > 0
    seen &= ~scene.ray_test(surface.spawn_ray_to(direct.p), seen)
    reflected = _reflected(surface, photons, direct.d, seen)
    # The importance is that of the whole film; a pixel's is as much larger as it is smaller.
    radiance = photons.power * reflected * importance * (width * height)
    kept: Value = dr.compress(seen)
    pixels = np.array(dr.gather(mi.UInt32, row * width + column, kept))
    values = np.array(dr.gather(mi.Color3f, radiance, kept))
    # Summed in order: the same photons give the same bytes.
    sums = [np.bincount(pixels, channel, width * height) for channel in values]
    return np.stack(sums, axis=-1).reshape(height, width, 3).astype(np.float32)


def _surfaces(photons: PhotonMap, scene: Value) -> Value:
    """Return the surfaces of a scene on which the photons lie, each one lit by its photon."""
    step = _STEP * (1 + dr.max(dr.abs(photons.position)))
    start = photons.position + photons.origin * step
    ray = mi.Ray3f(start, -photons.origin)
    ray.maxt = 2 * step
    return scene.ray_intersect(ray)


def _reflected(surface: Value, photons: PhotonMap, direction: Value, seen: Value) -> Value:
    """Return the share of each photon's power that goes to the camera, by solid angle."""
    local = surface.to_local(direction)
    value = surface.bsdf().eval(mi.BSDFContext(), surface, local, seen)
    # Normals that are smoothed over a mesh tilt the cosines; light and eye see them the other way
    # round (Veach 1997, sec. 5.3).
    tilt = dr.abs(surface.wi.z / dr.dot(photons.normal, photons.origin))
    return value * tilt * dr.dot(photons.normal, direction) / dr.abs(local.z)
