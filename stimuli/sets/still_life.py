"""Still life: simple and complex things of many materials, lit originally, from the front, behind.

Lopez-Moreno 2011, sec. 8.7 compares depth and relighting on such a scene; the things, their places
and the further three lightings are ours (`stimuli.scenes.still_life_scene`). One directional key
light and a dim sky of even radiance light it. Light is traced with up to ten bounces; what the key
light sends through glass onto the table, which no path tracer finds, is photon-mapped and added.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

import mitsuba as mi
import numpy as np

from algorithms.images import read_channels, write_channels
from stimuli.camera import Perspective
from stimuli.convergence import render_on_top_of, render_until
from stimuli.engine import choose_engine, require_kernels
from stimuli.exposure import exposure_for, write_shown
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Stimulus, StimulusSet
from stimuli.photons.caustic_render import CausticRenderer
from stimuli.photons.photon_tracing import PhotonTracer
from stimuli.scenes.still_life_scene import (
    KEY_COLOUR,
    LIGHTINGS,
    OBJECTS,
    SKY_RADIANCE,
    StillLife,
    camera,
    key_in_scene,
)
from stimuli.shapes.mesh import Value
from stimuli.truth import Image, ground_truth, regions_file, truth_files, write_truth

STEM: Final = "still-life"
SKY_FILES: Final = ("truth/sky-even.exr", "truth/sky-odd.exr")
_INTEGRATOR: Final[Mapping[str, Any]] = {"type": "path", "max_depth": 11, "hide_emitters": True}
_QUICK_LIGHTINGS: Final = ("original", "front", "back")


@dataclass(frozen=True)
class Size:
    """How large and how carefully the pictures are rendered, by pass."""

    width_px: int
    samples: int
    photons: int
    lightings: tuple[str, ...]


FULL: Final = Size(640, 64, 4_000_000, tuple(LIGHTINGS))
QUICK: Final = Size(128, 64, 200_000, _QUICK_LIGHTINGS)
# By itself, where the picture is dark and noise shows more than in the sum.
_SKY_NOISE: Final = 1.0
_SMALL_PX: Final = 160
_SMALL_SAMPLES: Final = 64


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
        Varies shapes and textures, and draws all samples; 0 or more.
    quick
        A fifth of the width, and the three lightings of the thesis.
    engine
        `cuda`, `llvm`, or None for the fastest; photons need one of them.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Factor `lighting`; of every image its scene-referred `radiance`, that of
    the sky alone (two independent halves, `sky_even` and `sky_odd`), and the ground truth
    `distance`, `relief`, `normal` and `albedo`, which all share; the key light in the frame of the
    camera; the noise left.

    Raises
    ------
    InputError
        If the folder holds something else or cannot be written to.
    UnavailableError
        If only the scalar engine works here.
    """
    size = QUICK if quick else FULL
    chosen = choose_engine(engine)
    require_kernels("photons")
    recipe = recipe_of("still-life", f"{__name__}.make", {"quick": quick}, seed, chosen)

    def plan() -> Plan:
        life = StillLife(np.random.default_rng([seed, 0]))
        view = camera(size.width_px)
        lit = [_Lighting(life, name, view, size) for name in size.lightings]
        dim = _trace(life.under_sky(), camera(_SMALL_PX), 0, _SMALL_SAMPLES)
        exposure = exposure_for(dim + each.small() for each in lit)
        sky = _Sky(life, view, size, exposure, seed * 100_000)
        jobs = [
            Job(each.stimulus(), _Make(each, sky, exposure, seed * 100_000 + 10_000 * number))
            for number, each in enumerate(lit, start=1)
        ]
        return Plan(jobs, exposure, OBJECTS, {"sky_radiance": SKY_RADIANCE})

    return make_set(folder, recipe, plan, progress)


class _Sky:
    """What the sky alone sheds on the scene: the same in every lighting, so rendered once."""

    def __init__(
        self, life: StillLife, view: Perspective, size: Size, exposure: float, seed: int
    ) -> None:
        self._life, self._view, self._size = life, view, size
        self._exposure, self._seed = exposure, seed

    def halves(self, folder: Path) -> tuple[Image, Image]:
        """Return two independent estimates, from the set's folder if they are there."""
        files = tuple(folder / file for file in SKY_FILES)
        if not all(file.is_file() for file in files):
            scene = self._life.under_sky()
            made = render_until(
                lambda seed: _trace(scene, self._view, seed, self._size.samples),
                self._exposure,
                seed=self._seed,
                limit_of_255=_SKY_NOISE,
            )
            for file, half in zip(files, made.halves, strict=True):
                write_channels(file, half)
        even, odd = (read_channels(file) for file in files)
        return even, odd


class _Lighting:
    """The scene under one key light, seen by its camera."""

    def __init__(self, life: StillLife, name: str, view: Perspective, size: Size) -> None:
        self.name, self.view, self._size = name, view, size
        self.numbers = life.numbers
        self.scene = life.under_key(view, name)
        tracer = PhotonTracer(self.scene, [key_in_scene(view, name)])
        self._caustics = CausticRenderer(tracer, view.sensor(), photons_per_pass=size.photons)

    def render(self, seed: int, first_seed: int) -> Image:
        """Render one pass: traced paths, and the caustics of as many photons."""
        caustics, _ = self._caustics.render_pass(seed - first_seed, first_seed)
        traced = _trace(self.scene, self.view, seed, self._size.samples)
        return np.asarray(traced + caustics * np.array(KEY_COLOUR, np.float32))

    def small(self) -> Image:
        """Return a small picture with little noise, to know how bright it gets."""
        return _trace(self.scene, camera(_SMALL_PX), 0, _SMALL_SAMPLES)

    def stimulus(self) -> Stimulus:
        return Stimulus(
            id=self.name,
            file=f"images/{self.name}.png",
            factors={"lighting": self.name},
            regions=regions_file(STEM),
            truth=truth_files(STEM)
            | {"radiance": _radiance_file(self.name)}
            | dict(zip(("sky_even", "sky_odd"), SKY_FILES, strict=True)),
            details={
                "key": asdict(LIGHTINGS[self.name]),
                "key_colour": KEY_COLOUR,
                "camera": {"projection": "perspective", **asdict(self.view)},
            },
        )


@dataclass(frozen=True)
class _Make:
    """Makes one image of the set."""

    lit: _Lighting
    sky: _Sky
    exposure: float
    seed: int

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        lit = self.lit
        write_truth(folder, STEM, lambda: ground_truth(lit.scene, lit.view, lit.numbers))
        sky = self.sky.halves(folder)
        # Under one light at a time the path tracer need not choose, and direct light has no noise.
        made = render_on_top_of(
            sky, lambda seed: lit.render(seed, self.seed), self.exposure, seed=self.seed
        )
        write_channels(folder / _radiance_file(lit.name), made.radiance)
        write_shown(folder / f"images/{lit.name}.png", made.radiance, self.exposure)
        return {"noise_rms_of_255": made.noise_rms_of_255, "passes": made.passes}


def _trace(scene: Value, view: Perspective, seed: int, samples: int) -> Image:
    sensor, integrator = view.sensor("jittered"), mi.load_dict(dict(_INTEGRATOR))
    pixels = mi.render(scene, sensor=sensor, integrator=integrator, seed=seed, spp=samples)
    return np.array(pixels, dtype=np.float32)[..., :3]


def _radiance_file(name: str) -> str:
    return f"truth/{name}-radiance.exr"
