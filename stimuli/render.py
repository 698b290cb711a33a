"""Rendering objects that each have a key light of their own, without noise.

All lights are directional, so the light that reaches a surface point is a sum over lights and not
an integral: nothing is sampled but the pixel's area. An object is shaded by itself only; neither
shadows nor light pass from one object to another, since a neighbour's would tell of its light.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import View
from stimuli.engine import VARIANTS
from stimuli.linked_integrator import SHADOW_SPACING, linked_integrator_class
from stimuli.scene import LIGHT, Placed, scene_of, turn_light
from stimuli.truth import GroundTruth, Image, ground_truth


class Renderer(ABC):
    """Renders one scene under one key light per object, and ambient lights shared by all.

    Parameters
    ----------
    objects
        In the order of their numbers, from 1; they must not overlap in the image.
    ambient
        The lights that shine on every object alike.

    Raises
    ------
    InputError
        If there is no object.
    """

    def __init__(self, objects: Sequence[Placed], ambient: Sequence[Light]) -> None:
        self.objects, self.ambient = tuple(objects), tuple(ambient)
        if not self.objects:
            raise InputError("objects: one or more are accepted")

    def radiance(self, view: View, keys: Sequence[Light]) -> tuple[Image, Image]:
        """Render with one key light for each object.

        Parameters
        ----------
        view
            The camera.
        keys
            As many as there are objects, in their order.

        Returns
        -------
        Radiance float32 `(height, width, 3)`, zero where there is no object, and the share of
        each pixel that objects cover, float32 `(height, width)`.

        Raises
        ------
        InputError
            If the number of keys is wrong, or two objects may touch the same pixel.
        """
        self._numbers(view)
        if len(keys) != len(self.objects):
            raise InputError(f"keys: {len(keys)} given, {len(self.objects)} accepted")
        return self._radiance(view, keys)

    @abstractmethod
    def _radiance(self, view: View, keys: Sequence[Light]) -> tuple[Image, Image]: ...

    def ground_truth(self, view: View) -> GroundTruth:
        """Return what is known exactly at every pixel's centre."""
        self._numbers(view)
        scene = mi.load_dict(scene_of(self.objects, [placed.centre for placed in self.objects]))
        numbers = {f"object_{index}": index + 1 for index in range(len(self.objects))}
        return ground_truth(scene, view, numbers)

    def _numbers(self, view: View) -> NDArray[np.uint8]:
        """Return the number of the only object that may be seen in each pixel."""
        numbers = np.zeros((view.height_px, view.width_px), np.uint8)
        for number, placed in enumerate(self.objects, start=1):
            left, top, right, bottom = view.box_px(placed.centre)
            if numbers[top:bottom, left:right].any():
                raise InputError(f"objects: number {number} may overlap another one in the image")
            numbers[top:bottom, left:right] = number
        return numbers


class LinkedRenderer(Renderer):
    """Renders all objects at once; the integrator looks up the light of the object it has hit."""

    def __init__(self, objects: Sequence[Placed], ambient: Sequence[Light]) -> None:
        super().__init__(objects, ambient)
        centres = [placed.centre for placed in self.objects]
        apart = [(SHADOW_SPACING * number, 0.0) for number in range(len(centres))]
        self._scene = mi.load_dict(scene_of(self.objects, centres))
        offsets = np.array(apart) - np.array(centres)
        self._integrator = linked_integrator_class()(
            mi.load_dict(scene_of(self.objects, apart)), offsets, self.ambient
        )

    def _radiance(self, view: View, keys: Sequence[Light]) -> tuple[Image, Image]:
        self._integrator.link(keys)
        pixels = np.array(
            mi.render(
                self._scene,
                sensor=view.sensor("grid"),
                integrator=self._integrator,
                spp=view.samples,
            )
        )
        return pixels[..., :3], pixels[..., 3]


class SuperposedRenderer(Renderer):
    """Renders each object alone under each light alone, and adds: light is linear.

    Python code runs once a ray in the scalar variant, so that a linked integrator would take
    hours there; this one uses Mitsuba's own. Since no pixel belongs to two objects and no light
    passes between them, the sum is the linked picture, edges included. What was rendered once is
    kept, as few directions serve many images.
    """

    def __init__(self, objects: Sequence[Placed], ambient: Sequence[Light]) -> None:
        super().__init__(objects, ambient)
        self._scenes = [
            mi.load_dict(scene_of([placed], [placed.centre]) | LIGHT) for placed in self.objects
        ]
        # One light and no sampling of the material: the sum over lights has a single term.
        integrator = {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}
        self._integrator = mi.load_dict(integrator | {"hide_emitters": True})
        self._parts: dict[tuple[View, int, Light], Image] = {}

    def _radiance(self, view: View, keys: Sequence[Light]) -> tuple[Image, Image]:
        size = (view.height_px, view.width_px)
        image, coverage = np.zeros((*size, 3), np.float32), np.zeros(size, np.float32)
        for number, (placed, key) in enumerate(zip(self.objects, keys, strict=True)):
            left, top, right, bottom = view.box_px(placed.centre)
            parts = [self._part(view, number, light) for light in (key, *self.ambient)]
            image[top:bottom, left:right] += sum(part[..., :3] for part in parts)
            coverage[top:bottom, left:right] += parts[0][..., 3]
        return image, coverage

    def _part(self, view: View, number: int, light: Light) -> Image:
        if (view, number, light) not in self._parts:
            box = view.box_px(self.objects[number].centre)
            turn_light(self._scenes[number], light)
            self._parts[view, number, light] = np.array(
                mi.render(
                    self._scenes[number],
                    sensor=view.sensor("grid", box),
                    integrator=self._integrator,
                    spp=view.samples,
                )
            )
        return self._parts[view, number, light]


def make_renderer(objects: Sequence[Placed], ambient: Sequence[Light]) -> Renderer:
    """Return the renderer for the Mitsuba variant that is set (`choose_engine`)."""
    if mi.variant() == VARIANTS["scalar"]:
        return SuperposedRenderer(objects, ambient)
    return LinkedRenderer(objects, ambient)
