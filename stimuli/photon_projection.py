"""Photons that a pinhole camera sees directly, each one counted in the pixel where it appears.

That is the mean over the pixel's area without any blur: nothing is estimated but the light itself.
"""

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from stimuli.mesh import Value
from stimuli.photon_map import PhotonMap

Image = NDArray[np.float32]


def can_project(sensor: Value) -> bool:
    """Return whether photons can be projected onto a camera's pixels: a `perspective` one."""
    return bool(sensor.class_name() == "PerspectiveCamera")


def projected(photons: PhotonMap, scene: Value, sensor: Value) -> Image:
    """Return the radiance of the photons' surfaces as seen in straight lines.

    Parameters
    ----------
    photons
        On surfaces of the scene.
    scene
        Hides photons behind its shapes.
    sensor
        Mitsuba's pinhole camera.

    Returns
    -------
    float32 `(height, width, 3)`.
    """
    width, height = (int(extent) for extent in sensor.film().crop_size())
    place = dr.zeros(mi.SurfaceInteraction3f)
    place.p, place.n = photons.position, photons.normal
    direct, importance = sensor.sample_direction(place, mi.Point2f(0.5))
    cosine = dr.dot(photons.normal, direct.d)
    seen = (direct.pdf > 0) & (cosine > 0)
    seen &= ~scene.ray_test(place.spawn_ray_to(direct.p), seen)
    # The importance is that of the whole film; a pixel's is as much larger as it is smaller.
    share = cosine * importance * (width * height / np.pi)
    radiance = photons.albedo * photons.power * share
    column, row = mi.UInt32(direct.uv.x), mi.UInt32(direct.uv.y)
    seen &= (column < width) & (row < height)
    kept: Value = dr.compress(seen)
    pixels = np.array(dr.gather(mi.UInt32, row * width + column, kept))
    values = np.array(dr.gather(mi.Color3f, radiance, kept))
    # Summed in order: the same photons give the same bytes.
    sums = [np.bincount(pixels, channel, width * height) for channel in values]
    return np.stack(sums, axis=-1).reshape(height, width, 3).astype(np.float32)
