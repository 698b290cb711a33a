"""Rendering objects that each have lights of their own, without noise.

All lights are directions or points, so the light that reaches a surface point is a sum over lights
and not an integral: nothing is sampled but the pixel's area. An object is shaded by itself only;
neither shadows nor light pass from one object to another, since a neighbour's would tell of its
light. Light that passes between parts of one object (interreflection) is left out.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import View
from stimuli.engine import VARIANTS
from stimuli.light_linking.linked_integrator import SHADOW_SPACING, linked_integrator_class
from stimuli.light_linking.materials import Material
from stimuli.light_linking.placed_objects import LIGHTS, Placed, scene_of, set_light
from stimuli.shapes.mesh import Value
from stimuli.truth import GroundTruth, Image, ground_truth

Rig = Sequence[Light]
"""The lights that shine on one object. A point light's distance counts from the object's centre,
and its intensity is the irradiance there; it falls off with the square of the distance."""

_WHITE: Final = Material("diffuse", "plain", (1.0, 1.0))


@dataclass(frozen=True)
class Rendered:
    """A picture without its background.

    Attributes
    ----------
    radiance
        float32 `(height, width, 3)`, zero where there is no object.
    coverage
        The share of each pixel that objects cover, float32 `(height, width)`.
    shading
        What a white matt surface of the same shape would reflect, float32 `(height, width)`: the
        irradiance divided by pi. Albedo times shading is the radiance of a matt object.
    """

    radiance: Image
    coverage: Image
    shading: Image

    def lit_also_as(self, other: "Rendered", share: float) -> "Rendered":
        """Return the same objects under the lights of both pictures, the other's dimmed."""
        radiance = self.radiance + np.float32(share) * other.radiance
        shading = self.shading + np.float32(share) * other.shading
        return Rendered(radiance, self.coverage, shading)


class Renderer(ABC):
    """Renders one scene, in which every object has lights of its own.

    Parameters
    ----------
    objects
        In the order of their numbers, from 1; they must not overlap in the image.

    Raises
    ------
    InputError
        If there is no object.
    """

    def __init__(self, objects: Sequence[Placed]) -> None:
        self.objects = tuple(objects)
        if not self.objects:
            raise InputError("objects: one or more are accepted")

    def render(self, view: View, rigs: Sequence[Rig], *, dealt: bool = False) -> Rendered:
        """Render with the lights of each object.

        Parameters
        ----------
        view
            The camera.
        rigs
            The lights of each object in their order, for each of them equally many, one or more.
        dealt
            Whether the lights of an object are dealt out to the samples of a pixel, to each of
            them equally many, instead of being seen by all: for many lights that stand for a wide
            one. An engine that gains nothing by this does not do it.

        Raises
        ------
        InputError
            If the number of rigs or of lights is wrong, a point light is inside its object, or
            two objects may touch the same pixel.
        """
        self._numbers(view)
        if len(rigs) != len(self.objects):
            raise InputError(f"rigs: {len(rigs)} given, {len(self.objects)} accepted")
        if len({len(rig) for rig in rigs}) != 1 or not rigs[0]:
            raise InputError("rigs: equally many lights for each object are accepted, 1 or more")
        for placed, rig in zip(self.objects, rigs, strict=True):
            radius = placed.mesh.bounding_radius
            if any(light.distance and light.distance <= radius for light in rig):
                raise InputError(f"rigs: a light's distance of more than {radius:.3g} is accepted")
        if dealt and len(rigs[0]) % view.samples:
            raise InputError(f"rigs: a multiple of {view.samples} lights is accepted where dealt")
        return self._render(view, rigs, view.samples if dealt else 1)

    @abstractmethod
    def _render(self, view: View, rigs: Sequence[Rig], hands: int) -> Rendered: ...

    def ground_truth(self, view: View) -> GroundTruth:
        """Return what is known exactly at every pixel's centre."""
        self._numbers(view)
        numbers = {f"object_{index}": index + 1 for index in range(len(self.objects))}
        return ground_truth(self._scene, view, numbers)

    @cached_property
    def _scene(self) -> Value:
        return mi.load_dict(scene_of(self.objects, [placed.centre for placed in self.objects]))

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
    """Renders all objects at once; the integrator looks up the lights of the object it has hit."""

    def __init__(self, objects: Sequence[Placed]) -> None:
        super().__init__(objects)
        centres = [placed.centre for placed in self.objects]
        apart = [(SHADOW_SPACING * number, 0.0) for number in range(len(centres))]
        blockers = scene_of([_whitened(placed) for placed in self.objects], apart)
        self._integrator = linked_integrator_class()(
            self._scene if centres == apart else mi.load_dict(blockers),
            np.array(centres),
            np.array(apart),
        )

    def _render(self, view: View, rigs: Sequence[Rig], hands: int) -> Rendered:
        self._integrator.link(rigs, hands)
        sensor = view.sensor("grid")
        pixels = np.array(
            mi.render(self._scene, sensor=sensor, integrator=self._integrator, spp=view.samples)
        )
        return Rendered(pixels[..., :3], pixels[..., 3], pixels[..., 4])


