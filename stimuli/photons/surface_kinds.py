"""What a light path may do at a surface: go on in one direction, or be scattered."""

import drjit as dr
import mitsuba as mi

from stimuli.shapes.mesh import Value


def is_specular(flags: Value) -> Value:
    """Return whether materials reflect and transmit in single directions only, by their flags."""
    smooth, delta = mi.BSDFFlags.Smooth.value, mi.BSDFFlags.Delta.value
    return ((flags & smooth) == 0) & ((flags & delta) != 0)


def is_glass(flags: int) -> bool:
    """Return whether a material refracts: its shape has an inside, and must be closed."""
    return bool(flags & mi.BSDFFlags.DeltaTransmission.value)


def scatters(surface: Value, flags: Value) -> Value:
    """Return whether surfaces scatter the light of a ray, on the side from which it has come."""
    return ((flags & mi.BSDFFlags.Smooth.value) != 0) & _on_this_side(surface, flags)


def is_matt(surface: Value, flags: Value) -> Value:
    """Return whether some of what surfaces scatter is diffuse, on the side that a ray has met."""
    diffuse = (flags & mi.BSDFFlags.DiffuseReflection.value) != 0
    return diffuse & _on_this_side(surface, flags)


def facing_normal(surface: Value, ray: Value) -> Value:
    """Return the geometric unit normal on the side from which a ray has come."""
    return dr.select(dr.dot(surface.n, ray.d) < 0, surface.n, -surface.n)


def _on_this_side(surface: Value, flags: Value) -> Value:
    return (surface.wi.z > 0) | ((flags & mi.BSDFFlags.BackSide.value) != 0)
