"""Make docs/pictures/fog-*: the point-spread function, and pictures in fog of published parameters.

    python -m docs.screenshots_fog DIR

DIR holds the set `fog`, as `trompe stimuli make fog DIR` leaves it. The photograph is
scikit-image's motorcycle with its measured disparity (Scharstein et al. 2014).
"""

import io
import sys
from pathlib import Path
from typing import Final

import numpy as np
from PIL import Image
from skimage.data import stereo_motorcycle

import stimuli
from algorithms.color import decode_srgb
from algorithms.depth.files import fill_unknown
from algorithms.files import write_atomically
from algorithms.images import read_channels, write_picture
from analysis.figures.fog_series import Scene, fog_series_figure, presets_of, published_series
from analysis.figures.fog_spread import fog_spread_figure
from analysis.figures.style import figure_bytes
from stimuli.manifest import StimulusSet
from stimuli.sets.fog_methods import MOTORCYCLE

PICTURES: Final = Path(__file__).parent / "pictures"


def motorcycle() -> Scene:
    """Return the photograph and its distance; what has no disparity takes its neighbour's."""
    picture, _, disparity = stereo_motorcycle()
    image = decode_srgb(picture / 255).astype(np.float32)
    return Scene(image, fill_unknown(*MOTORCYCLE.distance(disparity)).astype(np.float32))


def lane(made: StimulusSet) -> Scene:
    """Return the clear image of the set, and how far the light comes through its fog layer."""
    clear = made.stimuli[0]
    radiance, way = (
        read_channels(made.path(clear.truth[name])) for name in ("radiance", "fog_way")
    )
    return Scene(radiance * np.float32(made.exposure), np.minimum(way[..., 0], np.float32(150)))


def main() -> None:
    """Save the pictures."""
    write_atomically(PICTURES / "fog-spread.png", figure_bytes(fog_spread_figure(), "png"))
    scenes = {"lane (rendered)": lane(stimuli.load(Path(sys.argv[1]))), "motorcycle": motorcycle()}
    for name, fogs in (("series", published_series()), ("presets", presets_of("house"))):
        figure = fog_series_figure(scenes, fogs, np.random.default_rng(6))
        picture = Image.open(io.BytesIO(figure_bytes(figure, "png"))).convert("RGB")
        write_picture(PICTURES / f"fog-{name}.jpg", picture)


if __name__ == "__main__":
    main()
