"""A stimulus set of one's own, from Mitsuba scenes given as dictionaries or XML files."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.files import sha256_of
from algorithms.images import write_channels
from algorithms.light import Light
from stimuli.camera import Perspective, camera_of
from stimuli.convergence import NOISE_LIMIT, Image, render_until
from stimuli.engine import choose_engine
from stimuli.exposure import exposure_for, write_shown
from stimuli.light_linking.arrangement import BACKGROUND
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Factor, Role, Stimulus, StimulusSet
from stimuli.shapes.mesh import Value
from stimuli.truth import ground_truth, regions_file, truth_files, write_truth

PATH_TRACER: Final[Mapping[str, Any]] = {"type": "path", "max_depth": 8, "hide_emitters": True}
"""The integrator of a set that names no other."""

_SAMPLES_A_PASS: Final = 16


@dataclass(frozen=True)
class SceneImage:
    """One image of a set of one's own.

    Attributes
    ----------
    id
        Unique within the set.
    scene
        Mitsuba's scene: a dictionary as `mitsuba.load_dict` takes it, or the path of an XML file.
    factors
        The levels that made it, by factor name; one key for all images of a set.
    camera
        Where it is seen from; None for the first sensor of the scene, a `perspective` one.
    objects
        The clickable objects: their numbers, 1 to 255, by the ids of their shapes.
    answer, role
        As of `Stimulus`.
    lights
        The lights that are worth recording, in the project's frame of the camera.
    """

    id: str
    scene: Mapping[str, Any] | Path
    factors: Mapping[str, Factor]
    camera: Perspective | None = None
    objects: Mapping[str, int] = field(default_factory=dict)
    answer: int | str | None = None
    role: Role = "main"
    lights: Sequence[Light] = ()


def make_scene_set(
    folder: Path,
    name: str,
    images: Sequence[SceneImage],
    *,
    seed: int,
    parameters: Mapping[str, Any] | None = None,
    integrator: Mapping[str, Any] = PATH_TRACER,
    limit_of_255: float = NOISE_LIMIT,
    engine: str | None = None,
    progress: Progress = no_progress,
) -> StimulusSet:
    """Render scenes into a stimulus set, with ground truth and known noise.

    Parameters
    ----------
    folder
        New, empty, or begun with the same arguments.
    name
        The set's.
    images
        One or more; see `SceneImage`.
    seed
        Of the random samples; 0 or more.
    parameters
        What made the scenes: a folder begun with other parameters is refused. XML files are
        recognised by their bytes.
    integrator
        Mitsuba's, as a dictionary.
    limit_of_255
        The accepted noise: passes are added until its RMS is below, in 1/255 as displayed.
    engine
        `cuda`, `llvm`, `scalar`, or None for the fastest that works.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Of every image: the scene-referred `radiance`, `distance`, `relief`,
    `normal` and `albedo` as ground truth, regions if it has objects, lights, and the noise left.

    Raises
    ------
    InputError
        If a scene cannot be read or has no light, an object is not in view, the noise stays above
        the limit, or the folder holds something else or cannot be written to.
    """
    if not images:
        raise InputError("images: one or more are accepted")
    files = {str(image.scene): image.scene for image in images if isinstance(image.scene, Path)}
    known = {**(parameters or {}), "integrator": dict(integrator), "limit_of_255": limit_of_255}
    known |= {"scenes": {Path(path).name: sha256_of(file) for path, file in files.items()}}
    recipe = recipe_of(name, f"{__name__}.make_scene_set", known, seed, choose_engine(engine))

    def plan() -> Plan:
        views = [_SceneView(image, integrator) for image in images]
        exposure = exposure_for(view.small(seed) for view in views)
        jobs = [
            Job(view.stimulus(), _Make(view, exposure, seed + index * 10_000, limit_of_255))
            for index, view in enumerate(views)
        ]
        names = {number: shape for image in images for shape, number in image.objects.items()}
        return Plan(jobs, exposure, names, {"background_display": BACKGROUND})

    return make_set(folder, recipe, plan, progress)


class _SceneView:
    """An image's scene, looked at by its camera."""

    def __init__(self, image: SceneImage, integrator: Mapping[str, Any]) -> None:
        self.image = image
        self.scene = _load(image)
        self.camera = image.camera or camera_of(self.scene)
        self._integrator = mi.load_dict(dict(integrator))

    def render(self, seed: int, samples: int = _SAMPLES_A_PASS) -> Image:
        sensor = self.camera.sensor("jittered")
        pixels = mi.render(
            self.scene, sensor=sensor, integrator=self._integrator, seed=seed, spp=samples
        )
        return np.array(pixels, dtype=np.float32)

    def small(self, seed: int) -> NDArray[np.float32]:
        """Return the radiance averaged over blocks of pixels, to know how bright it gets."""
        radiance = self.render(seed)[..., :3]
        height, width = (extent - extent % 4 for extent in radiance.shape[:2])
        if not height or not width:
            return radiance
        blocks = radiance[:height, :width].reshape(height // 4, 4, width // 4, 4, 3)
        return np.asarray(blocks.mean(axis=(1, 3)))

    def stimulus(self) -> Stimulus:
        image = self.image
        return Stimulus(
            id=image.id,
            file=f"images/{image.id}.png",
            role=image.role,
            factors=image.factors,
            answer=image.answer,
            regions=regions_file(image.id) if image.objects else None,
            truth=truth_files(image.id) | {"radiance": _radiance_file(image.id)},
            details={
                "lights": [asdict(light) for light in image.lights],
                "camera": {"projection": "perspective", **asdict(self.camera)},
            },
        )


@dataclass(frozen=True)
class _Make:
    """Makes one image of the set."""

    view: _SceneView
    exposure: float
    seed: int
    limit_of_255: float

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        image, view = self.view.image, self.view
        write_truth(folder, image.id, lambda: ground_truth(view.scene, view.camera, image.objects))
        made = render_until(
            view.render, self.exposure, seed=self.seed, limit_of_255=self.limit_of_255
        )
        write_channels(folder / _radiance_file(image.id), made.radiance)
        picture = folder / f"images/{image.id}.png"
        write_shown(picture, made.radiance, self.exposure, made.coverage, BACKGROUND)
        return {"noise_rms_of_255": made.noise_rms_of_255, "passes": made.passes}


def _radiance_file(identifier: str) -> str:
    return f"truth/{identifier}-radiance.exr"


def _load(image: SceneImage) -> Value:
    try:
        if isinstance(image.scene, Path):
            scene = mi.load_file(str(image.scene))
        else:
            scene = mi.load_dict(dict(image.scene))
    except (RuntimeError, TypeError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"scene of {image.id!r}: Mitsuba cannot load it: {reason}") from error
    if not isinstance(scene, mi.Scene):
        raise InputError(f"scene of {image.id!r}: Mitsuba's 'scene' at the top is accepted")
    if not scene.emitters():
        raise InputError(f"scene of {image.id!r}: no light; one emitter or more is accepted")
    return scene
