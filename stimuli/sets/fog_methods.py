"""Chapter 6: fog in two pictures, by our edit and by what people do without it, for comparison.

Lopez-Moreno 2011, sec. 6.4, has six renditions of one photograph: its method's, three artists' and
two laymen's. Those are not public; in their place stand edits that make the mistakes which the
thesis found in them, fog that is the same at all depths and fog with too many clouds, and simpler
methods. Of the `lane`, which is rendered, one rendition is path-traced: its fog is what a camera
would have seen. The `motorcycle` is a photograph whose depth was measured (Scharstein et al. 2014,
in scikit-image).

Besides, each picture stands in the fogs of table 6.1.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from skimage.data import stereo_motorcycle

from algorithms.color import FloatImage, decode_srgb
from algorithms.depth import distance_of_relief, perceptual_relief, scaled_distance
from algorithms.depth.files import Stereo, fill_unknown
from algorithms.fog import PRESETS, Fog, add_fog
from algorithms.images import write_channels
from stimuli.convergence import render_until
from stimuli.engine import choose_engine
from stimuli.exposure import exposure_for, write_shown
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Stimulus, StimulusSet
from stimuli.sets import fog as fog_set

Distance = NDArray[np.float32]

SCENES: Final = ("lane", "motorcycle")
METHODS: Final[Mapping[str, str]] = {
    "path-traced": "fog as a camera would have seen it",
    "image-based": "the edit, with the true distance",
    "planes": "the edit, with three planes of depth instead",
    "guessed": "the edit, with the relief that the picture suggests as depth",
    "no-scattering": "extinction and airlight alone, without glow and relighting",
    "veil": "fog that is equally thick at all depths",
    "clouds": "the edit, with too many clouds",
}
"""How the fog was made; the first of the lane alone, `guessed` of the motorcycle alone."""

AS_COMPARED: Final = "as-compared"
"""The fog that all methods have."""
PRESET_NAMES: Final = ("house-left", "forest-left", "statue-centre")
MOTORCYCLE: Final = Stereo(focal_px=994.978, baseline=0.193001, offset_px=31.086)

_DENSITY: Final = "medium"
_QUICK_DENSITY: Final = "light"
_THICKNESS: Final = 0.3  # per metre in the garage: a third of its wall, four metres away, is left
_CLOUD_PERIOD_IN_WIDTHS: Final = 0.2
_LAYERS: Final = (1 / 3, 2 / 3)  # quantiles of distance, between which a plane lies


@dataclass(frozen=True)
class Scene:
    """A picture without fog, and the fog that is added to it.

    Attributes
    ----------
    image
        Display-referred linear light, 0..1.
    distance
        Metres, or the way in the fog where it does not fill all of space.
    fog
        What the edit adds.
    path_traced
        The picture in that fog, rendered; None of a photograph.
    """

    image: FloatImage
    distance: Distance
    fog: Fog
    path_traced: FloatImage | None


def make(
    folder: Path,
    *,
    seed: int,
    quick: bool = False,
    engine: str | None = None,
    progress: Progress = no_progress,
) -> StimulusSet:
    """Render the lane with and without fog, and edit both pictures.

    Parameters
    ----------
    folder
        New, empty, or begun with the same arguments and versions.
    seed
        Draws the lane and the clouds; 0 or more.
    quick
        The lane in 128 pixels and thinner fog.
    engine
        `cuda`, `llvm`, `scalar`, or None for the fastest that works.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Factors `scene`, `method` and `preset`; the pictures without fog are
    examples. Of each image its `radiance`, display-referred, and the `distance`.

    Raises
    ------
    InputError
        If the seed is negative, or the folder holds something else or cannot be written to.
    UnavailableError
        If the requested engine does not work here.
    """
    chosen = choose_engine(engine)
    recipe = recipe_of("fog-methods", f"{__name__}.make", {"quick": quick}, seed, chosen)
    return make_set(folder, recipe, lambda: _plan(_Scenes(seed, quick=quick)), progress)


def design() -> tuple[Stimulus, ...]:
    """Return the images: of each scene as it is, six methods, and the fogs of table 6.1."""
    stimuli: list[Stimulus] = []
    for scene in SCENES:
        missing = "guessed" if scene == "lane" else "path-traced"
        methods = [method for method in METHODS if method != missing]
        cells = [("none", "none")]
        cells += [(method, AS_COMPARED) for method in methods]
        cells += [("image-based", preset) for preset in PRESET_NAMES]
        stimuli += [_stimulus(scene, *cell) for cell in cells]
    return tuple(stimuli)


def edited(scene: Scene, method: str, preset: str, generator: np.random.Generator) -> FloatImage:
    """Return a picture in fog, linear light.

    Parameters
    ----------
    scene
        The picture.
    method
        One of `METHODS`, or `none`.
    preset
        Of `algorithms.fog.PRESETS`, or `AS_COMPARED`.
    generator
        Draws the clouds.
    """
    if method == "none":
        return scene.image
    if method == "path-traced":
        assert scene.path_traced is not None  # the design has seen to it
        return scene.path_traced
    fog, distance = scene.fog, scene.distance
    if preset != AS_COMPARED:
        fog, distance = PRESETS[preset], scaled_distance(distance)
    if method == "planes":
        distance = _planes(distance)
    elif method == "guessed":
        distance = _guessed(scene)
    elif method == "no-scattering":
        fog = replace(fog, glow=0, desaturation=0, shadow_lift=0, highlight_attenuation=0)
    elif method == "veil":
        finite = distance[np.isfinite(distance)]
        distance = np.full_like(distance, np.median(finite))
    elif method == "clouds":
        period_px = _CLOUD_PERIOD_IN_WIDTHS * distance.shape[1]
        fog = replace(fog, noise_amplitude=1, noise_octaves=6, noise_period_px=period_px)
    return add_fog(scene.image, distance, fog, generator=generator)


def _planes(distance: Distance) -> Distance:
    """Return three planes of depth, each at its pixels' median."""
    near, far = np.quantile(distance[np.isfinite(distance)], _LAYERS)
    number = np.digitize(distance, [near, far])
    planes = np.empty_like(distance)
    for layer in range(3):
        inside = number == layer
        planes[inside] = np.median(distance[inside])
    return planes


