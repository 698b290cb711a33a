"""Chapter 9: translucent objects of measured media, from which a medium is to be recovered.

Lopez-Moreno 2011, sec. 9.3 to 9.5: single images of homogeneous bodies under one distant light,
seen orthographically, with the front and back irradiance maps that the method rests on (eq. 9.2).
The media are those of table 9.2 and two more that its figures show, ketchup and skin.

What the thesis leaves open is taken as follows. Objects: a heart as in fig. 9.5, and in place of
its skull and its other figures a pebble, convex all over, a creature with limbs and a rugged lump.
Light: from the front, from the side and from behind. Size: bounding spheres have a radius of 10 mm,
where the media differ most in how translucent they look; the heart comes in three more sizes (fig.
9.4 and 9.6). There are no highlights, as the method discards them, and light that has left a body
does not meet it again.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.images import write_channels, write_labels
from algorithms.light import Light
from stimuli.camera import CAMERA_DISTANCE, View
from stimuli.convergence import render_until
from stimuli.engine import choose_engine
from stimuli.exposure import exposure_for, write_shown
from stimuli.light_linking.arrangement import BACKGROUND
from stimuli.light_linking.rigs import KEY_INTENSITY
from stimuli.making import Job, Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Factor, Stimulus, StimulusSet
from stimuli.scenes.translucent_bodies import SHAPES, Bodies
from stimuli.translucency.media import MEASURED
from stimuli.translucency.renderer import TranslucentRenderer
from stimuli.translucency.two_sides import TwoSides, two_sides
from stimuli.truth import regions_file

FULL: Final = View(width_px=512, height_px=512, radius_px=230, samples=4)
QUICK: Final = View(width_px=128, height_px=128, radius_px=58, samples=9)
_COARSE: Final = View(width_px=48, height_px=48, radius_px=22, samples=1)

MEDIA: Final = (
    "apple",
    "cream",
    "marble",
    "potato",
    "skimmilk",
    "wholemilk",
    "ketchup",
    "skin1",
)
LIGHTS: Final = {
    "front": Light(135, 45, KEY_INTENSITY),
    "side": Light(20, 0, KEY_INTENSITY),
    "back": Light(60, -45, KEY_INTENSITY),
}
RADIUS_MM: Final = 10.0
OTHER_RADII_MM: Final = (2.5, 5.0, 20.0)

_COARSE_POINTS: Final = 2000
_SEEDS_AN_IMAGE: Final = 10_000


@dataclass(frozen=True)
class TranslucentImage:
    """One image of the design.

    Attributes
    ----------
    number
        Its place in the set.
    shape, medium, light
        Names out of `SHAPES`, `MEDIA` and `LIGHTS`.
    radius_mm
        Of the object's bounding sphere.
    """

    number: int
    shape: str
    medium: str
    light: str
    radius_mm: float

    @property
    def factors(self) -> dict[str, Factor]:
        """The levels that made it."""
        return {
            "object": self.shape,
            "medium": self.medium,
            "radius_mm": self.radius_mm,
            "light": self.light,
        }

    @property
    def body(self) -> tuple[str, str, float]:
        """What `Bodies` needs to know of it."""
        return self.shape, self.medium, self.radius_mm

    @property
    def irradiance_stem(self) -> str:
        """What the irradiance maps are called: they are shared where only the medium differs."""
        index = MEASURED[self.medium].refractive_index
        return f"{self.shape}-{self.light}-index-{index:g}"

    def stimulus(self) -> Stimulus:
        """Return it as it stands in the manifest."""
        stem = f"main-{self.number:03d}"
        own = {"radiance": f"truth/{stem}-radiance.exr"}
        shape = {name: f"truth/{self.shape}-{name}.exr" for name in _SHAPE_TRUTH}
        entering = {name: f"truth/{self.irradiance_stem}-{name}.exr" for name in _IRRADIANCES}
        return Stimulus(
            id=f"{stem}-{self.shape}-{self.medium}-{self.radius_mm:g}mm-{self.light}",
            file=f"images/{stem}.png",
            factors=self.factors,
            regions=regions_file(self.shape),
            truth={name.replace("-", "_"): file for name, file in (own | shape | entering).items()},
            details={"lights": [asdict(LIGHTS[self.light])]},
        )


_SHAPE_TRUTH: Final = ("distance", "relief", "normal", "back-relief", "back-normal")
_IRRADIANCES: Final = ("irradiance", "back-irradiance")


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
        Draws the shapes and the samples; 0 or more.
    quick
        Small, two objects of two media, and one other size.
    engine
        `cuda`, `llvm`, or None for the fastest that works.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Of every image: factors `object`, `medium`, `radius_mm` and `light`; the
    object's region; as ground truth the scene-referred `radiance`, `distance`, `relief`, `normal`,
    `back_relief`, `back_normal`, and the irradiance that enters front and back, `irradiance` and
    `back_irradiance`, in the image's pixels; its light; the noise left. Of the set: each medium's
    coefficients, and its R_d by object and size, over distances in widths of the object.

    Raises
    ------
    InputError
        If the seed is negative, or the folder holds something else or cannot be written to.
    UnavailableError
        If the engine does not work here, or is the scalar one.
    """
    recipe = recipe_of(
        "translucency", f"{__name__}.make", {"quick": quick}, seed, choose_engine(engine)
    )
    return make_set(folder, recipe, lambda: _plan(seed, quick), progress)


