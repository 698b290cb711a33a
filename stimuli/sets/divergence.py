"""Experiment 1: eight objects under one key light, one of them under another.

Lopez-Moreno 2011, sec. 2.3: sixty images of 1024 x 600, ten divergences between the two key lights
in each of three placements, with a diffuse or a shiny object under the wrong light. What the thesis
leaves open is taken as follows: the key lights turn about the vertical axis, around an elevation of
+45 (front), -45 (back) or 0 degrees (front-back) at azimuth 0; shapes and albedos are our own;
which of the two lights is the wrong one is drawn for each image; objects shade themselves only.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import product
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from algorithms.errors import InputError
from algorithms.images import read_image, write_channels, write_image, write_labels
from algorithms.light import Light
from stimuli.arrangement import BACKGROUND, COARSE, FULL, QUICK, place_objects
from stimuli.camera import View
from stimuli.engine import choose_engine
from stimuli.luminance_observer import HitRate, experienced_hit_rates, outlier_hit_rates
from stimuli.making import (
    Progress,
    Recipe,
    current_versions,
    digests,
    no_progress,
    open_set_folder,
)
from stimuli.manifest import Role, Stimulus, StimulusSet
from stimuli.materials import TABLE_2_1, Finish
from stimuli.render import Renderer, make_renderer
from stimuli.rigs import AMBIENT, CENTRE_ELEVATIONS_DEG, diverging_keys

LEVELS_DEG: Final = tuple(range(0, 91, 10))
FINISHES: Final[tuple[Finish, ...]] = ("diffuse", "shiny")
# Diffuse and shiny alternate; the two checkerboards stand at opposite corners.
MAIN_ORDER: Final = "dagbchfe"
PRACTICE_ORDER: Final = "hbecfgad"

_CLIPPED_SHARE: Final = 0.0005

Scene = Literal["main", "practice"]


@dataclass(frozen=True)
class Cell:
    """One image of the design.

    Attributes
    ----------
    role, number
        Its role in the set, and its place among the images of that role.
    divergence_deg
        The angle between the two key lights.
    placement
        Where they are: `front`, `back` or `front-back`.
    material
        The finish of the object under the wrong light.
    target
        That object's letter.
    replicate
        Counts the images with equal factors but for the target.
    side
        +1 if the wrong light is the one turned towards the viewer, else -1.
    """

    role: Role
    number: int
    divergence_deg: int
    placement: str
    material: Finish
    target: str
    replicate: int
    side: int

    @property
    def id(self) -> str:
        """The stimulus' id, readable by researchers and never shown to participants."""
        return (
            f"{self.role}-{self.number:03d}-{self.placement}-{self.material}"
            f"-{self.divergence_deg:02d}-{self.target}"
        )

    @property
    def file(self) -> str:
        """Where its image goes."""
        return f"images/{self.role}-{self.number:03d}.png"

    @property
    def order(self) -> str:
        """The letters of its scene's objects in reading order."""
        return MAIN_ORDER if self.role == "main" else PRACTICE_ORDER

    @property
    def lights(self) -> tuple[Light, Light]:
        """The key light of the other objects, and the target's."""
        return diverging_keys(self.placement, self.divergence_deg, self.side)

    def keys(self) -> list[Light]:
        """Return the key light of each object in reading order."""
        key, wrong = self.lights
        return [wrong if letter == self.target else key for letter in self.order]


def make(
    folder: Path,
    *,
    seed: int,
    quick: bool = False,
    replicates: int = 1,
    engine: str | None = None,
    progress: Progress = no_progress,
) -> StimulusSet:
    """Render the set, or what is missing of it.

    Parameters
    ----------
    folder
        New, empty, or begun with the same arguments and versions.
    seed
        Draws shapes, textures and targets; 0 or more.
    quick
        Half the width, and half of the images: the finish of the target alternates over the cells.
    replicates
        Images a cell, each with another target until all four objects of the finish have been it:
        with four or a multiple of four, object and level are crossed.
    engine
        `cuda`, `llvm`, `scalar`, or None for the fastest that works.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Of every image: factors `divergence_deg`, `placement`, `material`, `target`
    and `replicate`; the target's region as the answer, None at 0 degrees; `regions`, and the ground
    truth `distance`, `normal` and `albedo`, which all images of one scene share; its lights.

    Raises
    ------
    InputError
        If an argument is out of range, or the folder holds something else or cannot be written to.
    UnavailableError
        If the requested engine does not work here.
    """
    for name, value, lowest in (("seed", seed, 0), ("replicates", replicates, 1)):
        if value < lowest:
            raise InputError(f"{name}: {value} given, {lowest} or more accepted")
    chosen = choose_engine(engine)
    parameters = {"quick": quick, "replicates": replicates}
    recipe = Recipe(
        "divergence", f"{__name__}.make", parameters, seed, chosen, current_versions(chosen)
    )
    if finished := open_set_folder(folder, recipe):
        return finished
    cells = plan(np.random.default_rng([seed, 0]), quick=quick, replicates=replicates)
    view = QUICK if quick else FULL
    exposure = _render_missing(folder, cells, view, seed, progress)
    return _describe(folder, recipe, cells, exposure, view)


