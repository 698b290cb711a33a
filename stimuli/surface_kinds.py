"""What a light path may do at a surface: go on specularly, or rest there."""

import drjit as dr
import mitsuba as mi

from stimuli.mesh import Value


def is_specular(flags: Value) -> Value:
    """Return whether materials reflect and transmit in single directions only, by their flags."""
    smooth, delta = mi.BSDFFlags.Smooth.value, mi.BSDFFlags.Delta.value
    return ((flags & smooth) == 0) & ((flags & delta) != 0)


def is_diffuse(flags: Value) -> Value:
    """Return whether materials reflect diffusely and do nothing else, by their flags."""
    scattering = mi.BSDFFlags.Smooth.value | mi.BSDFFlags.Delta.value
    return (flags & scattering) == mi.BSDFFlags.DiffuseReflection.value


def is_glass(flags: int) -> bool:
    """Return whether a material refracts: its shape has an inside, and must be closed."""
    return bool(flags & mi.BSDFFlags.DeltaTransmission.value)


def receives(surface: Value, flags: Value) -> Value:
    """Return whether diffuse surfaces reflect on the side from which a ray has come."""
    two_sided = (flags & mi.BSDFFlags.BackSide.value) != 0
    return is_diffuse(flags) & ((surface.wi.z > 0) | two_sided)


def facing_normal(surface: Value, ray: Value) -> Value:
    """Return the geometric unit normal on the side from which a ray has come."""
    return dr.select(dr.dot(surface.n, ray.d) < 0, surface.n, -surface.n)
