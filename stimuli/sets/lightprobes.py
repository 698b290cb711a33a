"""Chapter 3: light probes, single objects under known lights that are to be recovered.

Lopez-Moreno 2011, sec. 3.8, and sec. 9.5 for translucent ones. Each image shows one object before a
neutral background, orthographically. Groups:

- `rig`: the five rigs of table 3.1, measured on photographs that we do not have. An apple, a head
  and a chequered cushion stand in for those; all lights of a rig are equally strong.
- `three-lights`: table 3.2 and fig. 3.9, shapes O1 to O4 and materials O5 to O8.
- `area`: fig. 3.14, a round light of two sizes. `distance`: a point light at six distances, of
  equal irradiance at the nearest point, and one infinitely far away.
- `gloss` and `texture`: one light on one shape, from matt to glossy and from plain to fine.
- `single` and `pair`: one light all around O1 to O4, and two of all separations and ratios.
- `translucent`: fig. 9.8 and 9.9, marble of three sizes by the dipole.

Light is direct, with an object's shadows on itself; light from one part of it to another is left
out. `ambient` light comes from evenly bright surroundings. What the thesis does not state (shapes,
textures, intensities, sizes and distances) are the constants below.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from itertools import combinations, product
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.images import write_channels
from algorithms.light import Light
from stimuli.camera import View
from stimuli.convergence import render_until
from stimuli.engine import choose_engine
from stimuli.exposure import exposure_for, write_shown
from stimuli.light_linking.arrangement import BACKGROUND
from stimuli.light_linking.render import Rendered, Renderer, make_renderer
from stimuli.light_linking.rigs import KEY_INTENSITY
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Factor, Stimulus, StimulusSet
from stimuli.scenes.probe_lights import TABLE_3_1, TABLE_3_2, disc, light_of_chapter_3, surroundings
from stimuli.scenes.probe_objects import GLOSS_EXPONENTS, PROBES, TEXTURE_FREQUENCIES
from stimuli.shapes.displaced_spheres import LIGHTPROBES
from stimuli.translucency.media import MEASURED
from stimuli.translucency.renderer import Translucent, TranslucentRenderer
from stimuli.truth import regions_file, truth_files, write_truth

FULL: Final = View(width_px=512, height_px=512, radius_px=230, samples=16)
QUICK: Final = View(width_px=160, height_px=160, radius_px=72, samples=9)
_COARSE: Final = View(width_px=64, height_px=64, radius_px=29, samples=4)

RIG_PROBES: Final = {
    "apple1": "apple",
    "apple2": "apple",
    "apple3": "apple",
    "guitar": "head",
    "quilt": "quilt",
}
AMBIENT: Final = 0.15
"""Irradiance of the surroundings where there are any, as a share of the strongest light's."""

AREA_RADII_DEG: Final = (10.0, 30.0)
DISTANCES: Final = (1.5, 2.0, 3.0, 5.0, 8.0, 16.0)
"""Of point lights from the object's centre, in its radii."""

AZIMUTHS_DEG: Final = tuple(range(10, 360, 30))
ELEVATIONS_DEG: Final = (-30, 0, 30, 60)
SEPARATIONS_DEG: Final = (50, 70, 90, 120, 150, 180)
RATIOS: Final = (1, 2, 3)

MEDIUM: Final = "marble"
RADII_MM: Final = (100.0, 20.0, 5.0)
"""Of translucent probes: the smaller, the more light passes through."""

FIGURE_9_8: Final = (145.0, 45.0)
FIGURE_9_9: Final = ((120.0, 0.0), (60.0, 30.0), (225.0, 20.0), (330.0, -20.0))
"""Azimuth and elevation; of fig. 9.9 the text names the first."""

_LIGHTS_A_SAMPLE: Final = 64
_QUICK_COUNT: Final = 5
_QUICK_COARSENESS: Final = 4
_QUICK_POINTS: Final = 20_000
_SEEDS_AN_IMAGE: Final = 10_000


