"""Experiment 2: whether a checkerboard hides the one object under another light.

Lopez-Moreno 2011, sec. 2.4: forty images of 1024 x 600, four checkerboards, each with tiles half as
large as those of the one before, times ten divergences between the two key lights, front-back. The
object under the wrong light has the image's checkerboard; the shapes and checkerboards of all
objects are drawn anew for each image. The coat's shininess is half of experiment 1's: half the
Blinn-Phong exponent, which makes the highlight wider and dimmer. The ratio of the two albedos is
fixed so that a light tile in shadow is about as luminous as a dark tile in light.

What the thesis leaves open is taken as follows: `CHECKERBOARDS` says how wide the tiles are, and
each checkerboard stands on two objects of an image; how much light both tiles of an object reflect
is drawn as well, lest its brightness alone tell of its light; which of the two lights is the wrong
one is drawn for each image; the rest is as in experiment 1.
"""

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Final

import numpy as np

from algorithms.errors import InputError
from stimuli.engine import choose_engine
from stimuli.light_linking.arrangement import FULL, OBJECTS, QUICK, place_objects
from stimuli.light_linking.linked_set import LEVELS_DEG, LinkedImage, linked_plan
from stimuli.light_linking.materials import ROUGHNESS, Material, exponent_of, roughness_of
from stimuli.light_linking.placed_objects import Placed
from stimuli.light_linking.rigs import diverging_keys
from stimuli.making import Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Role, StimulusSet

CHECKERBOARDS: Final = {"low": 2, "medium": 4, "medium-high": 8, "high": 16}
"""Tiles along a quarter of an object's circumference; experiment 1 has about four."""

ALBEDO_RATIO: Final = 2.4
"""Of light and dark tiles: measured on renders, the median radiance of light tiles that the key
light does not reach is about that of dark tiles that it does."""

LIGHT_ALBEDOS: Final = (0.195, 0.2, 0.22, 0.26, 0.32, 0.42, 0.59, 0.88)
"""Of the light tiles of an image's eight objects, in an order that is drawn. Were all alike, an
observer of brightness alone would find more than half of the targets."""

HALF_SHININESS: Final = roughness_of(exponent_of(ROUGHNESS) / 2)
"""The roughness of half the Blinn-Phong exponent of experiment 1's shiny objects."""

_QUICK_COARSENESS: Final = 2


@dataclass(frozen=True)
class Cell:
    """One image of the design.

    Attributes
    ----------
    role, number
        Its role in the set, and its place among the images of that role.
    divergence_deg
        The angle between the two key lights.
    checkerboards
        Their names, of the objects in reading order.
    light_albedos
        Of the objects' light tiles, in the same order.
    target
        The number of the object under the wrong light, from 1.
    replicate
        Counts the images with equal factors but for the target.
    side
        +1 if the wrong light is the one turned towards the viewer, else -1.
    """

    role: Role
    number: int
    divergence_deg: int
    checkerboards: tuple[str, ...]
    light_albedos: tuple[float, ...]
    target: int
    replicate: int
    side: int

    @property
    def texture(self) -> str:
        """The target's checkerboard."""
        return self.checkerboards[self.target - 1]

    def image(self) -> LinkedImage:
        """Return what is to be rendered; its scene is its own."""
        key, target_key = diverging_keys("front-back", self.divergence_deg, self.side)
        stem = f"{self.role}-{self.number:03d}"
        return LinkedImage(
            id=f"{stem}-{self.texture}-{self.divergence_deg:02d}-{self.target}",
            role=self.role,
            number=self.number,
            factors={
                "divergence_deg": self.divergence_deg,
                "texture": self.texture,
                "target": self.target,
                "replicate": self.replicate,
            },
            scene=stem,
            objects=self.checkerboards,
            target=self.target,
            key=key,
            target_key=target_key,
        )

    def place(self, seed: int, coarseness: int) -> list[Placed]:
        """Return the objects of its scene."""
        materials = [
            Material(
                "shiny",
                "squares",
                (albedo / ALBEDO_RATIO, albedo),
                CHECKERBOARDS[name] / (np.pi / 2),
                HALF_SHININESS,
            )
            for name, albedo in zip(self.checkerboards, self.light_albedos, strict=True)
        ]
        stream = ("main", "practice", "example").index(self.role) + 1
        generator = np.random.default_rng([seed, stream, self.number])
        return place_objects(materials, generator, coarseness)


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
        Half the width, coarser meshes, and a quarter of the images: one checkerboard at each
        divergence.
    replicates
        Images a cell, each with another object as its target until all eight have been it: with
        eight or a multiple of eight, place and level are crossed.
    engine
        `cuda`, `llvm`, `scalar`, or None for the fastest that works.
    progress
        Called after each image.

    Returns
    -------
    The set, as written. Of every image: factors `divergence_deg`, `texture`, `target` (its number
    in reading order) and `replicate`; the target's region as the answer, None at 0 degrees;
    `regions`, and the ground truth `distance`, `relief`, `normal`, `albedo` and `shading`; its
    lights, and the checkerboards of its objects.

    Raises
    ------
    InputError
        If an argument is out of range, or the folder holds something else or cannot be written to.
    UnavailableError
        If the requested engine does not work here.
    """
    if replicates < 1:
        raise InputError(f"replicates: {replicates} given, 1 or more accepted")
    parameters = {"quick": quick, "replicates": replicates}
    recipe = recipe_of("texture", f"{__name__}.make", parameters, seed, choose_engine(engine))

    def plan_set() -> Plan:
        cells = plan(np.random.default_rng([seed, 0]), quick=quick, replicates=replicates)
        images = {cell.image().scene: cell for cell in cells}

        def place(scene: str, coarseness: int) -> list[Placed]:
            return images[scene].place(seed, max(coarseness, _QUICK_COARSENESS if quick else 1))

        return linked_plan(
            [cell.image() for cell in cells],
            place,
            QUICK if quick else FULL,
            {number: f"place {number}" for number in range(1, OBJECTS + 1)},
            coarseness=4,
            recurring=False,
        )

    return make_set(folder, recipe, plan_set, progress)


def plan(generator: np.random.Generator, *, quick: bool, replicates: int) -> tuple[Cell, ...]:
    """Return the images of the design: the main ones, those for practice, and the example."""
    cells: list[Cell] = []

    def add(role: Role, level: int, texture: str, target: int, replicate: int = 0) -> None:
        others = [name for name in CHECKERBOARDS for _ in range(OBJECTS // len(CHECKERBOARDS))]
        others.remove(texture)
        names = generator.permutation(others).tolist()
        names.insert(target - 1, texture)
        cells.append(
            Cell(
                role,
                sum(cell.role == role for cell in cells),
                level,
                tuple(names),
                tuple(generator.permutation(LIGHT_ALBEDOS).tolist()),
                target,
                replicate,
                side=int(generator.choice([-1, 1])),
            )
        )

    for (i, texture), (j, level) in product(enumerate(CHECKERBOARDS), enumerate(LEVELS_DEG)):
        if quick and j % len(CHECKERBOARDS) != i:
            continue
        targets = 1 + generator.permutation(OBJECTS)
        for replicate in range(replicates):
            add("main", level, texture, int(targets[replicate % OBJECTS]), replicate)
    for texture in ("low", "medium-high", "high"):
        add("practice", 90, texture, int(generator.integers(1, OBJECTS + 1)))
    add("example", 90, "medium", 6)
    return tuple(cells)