def design(*, quick: bool) -> tuple[TranslucentImage, ...]:
    """Return the images: objects by media by lights, then the heart in other sizes."""
    objects = ("heart", "creature") if quick else SHAPES
    media = ("marble", "skin1") if quick else MEDIA
    radii = OTHER_RADII_MM[:1] if quick else OTHER_RADII_MM
    cells = [
        *((*levels, RADIUS_MM) for levels in product(objects, media, LIGHTS)),
        *(("heart", medium, "front", radius) for medium in media for radius in radii),
    ]
    return tuple(TranslucentImage(number, *cell) for number, cell in enumerate(cells))


def _plan(seed: int, quick: bool) -> Plan:
    images, view, bodies = design(quick=quick), QUICK if quick else FULL, Bodies(seed)
    exposure = exposure_for(
        TranslucentRenderer(bodies.body(*image.body), _COARSE_POINTS).radiance(
            _COARSE, [LIGHTS[image.light]], samples=1, seed=seed
        )[0]
        for image in images
    )
    media = dict.fromkeys(image.medium for image in images)
    return Plan(
        [Job(image.stimulus(), _Make(image, bodies, view, exposure, seed)) for image in images],
        exposure,
        dict(enumerate(SHAPES, start=1)),
        {
            "camera": {"projection": "orthographic", **asdict(view)},
            "background_display": BACKGROUND,
            "media": {name: asdict(MEASURED[name]) for name in media},
            "profiles": [
                bodies.profile(*body) for body in dict.fromkeys(image.body for image in images)
            ],
        },
    )


@dataclass(frozen=True)
class _Make:
    """Makes one image."""

    image: TranslucentImage
    bodies: Bodies
    view: View
    exposure: float
    seed: int

    def __call__(self, folder: Path) -> Mapping[str, Any]:
        stimulus = self.image.stimulus()
        renderer = TranslucentRenderer(self.bodies.body(*self.image.body))
        light = LIGHTS[self.image.light]

        def render(seed: int) -> NDArray[np.float32]:
            return np.dstack(
                renderer.radiance(self.view, [light], samples=self.view.samples, seed=seed)
            )

        seed = self.seed + _SEEDS_AN_IMAGE * self.image.number
        made = render_until(render, self.exposure, seed=seed)
        self._write_truth(folder, stimulus, light)
        write_channels(folder / stimulus.truth["radiance"], made.radiance.astype(np.float16))
        picture = folder / stimulus.file
        write_shown(picture, made.radiance, self.exposure, made.coverage, BACKGROUND)
        return {"noise_rms_of_255": made.noise_rms_of_255, "passes": made.passes}

    def _write_truth(self, folder: Path, stimulus: Stimulus, light: Light) -> None:
        """Write what images share, unless it is there."""
        assert stimulus.regions is not None
        files = {name: folder / file for name, file in stimulus.truth.items() if name != "radiance"}
        if all(file.is_file() for file in (folder / stimulus.regions, *files.values())):
            return
        scene = self.bodies.scene(self.image.shape)
        sides = two_sides(scene, self.view)
        index = MEASURED[self.image.medium].refractive_index
        maps = _shape_maps(sides, self.view)
        maps["irradiance"], maps["back_irradiance"] = sides.irradiance(scene, [light], index)
        number = np.uint8(SHAPES.index(self.image.shape) + 1)
        write_labels(folder / stimulus.regions, sides.inside * number)
        for name, file in files.items():
            kind = np.float16 if "irradiance" in name else np.float32
            write_channels(file, maps[name].astype(kind))


def _shape_maps(sides: TwoSides, view: View) -> dict[str, NDArray[np.float32]]:
    relief, back_relief = sides.relief(view)
    distance = np.where(sides.inside, CAMERA_DISTANCE - sides.front.position[..., 2], np.inf)
    return {
        "distance": distance.astype(np.float32),
        "relief": relief,
        "back_relief": back_relief,
        "normal": sides.front.normal.astype(np.float32),
        "back_normal": sides.back.normal.astype(np.float32),
    }
