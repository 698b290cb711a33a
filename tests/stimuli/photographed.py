"""Rendered "photographs" of one scene under several lights, in a folder as a user would have it."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from PIL import Image
from scipy.ndimage import gaussian_filter

from algorithms.color import FloatImage
from algorithms.images import write_image
from algorithms.light import Light
from stimuli.camera import View
from stimuli.engine import choose_engine
from stimuli.light_linking.render import make_renderer
from tests.stimuli.bodies import of_table

VIEW = View(width_px=260, height_px=110, radius_px=30, samples=16)
CENTRES = (-2.6, 0.0, 2.6)
NAMES = ("doll", "venus", "robot")
TURNS_DEG = (0, 20, 40)

TOML = """
reference = "light-0.png"
labels = "objects.png"
pairs = [["doll", "robot"]]

[photographs]
"light-0.png" = 0
"light-20.png" = 20
"light-40.png" = -40

[objects]
doll = 1
venus = 2
robot = 3
"""


def key(turn_deg: float) -> Light:
    """Return the key light, turned about the vertical axis."""
    azimuth, up = np.radians(turn_deg - 20), 0.6
    return Light.from_direction((np.sin(azimuth), up, np.cos(azimuth)), intensity=np.pi)


def take() -> tuple[dict[int, FloatImage], np.ndarray]:
    """Render the scene before a wall that is lit by the same light; return it and its labels."""
    choose_engine()
    objects = [of_table(letter, (x, 0)) for letter, x in zip("fbd", CENTRES, strict=True)]
    renderer = make_renderer(objects)
    fill = Light(90, 20, 0.5)
    grain = gaussian_filter(np.random.default_rng(1).normal(size=(110, 260)), 2)
    wall = 0.06 + 0.1 * grain
    across = np.linspace(-1, 1, 260)
    taken = {}
    for turn in TURNS_DEG:
        rendered = renderer.render(VIEW, [(key(turn), fill)] * 3)
        lit = wall * (0.8 + 0.3 * np.sin(np.radians(turn - 20)) * across + 0.002 * turn)
        image = rendered.radiance * 0.9 + (1 - rendered.coverage[..., None]) * lit[..., None]
        taken[turn] = np.minimum(image, 0.99).astype(np.float32)
    return taken, renderer.ground_truth(VIEW).regions


def write_folder(
    folder: Path, photographs: Mapping[int, FloatImage], labels: np.ndarray, toml: str = TOML
) -> Path:
    """Write photographs with their description and label image; return the folder."""
    folder.mkdir(exist_ok=True)
    for turn, image in photographs.items():
        write_image(folder / f"light-{turn}.png", image)
    Image.fromarray(labels.astype(np.uint8)).save(folder / "objects.png")
    (folder / "photographs.toml").write_text(toml, encoding="utf-8")
    return folder