@dataclass(frozen=True)
class ProbeImage:
    """One image of the design.

    Attributes
    ----------
    group
        As in the module's description.
    probe
        A name out of `stimuli.scenes.probe_objects.PROBES`.
    lights
        In the project's frame, the strongest first.
    ambient
        Irradiance of the surroundings, as a share of `KEY_INTENSITY`.
    area_radius_deg
        Of the one light where it is wide, else 0.
    radius_mm
        Of the object where it is translucent, else 0.
    number
        Its place in the set.
    """

    group: str
    probe: str
    lights: tuple[Light, ...]
    ambient: float = 0.0
    area_radius_deg: float = 0.0
    radius_mm: float = 0.0
    number: int = 0

    @property
    def factors(self) -> dict[str, Factor]:
        """The levels that made it; see `make`."""
        probe, strongest = PROBES[self.probe], self.lights[0]
        intensities = [light.intensity for light in self.lights]
        pairs = combinations([light.azimuth_deg for light in self.lights], 2)
        apart = [abs((first - second + 180) % 360 - 180) for first, second in pairs]
        return {
            "group": self.group,
            "probe": self.probe,
            "complexity": probe.complexity,
            "texture_frequency": probe.material.frequency,
            "gloss": round(probe.gloss, 6),
            "lights": len(self.lights),
            "separation_deg": round(min(apart, default=0.0), 6),
            "intensity_ratio": round(max(intensities) / min(intensities), 6),
            "ambient": self.ambient,
            "azimuth_deg": strongest.azimuth_deg,
            "elevation_deg": strongest.elevation_deg,
            "distance": strongest.distance or 0.0,
            "area_radius_deg": self.area_radius_deg,
            "medium": MEDIUM if self.radius_mm else "opaque",
            "radius_mm": self.radius_mm,
        }

    def stimulus(self) -> Stimulus:
        """Return it as it stands in the manifest."""
        stem = f"main-{self.number:03d}"
        shared = truth_files(self.probe)
        if self.radius_mm:
            del shared["albedo"]  # of a surface that light does not enter
        own = {name: f"truth/{stem}-{name}.exr" for name in ("radiance", "shading")}
        return Stimulus(
            id=f"{stem}-{self.group}-{self.probe}",
            file=f"images/{stem}.png",
            factors=self.factors,
            regions=regions_file(self.probe),
            truth=shared | own,
            details={
                "lights": [asdict(light) for light in self.lights],
                "ambient_irradiance": self.ambient * KEY_INTENSITY,
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
        Draws shapes, textures and the lights of pairs; 0 or more.
    quick
        Small, and a few images of each group.
    engine
        `cuda`, `llvm`, `scalar`, or None for the fastest that works. The scalar one leaves the
        translucent probes out and takes hours for the full set.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Of every image the object's region; as ground truth the scene-referred
    `radiance`, `shading`, `distance`, `relief`, `normal` and, unless it is translucent, `albedo`;
    its lights and the irradiance of its surroundings. Factors: `group`; `probe`; its `complexity`
    (0..1, -1 for shapes that are not of O1 to O4's family), `texture_frequency` (0 for plain ones)
    and `gloss` (about the Blinn-Phong exponent, 0 for matt ones); the number of `lights`, the
    smallest `separation_deg` of their azimuths (0 for one light) and the `intensity_ratio` of the
    strongest to the weakest; `ambient`; the strongest light's `azimuth_deg`, `elevation_deg`,
    `distance` (in object radii, 0 for one infinitely far away) and `area_radius_deg` (0 for a
    point); `medium` and `radius_mm` of translucent probes.

    Raises
    ------
    InputError
        If the seed is negative, or the folder holds something else or cannot be written to.
    UnavailableError
        If the requested engine does not work here.
    """
    chosen = choose_engine(engine)
    recipe = recipe_of("lightprobes", f"{__name__}.make", {"quick": quick}, seed, chosen)

    def plan_set() -> Plan:
        images = design(np.random.default_rng([seed, 0]), quick=quick)
        if chosen == "scalar":
            images = [image for image in images if not image.radius_mm]
        studio = Studio(seed, quick)
        exposure = exposure_for(
            studio.picture(image, _COARSE).radiance for image in images if not image.radius_mm
        )
        jobs = [Job(image.stimulus(), _Make(image, studio, exposure)) for image in images]
        details = {
            "camera": {"projection": "orthographic", **asdict(studio.view)},
            "background_display": BACKGROUND,
            "left_out": ["interreflection"]
            + (["translucent probes: they need llvm or cuda"] if chosen == "scalar" else []),
        }
        return Plan(jobs, exposure, {1: "probe"}, details)

    return make_set(folder, recipe, plan_set, progress)


def design(generator: np.random.Generator, *, quick: bool) -> list[ProbeImage]:
    """Return the images in their order; a quick set takes some of every group."""
    groups = [
        list(group)
        for group in (
            _rigs(),
            _three_lights(),
            _area_lights(),
            _distances(),
            # No surroundings: in the narrow reflection of a glossy rim many lights are not even.
            _surfaces("gloss", ("gloss-0", *GLOSS_EXPONENTS), 0.0),
            _surfaces("texture", ("O2", *TEXTURE_FREQUENCIES), AMBIENT),
            _singles(),
            _pairs(generator),
            _translucent(),
        )
    ]
    if quick:
        groups = [_some(group, generator) for group in groups]
    images = [image for group in groups for image in group]
    return [replace(image, number=number) for number, image in enumerate(images)]


def _some(group: list[ProbeImage], generator: np.random.Generator) -> list[ProbeImage]:
    count = min(_QUICK_COUNT, len(group))
    return [group[index] for index in sorted(generator.permutation(len(group))[:count])]


def _rigs() -> Iterator[ProbeImage]:
    for rig, probe in RIG_PROBES.items():
        lights = tuple(light_of_chapter_3(*angles) for angles in TABLE_3_1[rig])
        yield ProbeImage("rig", probe, lights, AMBIENT)


def _three_lights() -> Iterator[ProbeImage]:
    lights = tuple(light_of_chapter_3(*angles) for angles in TABLE_3_2)
    for probe in (*LIGHTPROBES, *TEXTURE_FREQUENCIES):
        yield ProbeImage("three-lights", probe, lights)


def _area_lights() -> Iterator[ProbeImage]:
    for radius_deg, probe in product(AREA_RADII_DEG, ("O1", "O3")):
        light = Light(135, 20, KEY_INTENSITY)
        yield ProbeImage("area", probe, (light,), area_radius_deg=radius_deg)


def _distances() -> Iterator[ProbeImage]:
    for distance in (*DISTANCES, None):
        nearest = 1 if distance is None else (1 - 1 / distance) ** 2
        yield ProbeImage("distance", "O1", (Light(30, 10, nearest * KEY_INTENSITY, distance),))


def _surfaces(group: str, probes: Sequence[str], ambient: float) -> Iterator[ProbeImage]:
    for light, probe in product(
        (Light(135, 45, KEY_INTENSITY), Light(20, 5, KEY_INTENSITY)), probes
    ):
        yield ProbeImage(group, probe, (light,), ambient)


def _singles() -> Iterator[ProbeImage]:
    """Yield a grid of directions in which each object meets all azimuths and elevations."""
    probes = tuple(LIGHTPROBES)
    for (i, azimuth_deg), (j, elevation_deg) in product(
        enumerate(AZIMUTHS_DEG), enumerate(ELEVATIONS_DEG)
    ):
        light = Light(azimuth_deg, elevation_deg, KEY_INTENSITY)
        ambient = (0.0, AMBIENT)[i // 2 % 2]
        yield ProbeImage("single", probes[(i + j) % len(probes)], (light,), ambient)


def _pairs(generator: np.random.Generator) -> Iterator[ProbeImage]:
    probes = tuple(LIGHTPROBES)
    cells = product(SEPARATIONS_DEG, RATIOS, (0.0, AMBIENT))
    for number, (separation_deg, ratio, ambient) in enumerate(cells):
        azimuth_deg = round(generator.uniform(0, 360), 1)
        first_deg, second_deg = generator.uniform(-25, 45, size=2).round(1).tolist()
        lights = (
            Light(azimuth_deg, first_deg, KEY_INTENSITY),
            Light((azimuth_deg + separation_deg) % 360, second_deg, KEY_INTENSITY / ratio),
        )
        yield ProbeImage("pair", probes[number % len(probes)], lights, ambient)


def _translucent() -> Iterator[ProbeImage]:
    cells = [
        *product(("O1", "O3", "O4"), RADII_MM, (FIGURE_9_8,)),
        *product(("O2",), RADII_MM, FIGURE_9_9),
    ]
    for probe, radius_mm, angles in cells:
        light = Light(*angles, KEY_INTENSITY)
        yield ProbeImage("translucent", probe, (light,), radius_mm=radius_mm)


class Studio:
    """Takes pictures of the probes; what several images need is kept."""

    def __init__(self, seed: int, quick: bool) -> None:
        self.view = QUICK if quick else FULL
        self.seed = seed
        self._coarseness = _QUICK_COARSENESS if quick else 1
        self._points = _QUICK_POINTS if quick else None
        self.renderer = cache(self._renderer)
        self._surroundings = cache(self._new_surroundings)

    def picture(self, image: ProbeImage, view: View) -> Rendered:
        """Return an image under all its lights, as of an opaque object."""
        wide = image.area_radius_deg > 0
        lights = image.lights
        if wide:
            lights = disc(lights[0], image.area_radius_deg, _LIGHTS_A_SAMPLE * view.samples)
        made = self.renderer(image.probe).render(view, [lights], dealt=wide)
        if not image.ambient:
            return made
        return made.lit_also_as(self._surroundings(image.probe, view), image.ambient)

    def translucent(self, image: ProbeImage) -> TranslucentRenderer:
        """Return the renderer of an image of a translucent object."""
        mesh = PROBES[image.probe].mesh(self.seed, self._coarseness)
        body = Translucent(mesh, MEASURED[MEDIUM], image.radius_mm)
        return TranslucentRenderer(body, self._points)

    def _renderer(self, probe: str) -> Renderer:
        return make_renderer([PROBES[probe].placed(self.seed, self._coarseness)])

    def _new_surroundings(self, probe: str, view: View) -> Rendered:
        lights = surroundings(KEY_INTENSITY, _LIGHTS_A_SAMPLE * view.samples)
        return self.renderer(probe).render(view, [lights], dealt=True)


@dataclass(frozen=True)
class _Make:
    """Makes one image."""

    image: ProbeImage
    studio: Studio
    exposure: float

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        stimulus, view, studio = self.image.stimulus(), self.studio.view, self.studio
        truth = studio.renderer(self.image.probe).ground_truth
        write_truth(folder, self.image.probe, lambda: truth(view))
        made = studio.picture(self.image, view)
        measured: Mapping[str, Any] = {}
        if self.image.radius_mm:
            made, measured = self._translucent(made)
        for name in ("radiance", "shading"):
            values = getattr(made, name).astype(np.float16)
            write_channels(folder / stimulus.truth[name], values)
        picture = folder / stimulus.file
        write_shown(picture, made.radiance, self.exposure, made.coverage, BACKGROUND)
        return measured

    def _translucent(self, opaque: Rendered) -> tuple[Rendered, dict[str, Any]]:
        """Return the picture of the translucent object, and the noise that is left in it."""
        renderer, view = self.studio.translucent(self.image), self.studio.view

        def render(seed: int) -> NDArray[np.float32]:
            return np.dstack(renderer.radiance(view, self.image.lights, samples=4, seed=seed))

        seed = self.studio.seed + _SEEDS_AN_IMAGE * self.image.number
        made = render_until(render, self.exposure, seed=seed)
        coverage = opaque.coverage if made.coverage is None else made.coverage
        measured = {"noise_rms_of_255": made.noise_rms_of_255, "passes": made.passes}
        return Rendered(made.radiance, coverage, opaque.shading), measured
