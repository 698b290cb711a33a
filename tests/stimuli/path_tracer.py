"""Mitsuba's own path tracer under directional lights: another implementation to compare with."""

from collections.abc import Sequence
from typing import Any

import mitsuba as mi
import numpy as np

from algorithms.light import Light
from stimuli.camera import View
from stimuli.light_linking.placed_objects import Placed, scene_of
from stimuli.truth import Image


class PathTracer:
    """Renders objects as `Renderer` does, but one light for each sample, chosen at random.

    It knows one key light for all objects, and lets them shade each other; without
    interreflection.
    """

    def __init__(self, objects: Sequence[Placed], lights: Sequence[Light], view: View) -> None:
        emitters = {
            f"light_{number}": {
                "type": "directional",
                "direction": (-light.direction).tolist(),
                "irradiance": {"type": "rgb", "value": light.intensity},
            }
            for number, light in enumerate(lights)
        }
        centres = [placed.centre for placed in objects]
        self._scene = mi.load_dict(scene_of(objects, centres) | emitters)
        self._integrator = mi.load_dict({"type": "path", "max_depth": 2, "hide_emitters": True})
        self._sensor = _camera(view)

    def render(self, samples: int, seed: int) -> tuple[Image, Image]:
        """Return radiance `(height, width, 3)` and coverage `(height, width)`."""
        pixels = np.array(
            mi.render(
                self._scene,
                sensor=self._sensor,
                integrator=self._integrator,
                spp=samples,
                seed=seed,
            )
        )
        return pixels[..., :3], pixels[..., 3]


def _camera(view: View) -> Any:  # noqa: ANN401  # its type depends on the variant
    """Return the camera of a view, described anew, with independent samples."""
    transform: Any = mi.ScalarTransform4f
    half_width = view.width_px / 2 / view.radius_px
    return mi.load_dict(
        {
            "type": "orthographic",
            "to_world": transform().look_at(origin=[0, 0, 3], target=[0, 0, 0], up=[0, 1, 0])
            @ transform().scale([half_width, half_width, 1]),
            "film": {
                "type": "hdrfilm",
                "width": view.width_px,
                "height": view.height_px,
                "pixel_format": "rgba",
                "rfilter": {"type": "box"},
            },
            # On a regular grid of samples the choice of the light would not be even.
            "sampler": {"type": "independent"},
        }
    )
