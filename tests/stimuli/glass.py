"""Scenes of glass, mirrors and matt receivers, in Mitsuba's dictionaries."""

from typing import Any

import mitsuba as mi

GLASS: dict[str, Any] = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
MIRROR: dict[str, Any] = {"type": "conductor", "material": "none"}


def matt(albedo: float = 0.5) -> dict[str, Any]:
    """Return a diffuse material that reflects on both sides."""
    bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}}
    return {"type": "twosided", "bsdf": bsdf}


def sphere(
    bsdf: dict[str, Any], centre: tuple[float, float, float] = (0, 0, 0), radius: float = 1.0
) -> dict[str, Any]:
    """Return a sphere."""
    return {"type": "sphere", "center": list(centre), "radius": radius, "bsdf": bsdf}


def floor(height: float, albedo: float = 0.5, half_width: float = 20.0) -> dict[str, Any]:
    """Return a matt square in the plane y = height, seen from above."""
    transform: Any = mi.ScalarTransform4f
    turned = transform().translate([0, height, 0]).rotate([1, 0, 0], -90).scale(half_width)
    return {"type": "rectangle", "to_world": turned, "bsdf": matt(albedo)}


def scene(**parts: dict[str, Any]) -> Any:  # noqa: ANN401  # its type depends on the variant
    """Return a scene of these parts."""
    return mi.load_dict({"type": "scene", **parts})


def camera(
    origin: tuple[float, float, float],
    target: tuple[float, float, float],
    *,
    size: tuple[int, int] = (64, 48),
    field_of_view_deg: float = 40,
) -> dict[str, Any]:
    """Return a perspective camera, its image `(width, height)`."""
    transform: Any = mi.ScalarTransform4f
    return {
        "type": "perspective",
        "fov": field_of_view_deg,
        "to_world": transform().look_at(list(origin), list(target), [0, 1, 0]),
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent"},
    }
