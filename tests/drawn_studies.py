"""Stimulus sets of the form that the ready-made studies need, drawn in a moment."""

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image

from algorithms.files import sha256_of
from experiments.study import CHOOSES, Study
from stimuli.manifest import Factor, Role, Stimulus, StimulusSet

SIZE_PX: Final = (40, 30)
METHODS: Final = ("photon-mapped", "revolved", "image-based")
LIGHTS_DEG: Final = (0, 60, 120, 180)
OBJECTS: Final = ("pebble", "vertebra", "dolphin", "bull")

Cell = Mapping[str, Factor]


def cells_of(study: Study) -> list[tuple[Role, Cell]]:
    """Return the role and the factors of every image of a ready-made study's set."""
    match study.stimuli.set:
        case "fog-methods":
            scenes, methods = ("lane", "motorcycle"), tuple(f"fog-{n}" for n in range(6))
            compared = _cells("main", scene=scenes, method=methods, preset=("as-compared",))
            return [*compared, *_cells("main", scene=scenes, method=("a",), preset=("other",))]
        case "caustics":
            return [
                *_cells("main", object=OBJECTS, light_deg=LIGHTS_DEG, method=METHODS),
                *_cells("practice", object=("doll",), light_deg=(60,), method=METHODS),
            ]
        case "caustics-painted":
            painted = {"vase": range(4), "elephant": range(5)}
            return [
                cell
                for name, artists in painted.items()
                for method in ("ours", *(f"artist-{number}" for number in artists))
                for cell in _cells("main", object=(name,), method=(method,))
            ]
        case "stylisation":
            return _cells(
                "main",
                lighting=("original", "front", "back"),
                relit=("similar", "different"),
                style=("halftone", "multitone", "relighting"),
                depth=("real", "recovered"),
            )
        case "photographs":
            objects = ("santa", "robot", "clown")
            control: Cell = {"divergence_deg": 0, "object": "none", "inserted": 0}
            inserted = _cells("main", divergence_deg=(20, 30, 40), object=objects, inserted=(1,))
            both = _cells("main", divergence_deg=(20, 30), object=("santa+robot",), inserted=(2,))
            return [("main", control), *inserted, *both]
        case _:
            practice = _cells("practice", divergence_deg=(90, 80, 70), texture=("low",))
            textures = ("low", "high")
            return [*_cells("main", divergence_deg=range(0, 91, 10), texture=textures), *practice]


def draw_for(study: Study, folder: Path) -> StimulusSet:
    """Draw the set of a ready-made study; each image is a grey of its own."""
    folder.mkdir()
    regions = None
    objects = study.stimuli.choices or 8
    if study.task in (*CHOOSES, "free-viewing"):
        regions = "regions.png"
        labels = np.arange(SIZE_PX[0]) * objects // SIZE_PX[0] + 1
        _save(folder / regions, np.tile(labels, (SIZE_PX[1], 1)).astype(np.uint8))
    stimuli = []
    for number, (role, factors) in enumerate(cells_of(study)):
        _save(folder / f"{number}.png", np.full((*SIZE_PX[::-1], 3), 40 + 2 * number, np.uint8))
        stimuli.append(
            Stimulus(
                id=f"{role}-{number:03d}",
                file=f"{number}.png",
                role=role,
                factors=factors,
                answer=_answer(factors) if regions else None,
                regions=regions,
            )
        )
    return StimulusSet(
        name=study.stimuli.set,
        generator="tests.drawn_studies.draw_for",
        parameters={},
        seed=1,
        engine="drawn",
        versions={},
        exposure=1.0,
        objects={label: str(label) for label in range(1, objects + 1)},
        files={path.name: sha256_of(path) for path in sorted(folder.glob("*.png"))},
        stimuli=tuple(stimuli),
    ).write(folder)


def _answer(factors: Cell) -> int | tuple[int, int]:
    return (1, 2) if factors.get("inserted") == 2 else 1


def _cells(role: Role, **levels: Sequence[Factor]) -> list[tuple[Role, Cell]]:
    return [(role, dict(zip(levels, cell, strict=True))) for cell in product(*levels.values())]


def _save(path: Path, pixels: np.ndarray) -> None:
    Image.fromarray(pixels).save(path)
