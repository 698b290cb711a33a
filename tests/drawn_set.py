"""A stimulus set of the form of `divergence`: discs with a bright side, drawn without rendering."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from algorithms.files import sha256_of
from stimuli.manifest import Role, Stimulus, StimulusSet

WIDTH_PX, HEIGHT_PX, RADIUS_PX = 320, 180, 24
LETTERS = "abcdefgh"
KINDS = {"diffuse": "abcf", "shiny": "degh"}
LEVELS_DEG = tuple(range(0, 91, 10))
PLACEMENTS = ("front", "back", "front-back")


def draw_set(
    folder: Path,
    levels_deg: Sequence[int] = LEVELS_DEG,
    placements: Sequence[str] = PLACEMENTS,
    replicates: int = 1,
) -> StimulusSet:
    """Draw a small set named `divergence` with main, practice and example stimuli."""
    generator = np.random.default_rng(1)
    _save(folder / "regions.png", _regions())
    cells = [
        ("main", level, placement, kind, replicate)
        for replicate in range(replicates)
        for placement in placements
        for kind in KINDS
        for level in levels_deg
    ]
    cells += [("practice", 90, placement, "diffuse", 0) for placement in PLACEMENTS]
    cells += [("example", 90, "front", "shiny", 0)]
    stimuli = []
    for number, (role, level, placement, kind, replicate) in enumerate(cells):
        target = str(generator.choice(list(KINDS[kind])))
        label = LETTERS.index(target) + 1
        file = f"{number:04d}.png"
        _save(folder / file, _image(label, level, number))
        stimuli.append(
            Stimulus(
                id=f"{role}-{placement}-{kind}-{level:02d}-{target}-{replicate}",
                file=file,
                role=_role(role),
                factors={
                    "divergence_deg": level,
                    "placement": placement,
                    "material": kind,
                    "target": target,
                    "replicate": replicate,
                },
                answer=label if level else None,
                regions="regions.png",
            )
        )
    files = {path.name: sha256_of(path) for path in sorted(folder.glob("*.png"))}
    return StimulusSet(
        name="divergence",
        generator="tests.drawn_set.draw_set",
        parameters={},
        seed=1,
        engine="drawn",
        versions={},
        exposure=1.0,
        objects=dict(enumerate(LETTERS, start=1)),
        files=files,
        stimuli=tuple(stimuli),
    ).write(folder)


def _role(text: str) -> Role:
    assert text in ("main", "practice", "example")
    return text  # type: ignore[return-value]  # narrowed by the assertion


def _centres() -> list[tuple[int, int]]:
    return [(45 + 90 * row, 40 + 80 * column) for row in range(2) for column in range(4)]


def _regions() -> np.ndarray:
    rows, columns = np.mgrid[:HEIGHT_PX, :WIDTH_PX]
    labels = np.zeros((HEIGHT_PX, WIDTH_PX), np.uint8)
    for label, (row, column) in enumerate(_centres(), start=1):
        labels[(rows - row) ** 2 + (columns - column) ** 2 <= RADIUS_PX**2] = label
    return labels


def _image(target: int, level_deg: int, number: int) -> np.ndarray:
    columns = np.mgrid[:HEIGHT_PX, :WIDTH_PX][1]
    labels = _regions()
    image = np.full((HEIGHT_PX, WIDTH_PX, 3), 96, np.uint8)
    for label, (_, column) in enumerate(_centres(), start=1):
        side = np.cos(np.deg2rad(level_deg)) if label == target else 1.0
        shade = 140 + 80 * side * (columns - column) / RADIUS_PX
        inside = labels == label
        image[inside] = np.clip(shade[inside], 0, 255)[:, None].astype(np.uint8)
    image[0, 0] = (number % 256, number // 256, 0)  # no two files are alike
    return image


def _save(path: Path, pixels: np.ndarray) -> None:
    Image.fromarray(pixels).save(path)
