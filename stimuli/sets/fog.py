"""Fog: a lane between autumn trees, clear and in homogeneous fog of several densities.

Lopez-Moreno 2011, chapter 6: a high-dynamic-range outdoor picture with depth, to which fog is added
in image space; here the fog is rendered as well, by path tracing in the medium (`volpath`), so that
the edit can be compared with what is physically right. The thesis' picture is not public: scene,
lights and densities are ours. The fog fills the air up to 12 m; its extinction is the same at all
wavelengths, it hardly absorbs, and it scatters forwards (Henyey-Greenstein, g = 0.7).
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import mitsuba as mi
import numpy as np

from algorithms.images import read_channels, write_channels
from algorithms.light import Light
from stimuli.camera import Perspective
from stimuli.convergence import Image, Pass, render_until
from stimuli.engine import choose_engine
from stimuli.exposure import exposure_for, write_shown
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Stimulus, StimulusSet
from stimuli.scenes import fog_scene
from stimuli.scenes.fog_layer import FogLayer
from stimuli.shapes.mesh import Value
from stimuli.truth import GroundTruth, ground_truth, regions_file, truth_files, write_truth

EXTINCTIONS_PER_M: Final[Mapping[str, float]] = {
    "clear": 0.0,
    "light": 0.005,
    "medium": 0.012,
    "dense": 0.025,
}
"""sigma_t of each density; the visibility is 780, 330 and 160 m."""

_ALBEDO: Final = 0.999
_ASYMMETRY: Final = 0.7
_TOP_M: Final = 12.0
_REACH_M: Final = 1500.0

NOISE_LIMITS: Final[Mapping[str, float]] = {"clear": 1.0, "fog": 2.0}
"""The accepted noise, RMS in 1/255 as displayed; paths in fog need far more samples."""

_SAMPLES: Final = 16  # a pixel and pass
_MOST_SCATTERINGS: Final = 32
CLIPPED_SHARE: Final = 0.0008  # the lamps, and next to nothing else
_OPAQUE_TRANSMITTANCE: Final = 0.02
SEEDS_APART: Final = 10_000
_STEM: Final = "lane"
_FOG_WAY: Final = f"truth/{_STEM}-fog_way.exr"


@dataclass(frozen=True)
class Size:
    """How large the images are, and how fine the scene's meshes."""

    width_px: int
    detail: float


FULL: Final = Size(400, 1.0)
QUICK: Final = Size(128, 0.4)
_PREVIEW_WIDTH_PX: Final = 256


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
        Draws ground, plants and clouds, and the samples; 0 or more.
    quick
        128 x 96 pixels instead of 400 x 300, coarser meshes, and two of the four densities.
    engine
        `cuda`, `llvm`, `scalar` (hours for the full set), or None for the fastest that works.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Of every image: factors `density` and `extinction_per_m`; `regions`; the
    ground truth `distance`, `relief`, `normal` and `albedo`, the length `fog_way` of each pixel's
    way of light in the fog layer (all in metres; one for all images), and `radiance`; the fog's
    parameters, the sun in the camera's frame, and the noise that is left.

    Raises
    ------
    InputError
        If an argument is out of range, or the folder holds something else or cannot be written to.
    UnavailableError
        If the requested engine does not work here.
    """
    chosen = choose_engine(engine)
    recipe = recipe_of("fog", f"{__name__}.make", {"quick": quick}, seed, chosen)
    densities = ("clear", "light") if quick else tuple(EXTINCTIONS_PER_M)
    size = QUICK if quick else FULL
    return make_set(folder, recipe, lambda: _plan(densities, Lane(size, seed), seed), progress)


class Lane:
    """The scene, described once, and rendered with and without fog."""

    def __init__(self, size: Size, seed: int) -> None:
        self.camera = fog_scene.camera(size.width_px)
        self._detail = size.detail
        self._seed = seed

    @cached_property
    def _described(self) -> tuple[dict[str, Any], dict[str, int]]:
        generator = np.random.default_rng([self._seed, 0])
        return fog_scene.scene_of(self.camera, generator, self._detail)

    def lamps(self) -> list[Light]:
        """Return the lamps in the camera's frame, their distances from the camera."""
        return fog_scene.lamps_in_frame(self.camera, self._described[0])

    def truth(self) -> GroundTruth:
        """Return what is known of the lane without fog."""
        scene, numbers = self._described
        return ground_truth(mi.load_dict(scene), self.camera, numbers)

    def passes(self, density: str, camera: Perspective) -> Pass:
        """Return what renders one pass of an image."""
        sensor = camera.sensor("jittered")
        scene, integrator = self._scene(density, sensor)

        def render_pass(seed: int) -> Image:
            pixels = mi.render(scene, sensor=sensor, integrator=integrator, spp=_SAMPLES, seed=seed)
            return np.array(pixels)[..., :3]

        return render_pass

    def _scene(self, density: str, sensor: Value) -> tuple[Value, Value]:
        """Return the scene with its fog, and the integrator that renders it."""
        described, _ = self._described
        layer = layer_of(density)
        if layer is None:
            integrator = {"type": "path", "max_depth": 12}
        else:
            described = layer.immerse(described, sensor)
            # Many short paths make less noise than few long ones.
            integrator = {"type": "volpath", "max_depth": _MOST_SCATTERINGS, "rr_depth": 2}
        return mi.load_dict(described), mi.load_dict(integrator)


