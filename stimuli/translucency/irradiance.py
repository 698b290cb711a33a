"""The light that lamps send into a surface, less what it reflects, with shadows."""

from collections.abc import Sequence
from typing import Final

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.shapes.mesh import Value

_SHADOW_OFFSET: Final = 1e-4  # of the scene's extent: shadow rays start this far above a surface


def entering_irradiance(
    scene: Value,
    positions: NDArray[np.floating],
    normals: NDArray[np.floating],
    lights: Sequence[Light],
    refractive_index: float,
) -> NDArray[np.float64]:
    """Return the irradiance that enters a surface.

    Parameters
    ----------
    scene
        Mitsuba's scene, whose shapes cast shadows.
    positions, normals
        Of points on its surfaces, `(n, 3)`.
    lights
        By the axes of the scene; a point light is as far from the origin as its `distance` says,
        and its intensity holds there.
    refractive_index
        Of what is entered.

    Returns
    -------
    Irradiance `(n,)`, in the unit of the lights: sum of F_t(eta, w) E |n . w| over them
    (Lopez-Moreno 2011, eq. 9.2).
    """
    place, normal = (mi.Vector3f(each.T.astype(np.float32)) for each in (positions, normals))
    above = place + normal * (_SHADOW_OFFSET * float(dr.norm(scene.bbox().extents())))
    total = dr.zeros(mi.Float, len(positions))
    for light in lights:
        direction, strength, reach = towards(light, place)
        cosine = dr.dot(normal, direction)
        # A ray that leaves the surface by its back is blocked anyway.
        ray = mi.Ray3f(mi.Point3f(above), direction)
        ray.maxt = reach
        lit = (cosine > 0) & ~scene.ray_test(ray, cosine > 0)
        entering = transmittance(cosine, refractive_index) * strength * cosine
        total += dr.select(lit, entering, 0)
    return np.array(total, dtype=np.float64)


def towards(light: Light, place: Value) -> tuple[Value, Value, Value]:
    """Return the unit vector from places to a light, the irradiance across it, and its distance."""
    if light.distance is None:
        direction = mi.Vector3f(light.direction.tolist())
        return direction, mi.Float(light.intensity), mi.Float(dr.inf)
    offset = mi.Vector3f((light.direction * light.distance).tolist()) - place
    distance = dr.norm(offset)
    return offset / distance, light.intensity * (light.distance / distance) ** 2, distance


def transmittance(cosine: Value, refractive_index: Value) -> Value:
    """Return the share of unpolarised light that a smooth boundary lets pass (F_t), 0..1.

    Parameters
    ----------
    cosine
        Of the angle between ray and normal, outside; the same share passes on the way out.
    refractive_index
        Of the inside relative to the outside.
    """
    return 1 - mi.fresnel(dr.maximum(cosine, 0), refractive_index)[0]
