"""Make docs/pictures/caustic-*: maps of 1 to 20 directions, and glass and caustics in a photograph.

    python -m docs.screenshots_caustics DIR

DIR holds the set `caustics`, as `trompe stimuli make caustics DIR` leaves it: its opaque objects
are what the maps are made from. The photograph is scikit-image's cup of coffee.
"""

import sys
from pathlib import Path
from typing import Final

import numpy as np

import stimuli
from algorithms.caustics import PRESETS, cast, maps_of
from algorithms.depth import perceptual_relief
from algorithms.files import write_atomically
from algorithms.images import read_channels, read_labels, write_image
from algorithms.transparency import make_transparent
from analysis.figures.caustic_maps import Shape, caustic_maps_figure
from analysis.figures.style import figure_bytes
from benchmarks.caustics import Scene, scene
from stimuli.manifest import StimulusSet

PICTURES: Final = Path(__file__).parent / "pictures"
LIGHT_DEG: Final = 60
MEGAPIXELS: Final = 0.24


def shapes_of(made: StimulusSet) -> dict[str, Shape]:
    """Return the shape that people would see in each opaque object of the set."""
    shapes = {}
    for stimulus in made.stimuli:
        if (stimulus.factors["method"], stimulus.factors["light_deg"]) == ("opaque", LIGHT_DEG):
            assert stimulus.regions is not None
            mask = read_labels(made.folder / stimulus.regions) > 0
            image = read_channels(made.folder / stimulus.truth["radiance"])
            name = str(stimulus.factors["object"])
            shapes[name] = Shape(perceptual_relief(image, mask), mask)
    return shapes


def before_and_after(view: Scene) -> np.ndarray:
    """Return the photograph, and the cup of glass with its caustics, side by side."""
    relief = perceptual_relief(view.image, view.mask)
    preset = PRESETS["vase"]
    glass = make_transparent(view.image, view.mask, relief)
    maps = maps_of(relief, view.mask, preset)
    after = cast(glass, maps, view.quad, preset, spared=view.mask)
    return np.concatenate([view.image, after], axis=1)


def main() -> None:
    """Save the pictures."""
    figure = caustic_maps_figure(shapes_of(stimuli.load(Path(sys.argv[1]))))
    write_atomically(PICTURES / "caustic-maps.png", figure_bytes(figure, "png"))
    write_image(PICTURES / "caustic-cup.jpg", before_and_after(scene(MEGAPIXELS)))


if __name__ == "__main__":
    main()