class SuperposedRenderer(Renderer):
    """Renders each object alone under each light alone, and adds: light is linear.

    Python code runs once a ray in the scalar variant, so that a linked integrator would take
    hours there; this one uses Mitsuba's own. Since no pixel belongs to two objects and no light
    passes between them, the sum is the linked picture, edges included. The shading is the picture
    of white objects.
    """

    # One light and no sampling of the material: the sum over lights has a single term.
    _INTEGRATOR: Final = {
        "type": "direct",
        "emitter_samples": 1,
        "bsdf_samples": 0,
        "hide_emitters": True,
    }
    _FEW: Final = 8  # lights of an object, of which pictures are kept: many images have the same

    def __init__(self, objects: Sequence[Placed]) -> None:
        super().__init__(objects)
        self._integrator = mi.load_dict(self._INTEGRATOR)
        self._lit_scene = cache(self._new_scene)
        self._kept = cache(self._part)

    def _render(self, view: View, rigs: Sequence[Rig], hands: int) -> Rendered:  # noqa: ARG002
        pixels = np.zeros((view.height_px, view.width_px, 5), np.float32)
        for number, (placed, rig) in enumerate(zip(self.objects, rigs, strict=True)):
            left, top, right, bottom = view.box_px(placed.centre)
            part = self._kept if len(rig) <= self._FEW else self._part
            box = pixels[top:bottom, left:right]
            box[..., 4] += part(view, number, rig[0])[..., 4]
            for light in rig:
                box[..., :4] += part(view, number, light)[..., :4]
        return Rendered(pixels[..., :3], pixels[..., 4], pixels[..., 3])

    def _part(self, view: View, number: int, light: Light) -> Image:
        """Return an object under one light: `(height, width, 5)`, radiance, shading, coverage."""
        sensor = view.sensor("grid", view.box_px(self.objects[number].centre))
        kind = "directional" if light.distance is None else "point"
        pictures = []
        for white in (False, True):
            scene = self._lit_scene(number, kind, white)
            set_light(scene, light, self.objects[number].centre)
            pixels = mi.render(scene, sensor=sensor, integrator=self._integrator, spp=view.samples)
            pictures.append(np.array(pixels))
        itself, shading = pictures
        return np.concatenate([itself[..., :3], shading[..., :1], itself[..., 3:]], axis=-1)

    def _new_scene(self, number: int, kind: str, white: bool) -> Value:
        placed = self.objects[number]
        placed = _whitened(placed) if white else placed
        return mi.load_dict(scene_of([placed], [placed.centre]) | LIGHTS[kind])


def _whitened(placed: Placed) -> Placed:
    return replace(placed, material=_WHITE, albedo=np.ones((2, 4)))


def make_renderer(objects: Sequence[Placed]) -> Renderer:
    """Return the renderer for the Mitsuba variant that is set (`choose_engine`)."""
    if mi.variant() == VARIANTS["scalar"]:
        return SuperposedRenderer(objects)
    return LinkedRenderer(objects)