def plan(generator: np.random.Generator, *, quick: bool, replicates: int) -> tuple[Cell, ...]:
    """Return the images of the design: the main ones, those for practice, and the example."""
    cells: list[Cell] = []

    def add(
        role: Role, level: int, placement: str, finish: Finish, target: str, replicate: int = 0
    ) -> None:
        number = sum(cell.role == role for cell in cells)
        side = int(generator.choice([-1, 1]))
        cells.append(Cell(role, number, level, placement, finish, target, replicate, side))

    for (i, placement), finish, (j, level) in product(
        enumerate(CENTRE_ELEVATIONS_DEG), FINISHES, enumerate(LEVELS_DEG)
    ):
        if quick and FINISHES[(i + j) % 2] != finish:
            continue
        letters = generator.permutation(_letters(finish))
        for replicate in range(replicates):
            add("main", level, placement, finish, letters[replicate % len(letters)], replicate)
    practice: tuple[Finish, ...] = ("diffuse", "shiny", "diffuse")
    for placement, finish in zip(CENTRE_ELEVATIONS_DEG, practice, strict=True):
        add("practice", 90, placement, finish, generator.choice(_letters(finish)))
    add("example", 90, "front-back", "diffuse", "f")
    return tuple(cells)


def _letters(finish: Finish) -> list[str]:
    return [letter for letter, material in TABLE_2_1.items() if material.finish == finish]


class _Scenes:
    """The renderers of the two scenes, each built when it is first needed."""

    def __init__(self, seed: int) -> None:
        self._seed = seed
        self._renderers: dict[str, Renderer] = {}

    def of(self, cell: Cell) -> Renderer:
        if cell.order not in self._renderers:
            stream = 1 if cell.order == MAIN_ORDER else 2
            objects = place_objects(cell.order, np.random.default_rng([self._seed, stream]))
            self._renderers[cell.order] = make_renderer(objects, AMBIENT)
        return self._renderers[cell.order]


def _scene_name(cell: Cell) -> Scene:
    return "main" if cell.role == "main" else "practice"


def _render_missing(
    folder: Path, cells: Sequence[Cell], view: View, seed: int, progress: Progress
) -> float:
    scenes = _Scenes(seed)
    exposure = _exposure(scenes, cells)
    (folder / "images").mkdir(exist_ok=True)
    (folder / "truth").mkdir(exist_ok=True)
    for cell in {_scene_name(cell): cell for cell in cells}.values():
        _write_truth(folder, cell, scenes, view)
    for done, cell in enumerate(cells):
        progress(done, len(cells))
        if not (folder / cell.file).is_file():
            radiance, coverage = scenes.of(cell).radiance(view, cell.keys())
            background = (1 - coverage[..., None]) * np.float32(BACKGROUND)
            write_image(folder / cell.file, radiance * np.float32(exposure) + background)
    progress(len(cells), len(cells))
    return exposure


def _exposure(scenes: _Scenes, cells: Sequence[Cell]) -> float:
    """Return the exposure at which, over small versions of all images, few pixels are clipped."""
    peaks = [scenes.of(cell).radiance(COARSE, cell.keys())[0].max(axis=-1) for cell in cells]
    return float(1 / np.quantile(np.array(peaks), 1 - _CLIPPED_SHARE))


def _truth_files(scene: Scene) -> dict[str, str]:
    return {name: f"truth/{scene}-{name}.exr" for name in ("distance", "normal", "albedo")}


def _regions_file(scene: Scene) -> str:
    return f"truth/{scene}-regions.png"


def _write_truth(folder: Path, cell: Cell, scenes: _Scenes, view: View) -> None:
    scene = _scene_name(cell)
    files = _truth_files(scene)
    if all((folder / file).is_file() for file in (_regions_file(scene), *files.values())):
        return
    truth = scenes.of(cell).ground_truth(view)
    write_labels(folder / _regions_file(scene), truth.regions)
    for name, file in files.items():
        write_channels(folder / file, getattr(truth, name))


def _describe(
    folder: Path, recipe: Recipe, cells: Sequence[Cell], exposure: float, view: View
) -> StimulusSet:
    described: dict[str, Any] = {
        **asdict(recipe),
        "exposure": exposure,
        "objects": dict(enumerate(MAIN_ORDER, start=1)),
        "files": digests(folder),
        "stimuli": tuple(_stimulus(cell) for cell in cells),
    }
    shown = StimulusSet(**described).in_folder(folder)
    details = {
        "camera": {"projection": "orthographic", **asdict(view)},
        "background_display": BACKGROUND,
        "clipped_share": _clipped_share(folder, cells),
        "luminance_observers": {
            "outlier": [_rate(rate) for rate in outlier_hit_rates(shown, "divergence_deg")],
            "experienced": [_rate(rate) for rate in experienced_hit_rates(shown, "divergence_deg")],
        },
    }
    return StimulusSet(**described, details=details).write(folder)


def _rate(rate: HitRate) -> dict[str, float]:
    return asdict(rate) | {"hit_rate": rate.hits / rate.images}


def _stimulus(cell: Cell) -> Stimulus:
    scene = _scene_name(cell)
    key, wrong = cell.lights
    return Stimulus(
        id=cell.id,
        file=cell.file,
        role=cell.role,
        factors={
            "divergence_deg": cell.divergence_deg,
            "placement": cell.placement,
            "material": cell.material,
            "target": cell.target,
            "replicate": cell.replicate,
        },
        answer=cell.order.index(cell.target) + 1 if cell.divergence_deg else None,
        regions=_regions_file(scene),
        truth=_truth_files(scene),
        details={
            "objects": {str(label): letter for label, letter in enumerate(cell.order, start=1)},
            "key": asdict(key),
            "target_key": asdict(wrong),
            "ambient": [asdict(light) for light in AMBIENT],
        },
    )


def _clipped_share(folder: Path, cells: Sequence[Cell]) -> float:
    """Return the share of pixels of the whole set that reached the top of the scale."""
    shares = [(read_image(folder / cell.file) >= 1).any(axis=-1).mean() for cell in cells]
    return float(np.mean(shares))