def layer_of(density: str) -> FogLayer | None:
    """Return the fog of a density, None for clear air."""
    return _layer(density) if EXTINCTIONS_PER_M[density] else None


def _layer(density: str) -> FogLayer:
    return FogLayer(EXTINCTIONS_PER_M[density], _ALBEDO, _ASYMMETRY, _TOP_M, _REACH_M)


def _plan(densities: Sequence[str], scene: Lane, seed: int) -> Plan:
    preview = fog_scene.camera(min(scene.camera.width_px, _PREVIEW_WIDTH_PX))
    exposure = exposure_for(
        (scene.passes(density, preview)(seed) for density in densities), CLIPPED_SHARE
    )
    jobs = [
        Job(_stimulus(number, density), _Make(scene, density, number, exposure, seed))
        for number, density in enumerate(densities)
    ]
    details = {
        "camera": {"projection": "perspective", **asdict(scene.camera)},
        "unit": "metre",
        "sun": asdict(fog_scene.SUN) | {"colour": fog_scene.SUN_COLOUR},
        "lamps": [asdict(lamp) for lamp in scene.lamps()],
    }
    return Plan(jobs, exposure, fog_scene.OBJECTS, details)


def _stimulus(number: int, density: str) -> Stimulus:
    layer = layer_of(density)
    return Stimulus(
        id=f"main-{number:03d}-{density}",
        file=f"images/main-{number:03d}.png",
        factors={"density": density, "extinction_per_m": EXTINCTIONS_PER_M[density]},
        regions=regions_file(_STEM),
        truth={
            **truth_files(_STEM),
            "fog_way": _FOG_WAY,
            "radiance": f"truth/main-{number:03d}-radiance.exr",
        },
        details={"fog": layer and {**asdict(layer), "visibility": layer.visibility}},
    )


@dataclass(frozen=True)
class _Make:
    """Renders one image and writes its files."""

    scene: Lane
    density: str
    number: int
    exposure: float
    seed: int

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        write_truth(folder, _STEM, self.scene.truth)
        distance = read_channels(folder / truth_files(_STEM)["distance"])[..., 0]
        way = _layer("light").way(self.scene.camera, distance)
        write_channels(folder / _FOG_WAY, way)
        image = render_until(
            self.scene.passes(self.density, self.scene.camera),
            self.exposure,
            seed=self.seed + (self.number + 1) * SEEDS_APART,
            limit_of_255=NOISE_LIMITS["fog" if layer_of(self.density) else "clear"],
        )
        stimulus = _stimulus(self.number, self.density)
        write_channels(folder / stimulus.truth["radiance"], image.radiance)
        write_shown(folder / stimulus.file, image.radiance, self.exposure)
        return {
            "noise_rms_of_255": image.noise_rms_of_255,
            "passes": image.passes,
            "airlight": self._airlight(image.radiance, way),
        }

    def _airlight(self, radiance: Image, way: Image) -> list[float] | None:
        """Return the mean radiance where next to nothing but fog is seen, None if nowhere."""
        opaque = np.exp(-EXTINCTIONS_PER_M[self.density] * way) < _OPAQUE_TRANSMITTANCE
        return radiance[opaque].mean(axis=0).tolist() if opaque.any() else None
