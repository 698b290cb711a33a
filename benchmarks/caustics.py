"""How long caustics and glass take from a photograph to the result, and what memory, as JSON.

    python -m benchmarks.caustics [--megapixels ...] [--memory-megapixels ...] [--output FILE]

The photograph is scikit-image's cup of coffee, enlarged; the cup is outlined by hand, and its
caustics fall on the table beside it. `times`: the relief, the maps (1 and 20 directions), the added
light and their sum; then glass, with the background filled in, and a lifted shadow. `memory`: the
process's peak beyond the photograph and what it held, in bytes a pixel and channel.
"""

import argparse
import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage import data, draw
from skimage.transform import resize

from algorithms.caustics import Caustics, add_caustics, cast, caustic_map, maps_of
from algorithms.color import FloatImage, decode_srgb
from algorithms.depth import perceptual_relief
from algorithms.shadows import lift_shadow
from algorithms.transparency import make_transparent
from benchmarks.memory import peak_growth_bytes
from benchmarks.results import machine, write_result

RIM = (290, 110, 118, 92)  # of the cup: x, y of the centre, half width and height
BODY = (
    *((172, 110), (176, 150), (190, 195), (205, 232), (225, 262), (262, 281)),
    *((300, 285), (340, 270), (365, 240), (385, 200), (400, 160), (408, 110)),
)
HANDLE = ((205, 232), (198, 270), (196, 296), (208, 309), (225, 305), (232, 285), (262, 260))
SHADOW = ((90, 290), (190, 270), (260, 370), (160, 380))
QUAD = ((400, 150), (560, 120), (590, 330), (395, 300))
ROUNDS = 3

Row = dict[str, Any]


@dataclass(frozen=True)
class Scene:
    """The photograph at a size, with what a user marks in it."""

    image: FloatImage
    mask: NDArray[np.bool_]
    shadow: NDArray[np.bool_]
    quad: NDArray[np.float64]


def scene(megapixels: float) -> Scene:
    """Return the photograph with so many pixels."""
    picture = data.coffee()
    factor = np.sqrt(megapixels * 1e6 / (picture.shape[0] * picture.shape[1]))
    shape = tuple(round(extent * factor) for extent in picture.shape[:2])
    large = resize(picture.astype(np.float32) / 255, shape, order=1)
    mask = _polygon(BODY, factor, shape) | _polygon(HANDLE, factor, shape)
    x, y, half_width, half_height = np.array(RIM) * factor
    mask[draw.ellipse(y, x, half_height, half_width, shape)] = True
    return Scene(
        decode_srgb(large).astype(np.float32),
        mask,
        _polygon(SHADOW, factor, shape),
        np.array(QUAD) * factor,
    )


def _polygon(
    corners: tuple[tuple[int, int], ...], factor: float, shape: tuple[int, ...]
) -> NDArray[np.bool_]:
    x, y = np.array(corners).T * factor
    return np.asarray(draw.polygon2mask(shape, np.stack([y, x], axis=1)))


def with_caustics(view: Scene) -> FloatImage:
    """Do what `trompe edit caustics` does."""
    settings = Caustics()
    relief = perceptual_relief(view.image, view.mask)
    maps = maps_of(relief, view.mask, settings)
    return cast(view.image, maps, view.quad, settings, spared=view.mask)


def seconds(work: Callable[[], object]) -> float:
    """Return the median time of some runs, after one that does not count."""
    work()
    times = []
    for _ in range(ROUNDS):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def times(megapixels: float) -> Row:
    """Return what the parts and the whole take."""
    view, settings = scene(megapixels), Caustics()
    image, mask = view.image, view.mask
    relief = perceptual_relief(image, mask)
    maps = caustic_map(relief, mask, settings.directions)
    return {
        "megapixels": megapixels,
        "relief_s": seconds(lambda: perceptual_relief(image, mask)),
        "maps_s": seconds(lambda: caustic_map(relief, mask, settings.directions)),
        "adding_s": seconds(lambda: add_caustics(image, maps, view.quad, settings.strengths)),
        "caustics_s": seconds(lambda: with_caustics(view)),
        "glass_s": seconds(lambda: make_transparent(image, mask, relief)),
        "shadow_s": seconds(lambda: lift_shadow(image, view.shadow)),
    }


def memory(megapixels: float) -> Row:
    """Return the bytes a pixel and channel that each edit takes beyond the photograph."""
    view = scene(megapixels)
    relief = perceptual_relief(view.image, view.mask)
    edits: dict[str, Callable[[], object]] = {
        "relief": lambda: perceptual_relief(view.image, view.mask),
        "caustics": lambda: with_caustics(view),
        "glass": lambda: make_transparent(view.image, view.mask, relief),
        "shadow": lambda: lift_shadow(view.image, view.shadow),
    }
    taken = {name: peak_growth_bytes(edit) / view.image.size for name, edit in edits.items()}
    return {"megapixels": megapixels, "bytes_per_pixel_and_channel": taken}


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--megapixels", nargs="*", type=float, default=[0.24, 1, 4])
    parser.add_argument("--memory-megapixels", nargs="*", type=float, default=[1, 4, 50])
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    result: Row = {"machine": machine()}
    result["times"] = [times(size) for size in arguments.megapixels]
    result["memory"] = [memory(size) for size in arguments.memory_megapixels]
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
