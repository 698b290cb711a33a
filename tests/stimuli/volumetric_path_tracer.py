"""Mitsuba's volumetric path tracer on bodies of one medium: slow, noisy, and without diffusion."""

from typing import Any

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.camera import View

_INTEGRATOR = {"type": "volpath", "max_depth": 100_000, "rr_depth": 100_000}
_ONCE = {"type": "volpath", "max_depth": 2, "rr_depth": 100_000}


def _medium(albedo: float, extinction: float) -> dict[str, Any]:
    return {
        "type": "homogeneous",
        "albedo": {"type": "rgb", "value": albedo},
        "sigma_t": {"type": "rgb", "value": 1.0},
        "scale": extinction,
        "phase": {"type": "isotropic"},
    }


def slab_reflectance(albedo: float, refractive_index: float, samples: int) -> float:
    """Return the reflectance of a thick slab for light straight onto it, less its mirror image's.

    By reciprocity, that is the radiance that leaves it straight up under light from everywhere.
    """
    smooth = {"type": "dielectric", "int_ior": refractive_index, "ext_ior": 1.0}
    to_world = mi.ScalarTransform4f().translate([0, 0, -30]).scale([60, 60, 30])
    scene = mi.load_dict(
        {
            "type": "scene",
            "everywhere": {"type": "constant", "radiance": 1.0},
            "slab": {
                "type": "cube",
                "to_world": to_world,
                "bsdf": smooth if refractive_index > 1 else {"type": "null"},
                "interior": _medium(albedo, 1.0),
            },
        }
    )
    image = mi.render(
        scene,
        sensor=View(1, 1, 50.0, 1).sensor(),
        integrator=mi.load_dict(_INTEGRATOR),
        spp=samples,
        seed=1,
    )
    mirrored = ((refractive_index - 1) / (refractive_index + 1)) ** 2
    return float(np.array(image)[0, 0, 0]) - mirrored


def sphere_radiance(
    view: View,
    light: Light,
    albedo: float,
    extinction: float,
    samples: int,
    *,
    once: bool = False,
) -> NDArray[np.float32]:
    """Return the radiance `(height, width)` of a unit sphere without a boundary of its own.

    Where `once` is set, of light that has scattered once alone.
    """
    scene = mi.load_dict(
        {
            "type": "scene",
            "light": {
                "type": "directional",
                "direction": (-light.direction).tolist(),
                "irradiance": {"type": "rgb", "value": light.intensity},
            },
            "sphere": {
                "type": "sphere",
                "bsdf": {"type": "null"},
                "interior": _medium(albedo, extinction),
            },
        }
    )
    integrator = mi.load_dict(_ONCE if once else _INTEGRATOR)
    image = mi.render(scene, sensor=view.sensor(), integrator=integrator, spp=samples, seed=1)
    return np.array(image)[..., 0]
