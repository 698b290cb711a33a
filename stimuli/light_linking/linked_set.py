"""What experiments 1 and 2 share: eight objects, one of them under another key light."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Final

import numpy as np

from algorithms.images import write_channels
from algorithms.light import Light
from stimuli.camera import View
from stimuli.exposure import exposure_for, write_shown
from stimuli.light_linking.arrangement import BACKGROUND, COARSE
from stimuli.light_linking.luminance_observer import observer_details
from stimuli.light_linking.placed_objects import Placed
from stimuli.light_linking.render import Renderer, Rig, make_renderer
from stimuli.light_linking.rigs import AMBIENT
from stimuli.making import Job, Plan
from stimuli.manifest import Factor, Role, Stimulus
from stimuli.truth import regions_file, truth_files, write_truth

Place = Callable[[str, int], Sequence[Placed]]
"""Returns the objects of a scene of that name; the number says how many times coarser than for the
pictures meshes and textures may be."""

LEVELS_DEG: Final = tuple(range(0, 91, 10))
"""The divergences of both experiments."""

_SCENES_KEPT: Final = 2


@dataclass(frozen=True)
class LinkedImage:
    """One image of a design.

    Attributes
    ----------
    id
        The stimulus' id, readable by researchers and never shown to participants.
    role, number
        Its role in the set, and its place among the images of that role.
    factors
        The levels that made it.
    scene
        The name of its scene: images of one scene share their ground truth.
    objects
        The names of its objects in reading order.
    target
        The number of the object under the wrong light, from 1.
    key, target_key
        The key light of the other objects, and the target's; equal where nothing is wrong.
    """

    id: str
    role: Role
    number: int
    factors: Mapping[str, Factor]
    scene: str
    objects: Sequence[str]
    target: int
    key: Light
    target_key: Light

    @property
    def stem(self) -> str:
        """What its files are called; it tells nothing about the answer."""
        return f"{self.role}-{self.number:03d}"

    def rigs(self) -> list[Rig]:
        """Return the lights of each object in reading order."""
        numbers = range(1, len(self.objects) + 1)
        return [
            (self.target_key if number == self.target else self.key, *AMBIENT) for number in numbers
        ]

    def stimulus(self) -> Stimulus:
        """Return it as it stands in the manifest."""
        return Stimulus(
            id=self.id,
            file=f"images/{self.stem}.png",
            role=self.role,
            factors=self.factors,
            answer=None if self.key == self.target_key else self.target,
            regions=regions_file(self.scene),
            truth=truth_files(self.scene) | {"shading": f"truth/{self.stem}-shading.exr"},
            details={
                "objects": {str(label): name for label, name in enumerate(self.objects, start=1)},
                "key": asdict(self.key),
                "target_key": asdict(self.target_key),
                "ambient": [asdict(light) for light in AMBIENT],
            },
        )


def linked_plan(
    images: Sequence[LinkedImage],
    place: Place,
    view: View,
    names: Mapping[int, str],
    *,
    coarseness: int = 1,
    recurring: bool = True,
) -> Plan:
    """Return the plan of a set.

    Parameters
    ----------
    images
        Those of one scene one after another, since few scenes are kept.
    place
        Makes the objects of a scene.
    view
        The camera of all images.
    names
        Of the objects by number, for analysis.
    coarseness
        Of the scenes that only the exposure is measured on; 1 for those of the pictures.
    recurring
        Whether objects recur from image to image, so that one can know their usual brightness.
    """
    renderer_of = lru_cache(_SCENES_KEPT)(lambda scene, coarse: make_renderer(place(scene, coarse)))
    exposure = exposure_for(
        renderer_of(image.scene, coarseness).render(COARSE, image.rigs()).radiance
        for image in images
    )
    jobs = [
        Job(image.stimulus(), _Make(image, lambda scene: renderer_of(scene, 1), view, exposure))
        for image in images
    ]
    details = {
        "camera": {"projection": "orthographic", **asdict(view)},
        "background_display": BACKGROUND,
    }
    conclude = partial(observer_details, level="divergence_deg", recurring=recurring)
    return Plan(jobs, exposure, names, details, conclude)


@dataclass(frozen=True)
class _Make:
    """Makes one image."""

    image: LinkedImage
    renderer_of: Callable[[str], Renderer]
    view: View
    exposure: float

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        renderer, stimulus = self.renderer_of(self.image.scene), self.image.stimulus()
        write_truth(folder, self.image.scene, lambda: renderer.ground_truth(self.view))
        made = renderer.render(self.view, self.image.rigs())
        # Half precision: one part in two thousand, at half the size.
        write_channels(folder / stimulus.truth["shading"], made.shading.astype(np.float16))
        picture = folder / stimulus.file
        write_shown(picture, made.radiance, self.exposure, made.coverage, BACKGROUND)
        return {}
