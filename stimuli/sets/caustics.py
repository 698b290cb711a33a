"""Chapter 7: glass objects with caustics from photons, a revolved outline, and a single image.

Lopez-Moreno 2011, sec. 7.5.1, fig. 7.11 and 7.12: four objects of increasing complexity, lit from
0, 60, 120 and 180 degrees around the vertical axis from the camera, as opaque objects and as glass;
observers compare caustics of three methods, each added to the same picture of the glass object.

What the thesis leaves open is taken as follows. Objects: a pebble for its skull, and a vertebra, a
dolphin and a bull of our own (`stimuli.shapes.figures`); a doll for practice. The camera looks down
by 28 degrees and the light by 48, so that at 0 degrees light and camera share their direction seen
from above, and some of the shadow can still be seen. Glass has a refractive index of 1.5. The key
light is directional, and what smooth glass does to it is all in the caustics: without them the
object casts a full shadow, and with them the light that is missing there is where it was sent. The
light of the studio's sky passes through the glass in all pictures alike.

The third method, `image-based`, is `algorithms.caustics`: from the picture of the opaque object and
its region it guesses a relief, makes a map of caustics of it, and adds that to the picture without
caustics, within the quadrilateral that each stimulus' details name. The thesis' settings of the
object that each of ours stands for are used (table 7.1).
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import product
from pathlib import Path
from typing import Any, Final

import mitsuba as mi
import numpy as np

from algorithms.caustics import PRESETS, cast, maps_of
from algorithms.depth import perceptual_relief
from algorithms.images import write_channels
from stimuli.camera import Perspective
from stimuli.convergence import NOISE_LIMIT, Converged, render_on_top_of, render_until
from stimuli.engine import choose_engine, require_kernels
from stimuli.exposure import exposure_for, write_shown
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Role, Stimulus, StimulusSet
from stimuli.photons.caustic_render import CausticRenderer
from stimuli.photons.photon_tracing import PhotonTracer
from stimuli.scenes.caustic_scene import (
    CAMERA_ELEVATION_DEG,
    FIGURES,
    LIGHT_ELEVATION_DEG,
    REFRACTIVE_INDEX,
    CausticScene,
    camera,
    key_in_frame,
    map_corners,
)
from stimuli.shapes.mesh import Value
from stimuli.truth import GroundTruth, Image, ground_truth, regions_file, truth_files, write_truth

LIGHTS_DEG: Final = (0, 60, 120, 180)
METHODS: Final[Mapping[str, str]] = {
    "photon-mapped": "caustics of the object itself, photon-mapped",
    "revolved": "caustics of the object's outline revolved, photon-mapped",
    "image-based": "caustics guessed from the picture of the opaque object",
    "no-caustics": "the glass object without the caustics of the key light",
    "opaque": "the object of matt material",
}
"""What each image shows; the first three are compared with each other."""

IMAGE_BASED: Final = "image-based"
COMPARED: Final = ("photon-mapped", "revolved", IMAGE_BASED)
_STRENGTHS: Final = (2.0, 3.0)  # at which about as much light is added as photons bring
_SETTINGS: Final = {"pebble": "skull", "vertebra": "vertebrae"}  # others by their own names
PRACTICE_OBJECT: Final = "doll"
"""Shown before the study: at one light as the example, at the others for practice."""
EXAMPLE_LIGHT_DEG: Final = 60

_INTEGRATOR: Final[Mapping[str, Any]] = {
    "type": "path",
    "max_depth": 24,
    "rr_depth": 100,
    "hide_emitters": True,
}
# Of what is accepted in the whole: what is added on top cannot take noise away.
_SKY_NOISE: Final = 0.7
_BASE_NOISE: Final = 0.9


@dataclass(frozen=True)
class Size:
    """How large and how carefully the pictures are rendered, by pass.

    Attributes
    ----------
    width_px
        Of the picture.
    sky_samples, key_samples
        A pixel, under the sky, whose light is noisy, and under the key light, whose is not: powers
        of 4, so that no two threads share a pixel, whose last digit would show which came first.
    photons
        Emitted.
    eye_samples
        A pixel that shows glass, for the caustics seen through it.
    """

    width_px: int
    sky_samples: int
    key_samples: int
    photons: int
    eye_samples: int


FULL: Final = Size(512, 64, 16, 1_500_000, 64)
QUICK: Final = Size(96, 64, 16, 200_000, 64)
_SMALL: Final = Size(80, 16, 4, 50_000, 16)


@dataclass(frozen=True)
class CausticImage:
    """One image of the design.

    Attributes
    ----------
    role, number
        Its role in the set, and its place among the images of that role.
    shape, light_deg, method
        One of `FIGURES`, `LIGHTS_DEG` and `METHODS` each.
    """

    role: Role
    number: int
    shape: str
    light_deg: int
    method: str

    @property
    def cell(self) -> str:
        """What the images of one object and light have in common, as a file's stem."""
        return f"{self.shape}-{self.light_deg:03d}"

    def stimulus(self, view: Perspective) -> Stimulus:
        """Return it as it stands in the manifest."""
        stem = f"{self.role}-{self.number:03d}"
        own = {"radiance": _radiance_file(self.cell, self.method)}
        shared = {
            name: _radiance_file(self.cell, method)
            for name, method in (("opaque", "opaque"), ("transparent", "no-caustics"))
        }
        return Stimulus(
            id=f"{stem}-{self.cell}-{self.method}",
            file=f"images/{stem}.png",
            role=self.role,
            factors={"object": self.shape, "light_deg": self.light_deg, "method": self.method},
            regions=regions_file(self.shape),
            truth=truth_files(self.shape) | own | shared,
            details={
                "light": asdict(key_in_frame(self.light_deg, view)),
                "map_quad_px": view.project(map_corners(self.light_deg)).round(3).tolist(),
            },
        )


