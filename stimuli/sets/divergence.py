"""Experiment 1: eight objects under one key light, one of them under another.

Lopez-Moreno 2011, sec. 2.3: sixty images of 1024 x 600, ten divergences between the two key lights
in each of three placements, with a diffuse or a shiny object under the wrong light. What the thesis
leaves open is taken as follows: the key lights turn about the vertical axis, around an elevation of
+45 (front), -45 (back) or 0 degrees (front-back) at azimuth 0; shapes and albedos are our own;
which of the two lights is the wrong one is drawn for each image; objects shade themselves only.
"""

from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Final

import numpy as np

from algorithms.errors import InputError
from stimuli.engine import choose_engine
from stimuli.light_linking.arrangement import FULL, QUICK, place_objects
from stimuli.light_linking.linked_set import LEVELS_DEG, LinkedImage, linked_plan
from stimuli.light_linking.materials import TABLE_2_1, Finish
from stimuli.light_linking.placed_objects import Placed
from stimuli.light_linking.rigs import CENTRE_ELEVATIONS_DEG, diverging_keys
from stimuli.making import Plan, Progress, make_set, no_progress, recipe_of
from stimuli.manifest import Role, StimulusSet

FINISHES: Final[tuple[Finish, ...]] = ("diffuse", "shiny")
# Diffuse and shiny alternate; the two checkerboards stand at opposite corners.
MAIN_ORDER: Final = "dagbchfe"
PRACTICE_ORDER: Final = "hbecfgad"


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
    def order(self) -> str:
        """The letters of its scene's objects in reading order."""
        return MAIN_ORDER if self.role == "main" else PRACTICE_ORDER

    def image(self) -> LinkedImage:
        """Return what is to be rendered."""
        key, target_key = diverging_keys(self.placement, self.divergence_deg, self.side)
        return LinkedImage(
            id=self.id,
            role=self.role,
            number=self.number,
            factors={
                "divergence_deg": self.divergence_deg,
                "placement": self.placement,
                "material": self.material,
                "target": self.target,
                "replicate": self.replicate,
            },
            scene="main" if self.role == "main" else "practice",
            objects=self.order,
            target=self.order.index(self.target) + 1,
            key=key,
            target_key=target_key,
        )


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
    truth `distance`, `relief`, `normal` and `albedo`, which all images of one scene share;
    `shading`; its lights.

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
    recipe = recipe_of("divergence", f"{__name__}.make", parameters, seed, choose_engine(engine))

    def place(scene: str, coarseness: int) -> list[Placed]:
        order, stream = {"main": (MAIN_ORDER, 1), "practice": (PRACTICE_ORDER, 2)}[scene]
        return place_letters(order, np.random.default_rng([seed, stream]), coarseness)

    def plan_set() -> Plan:
        cells = plan(np.random.default_rng([seed, 0]), quick=quick, replicates=replicates)
        names = dict(enumerate(MAIN_ORDER, start=1))
        images = [cell.image() for cell in cells]
        return linked_plan(images, place, QUICK if quick else FULL, names)

    return make_set(folder, recipe, plan_set, progress)


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


def place_letters(order: str, generator: np.random.Generator, coarseness: int = 1) -> list[Placed]:
    """Return the objects of table 2.1 in an order of their letters; see `place_objects`."""
    return place_objects([TABLE_2_1[letter] for letter in order], generator, coarseness)


def _letters(finish: Finish) -> list[str]:
    return [letter for letter, material in TABLE_2_1.items() if material.finish == finish]
