"""How much a photon counts for a point near it on a surface.

The kernel is Epanechnikov's, k(d) = 2 / (pi r^2) (1 - d^2 / r^2) for d < r, which integrates to 1
over the disc. As d is the distance in space, it does so on a curved surface too: a ball of radius d
about a point of a sphere cuts out the area pi d^2, whatever the sphere's radius.
"""

from typing import Final

import drjit as dr

from stimuli.shapes.mesh import Value

_LEAST_COSINE: Final = 0.7  # between the normals of point and photon: about 45 degrees
_GREATEST_HEIGHT: Final = 0.25  # of the photon above or below the point's tangent plane, in radii


def kernel_weight(offset: Value, normal: Value, photon_normal: Value) -> Value:
    """Return the kernel's unscaled weight of photons, 0..1.

    Parameters
    ----------
    offset
        From point to photon, in radii.
    normal, photon_normal
        Of their surfaces. A photon whose surface is turned by more than 45 degrees, or which lies
        farther above or below than a quarter of the radius, belongs to another surface: weight 0.
    """
    closeness = 1 - dr.squared_norm(offset)
    near = (closeness > 0) & (dr.abs(dr.dot(offset, normal)) < _GREATEST_HEIGHT)
    return dr.select(near & (dr.dot(normal, photon_normal) > _LEAST_COSINE), closeness, 0)


def normalised(total: Value, radius: Value) -> Value:
    """Turn the sum of powers times weights into power by area."""
    return total * (2 / dr.pi) / dr.square(radius)