def _guessed(scene: Scene) -> Distance:
    """Return the distances that dark-is-deep suggests, between the true nearest and farthest."""
    relief = perceptual_relief(scene.image, np.ones(scene.distance.shape, bool))
    return distance_of_relief(relief, *np.quantile(scene.distance, [0.01, 0.99]))


class _Scenes:
    """The two pictures, made when they are first needed."""

    def __init__(self, seed: int, *, quick: bool) -> None:
        self.seed, self._quick = seed, quick
        self._size = fog_set.QUICK if quick else fog_set.FULL

    def __getitem__(self, name: str) -> Scene:
        return self._lane if name == "lane" else self._motorcycle

    @cached_property
    def _lane(self) -> Scene:
        lane = fog_set.Lane(self._size, self.seed)
        density = _QUICK_DENSITY if self._quick else _DENSITY
        clear, foggy = (self._rendered(lane, each) for each in ("clear", density))
        exposure = exposure_for([clear], fog_set.CLIPPED_SHARE)
        layer = fog_set.layer_of(density)
        assert layer is not None  # neither of the two is clear air
        way = layer.way(lane.camera, lane.truth().distance)
        return Scene(
            np.clip(clear * np.float32(exposure), 0, 1),
            way.astype(np.float32),
            Fog(extinction=fog_set.EXTINCTIONS_PER_M[density]),
            np.clip(foggy * np.float32(exposure), 0, 1),
        )

    def _rendered(self, lane: fog_set.Lane, density: str) -> FloatImage:
        limit = fog_set.NOISE_LIMITS["clear" if density == "clear" else "fog"]
        passes = lane.passes(density, lane.camera)
        number = list(fog_set.EXTINCTIONS_PER_M).index(density)
        # One exposure for both, about that of the set: noise is judged as it is seen.
        exposure = exposure_for([passes(self.seed)], fog_set.CLIPPED_SHARE)
        first = self.seed + (number + 1) * fog_set.SEEDS_APART
        return render_until(passes, exposure, seed=first, limit_of_255=limit).radiance

    @cached_property
    def _motorcycle(self) -> Scene:
        left, _, disparity = stereo_motorcycle()
        distance = fill_unknown(*MOTORCYCLE.distance(disparity))
        image = decode_srgb(left / 255).astype(np.float32)
        fog = Fog(extinction=_THICKNESS, airlight=(0.5, 0.52, 0.54))
        return Scene(image, distance.astype(np.float32), fog, None)


def _plan(scenes: _Scenes) -> Plan:
    jobs = [Job(stimulus, _Make(stimulus, scenes)) for stimulus in design()]
    return Plan(jobs, 1.0, {}, {"unit": "metre", "methods": dict(METHODS)})


def _stimulus(scene: str, method: str, preset: str) -> Stimulus:
    stem = f"{scene}-{method}" if preset in ("none", AS_COMPARED) else f"{scene}-{preset}"
    return Stimulus(
        id=stem,
        file=f"images/{stem}.png",
        role="example" if method == "none" else "main",
        factors={"scene": scene, "method": method, "preset": preset},
        truth={"radiance": f"truth/{stem}-radiance.exr", "distance": f"truth/{scene}-distance.exr"},
    )


@dataclass(frozen=True)
class _Make:
    """Makes one image and writes its files."""

    stimulus: Stimulus
    scenes: _Scenes

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        factors = {name: str(level) for name, level in self.stimulus.factors.items()}
        scene = self.scenes[factors["scene"]]
        distance = folder / self.stimulus.truth["distance"]
        if not distance.is_file():
            write_channels(distance, scene.distance)
        generator = np.random.default_rng([self.scenes.seed, 6])
        image = edited(scene, factors["method"], factors["preset"], generator)
        write_channels(folder / self.stimulus.truth["radiance"], image)
        write_shown(folder / self.stimulus.file, image, 1.0)
        return {}