def make(
    folder: Path,
    *,
    seed: int,
    quick: bool = False,
    engine: str | None = None,
    progress: Progress = no_progress,
) -> StimulusSet:
    """Render the set, or what is missing of it.

    Parameters
    ----------
    folder
        New, empty, or begun with the same arguments and versions.
    seed
        Varies the objects' proportions, and draws all samples; 0 or more.
    quick
        A fifth of the width, and two of the objects at two lights.
    engine
        `cuda`, `llvm`, or None for the fastest; photons need one of them.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Factors `object`, `light_deg` and `method`; main and practice images are
    those that are compared, the others are examples. Of every image its scene-referred `radiance`,
    those of the same object and light without caustics (`transparent`) and as an `opaque` one; the
    object's region; `distance`, `relief`, `normal` and `albedo` of the opaque object; the light in
    the camera's frame; the corners of the place for a map of caustics, `map_quad_px`: (x, y) from
    the image's top left, in order from where the map's top left goes; the noise left.

    Raises
    ------
    InputError
        If the seed is negative, or the folder holds something else or cannot be written to.
    UnavailableError
        If only the scalar engine works here.
    """
    chosen = choose_engine(engine)
    require_kernels("photons")
    recipe = recipe_of("caustics", f"{__name__}.make", {"quick": quick}, seed, chosen)
    return make_set(folder, recipe, lambda: _plan(seed, quick), progress)


def design(*, quick: bool) -> tuple[CausticImage, ...]:
    """Return the images: the example and those for practice, then objects by lights by methods."""
    main = [name for name in FIGURES if name != PRACTICE_OBJECT]
    shapes = (PRACTICE_OBJECT, main[1], main[-1]) if quick else (PRACTICE_OBJECT, *main)
    lights_deg = (EXAMPLE_LIGHT_DEG, 180) if quick else (EXAMPLE_LIGHT_DEG, 0, 120, 180)
    images: list[CausticImage] = []
    for shape, light_deg, method in product(shapes, lights_deg, METHODS):
        role = _role(shape, light_deg, method)
        number = sum(image.role == role for image in images)
        images.append(CausticImage(role, number, shape, light_deg, method))
    return tuple(images)


def _role(shape: str, light_deg: int, method: str) -> Role:
    example = shape == PRACTICE_OBJECT and light_deg == EXAMPLE_LIGHT_DEG
    if example or method not in COMPARED:
        return "example"
    return "practice" if shape == PRACTICE_OBJECT else "main"


def _plan(seed: int, quick: bool) -> Plan:
    images, size = design(quick=quick), QUICK if quick else FULL
    view = camera(size.width_px)
    subjects = {name: CausticScene(name, np.random.default_rng([seed, 0])) for name in FIGURES}
    shapes = dict.fromkeys(image.shape for image in images)
    small = {
        name: _Studio(subjects[name], camera(_SMALL.width_px), _SMALL, seed, 1.0, np.inf)
        for name in shapes
    }
    exposure = exposure_for(
        small[image.shape].picture(image.method, image.light_deg).radiance for image in images
    )
    studios = {name: _Studio(subjects[name], view, size, seed, exposure) for name in shapes}
    return Plan(
        [Job(image.stimulus(view), _Make(image, studios[image.shape])) for image in images],
        exposure,
        dict(enumerate(FIGURES, start=1)),
        {
            "camera": {"projection": "perspective", **asdict(view)},
            "camera_elevation_deg": CAMERA_ELEVATION_DEG,
            "light_elevation_deg": LIGHT_ELEVATION_DEG,
            "refractive_index": REFRACTIVE_INDEX,
            "methods": dict(METHODS),
        },
    )


class _Studio:
    """Takes pictures of one object, and keeps what several of them share.

    A limit of infinity gives quick ones.
    """

    def __init__(
        self,
        scene: CausticScene,
        view: Perspective,
        size: Size,
        seed: int,
        exposure: float,
        limit_of_255: float = NOISE_LIMIT,
    ) -> None:
        self.scene, self.view, self._size = scene, view, size
        self._seed, self.exposure, self._limit = seed, exposure, limit_of_255
        self._skies: dict[str, Converged] = {}
        self._bases: dict[tuple[str, int], Converged] = {}

    def picture(self, method: str, light_deg: int) -> Converged:
        """Return a picture by a method under the key light and the sky."""
        if method not in COMPARED:
            return self._base(method, light_deg)
        if method == IMAGE_BASED:
            return self._image_based(light_deg)
        caustics = self._caustics(method, light_deg)
        first = self._seed_of(method, light_deg)
        return render_on_top_of(
            self._base("no-caustics", light_deg).halves,
            lambda seed: caustics.render_pass(seed - first, first)[0],
            self.exposure,
            seed=first,
            limit_of_255=self._limit,
        )

    @cached_property
    def truth(self) -> GroundTruth:
        """What is known of the opaque object."""
        number = list(FIGURES).index(self.scene.name) + 1
        return ground_truth(self.scene.opaque(0), self.view, {self.scene.name: number})

    def _base(self, method: str, light_deg: int) -> Converged:
        """Return the picture of the opaque object, or of glass without caustics."""
        if (method, light_deg) not in self._bases:
            scene = self._material(method)(light_deg)
            self._bases[method, light_deg] = render_on_top_of(
                self._under_sky(method).halves,
                lambda seed: self._trace(scene, seed, self._size.key_samples),
                self.exposure,
                seed=self._seed_of(method, light_deg),
                limit_of_255=_BASE_NOISE * self._limit,
            )
        return self._bases[method, light_deg]

    def _image_based(self, light_deg: int) -> Converged:
        """Return the glass object with caustics guessed from the picture of the opaque one."""
        preset = PRESETS[_SETTINGS.get(self.scene.name, self.scene.name)]
        settings = replace(preset, strengths=_STRENGTHS)
        mask = self.truth.regions > 0
        relief = perceptual_relief(self._base("opaque", light_deg).radiance, mask)
        base = self._base("no-caustics", light_deg)
        maps = maps_of(relief, mask, settings)
        quad = self.view.project(map_corners(light_deg))
        # Lit from the camera's side, the place lies behind the object and is seen through it.
        spared = None if light_deg == 0 else mask
        with_caustics = cast(base.radiance, maps, quad, settings, spared)
        return replace(base, radiance=with_caustics)

    def _under_sky(self, method: str) -> Converged:
        """Return the object under the sky alone, where most of the noise comes from."""
        if method not in self._skies:
            scene = self._material(method)(None)
            self._skies[method] = render_until(
                lambda seed: self._trace(scene, seed, self._size.sky_samples),
                self.exposure,
                seed=self._seed_of(method, -1),
                limit_of_255=_SKY_NOISE * self._limit,
            )
        return self._skies[method]

    def _caustics(self, method: str, light_deg: int) -> CausticRenderer:
        real = self.scene.transparent(light_deg)
        cast_by = real
        if method == "revolved":
            cast_by = self.scene.revolved(light_deg)
        return CausticRenderer(
            PhotonTracer(cast_by),
            self.view.sensor(),
            photons_per_pass=self._size.photons,
            eye_samples=self._size.eye_samples,
            seen=real,
        )

    def _material(self, method: str) -> Callable[[int | None], Value]:
        return self.scene.opaque if method == "opaque" else self.scene.transparent

    def _trace(self, scene: Value, seed: int, samples: int) -> Image:
        pixels = mi.render(
            scene,
            sensor=self.view.sensor("jittered"),
            integrator=mi.load_dict(dict(_INTEGRATOR)),
            seed=seed,
            spp=samples,
        )
        return np.array(pixels, dtype=np.float32)[..., :3]

    def _seed_of(self, method: str, light_deg: int) -> int:
        """Return the seed of a picture's first pass, which no other picture shares."""
        place = (list(FIGURES).index(self.scene.name), list(METHODS).index(method))
        entropy = [self._seed, *place, light_deg % 360]
        return int(np.random.SeedSequence(entropy).generate_state(1)[0] >> 1)


@dataclass(frozen=True)
class _Make:
    """Makes one image of the set."""

    image: CausticImage
    studio: _Studio

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        image, studio = self.image, self.studio
        write_truth(folder, image.shape, lambda: studio.truth)
        made = studio.picture(image.method, image.light_deg)
        stimulus = image.stimulus(studio.view)
        write_channels(folder / stimulus.truth["radiance"], made.radiance.astype(np.float16))
        write_shown(folder / stimulus.file, made.radiance, studio.exposure)
        return {"noise_rms_of_255": made.noise_rms_of_255, "passes": made.passes}


def _radiance_file(cell: str, method: str) -> str:
    return f"truth/{cell}-{method}-radiance.exr"
