"""How fast phase symmetry is, beside phasepack, how equal, and what memory it takes, as JSON.

    python -m benchmarks.phase_symmetry [--sizes 128 ... 4096] [--output FILE]

`peer`: both on one photograph of 512 x 512 pixels, 5 scales and 6 orientations, taken in turns, so
that both see the same machine. `sizes`: the time over squares, and over n log n pixels. `memory`:
the process's peak beyond what it held before, in bytes a pixel; images of more than a megapixel
are filtered in one stream instead of two.
"""

import argparse
import statistics
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage import data

from algorithms.symmetry import phase_symmetry
from benchmarks.memory import peak_growth_bytes
from benchmarks.results import machine, write_result

SIZES_PX = (128, 256, 512, 1024, 2048, 4096)
MEMORY_PX = (2048, 4096, 7072)  # the last: 50 megapixels
SCALES, ORIENTATIONS = 5, 6
ROUNDS = 9

Row = dict[str, Any]
Image = NDArray[np.float32]


def natural(size_px: int) -> Image:
    """Return the photograph, repeated by its mirror images or cut, in 0..1."""
    picture = data.camera().astype(np.float32) / 255
    tile = np.block([[picture, picture[:, ::-1]], [picture[::-1], picture[::-1, ::-1]]])
    repeats = -(-size_px // tile.shape[0])
    return np.ascontiguousarray(np.tile(tile, (repeats, repeats))[:size_px, :size_px])


def ours(image: Image) -> Image:
    """Return the symmetry with the same filters as phasepack's."""
    return phase_symmetry(image, scales=SCALES, orientations=ORIENTATIONS, angular="cosine")


def seconds(work: Callable[[], object]) -> float:
    """Return the time of one run."""
    started = time.perf_counter()
    work()
    return time.perf_counter() - started


def peer() -> Row:
    """Compare with phasepack, in turns."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it recommends a faster transform
        from phasepack import phasesym  # type: ignore[import-untyped]
    image = natural(512)
    exact = image.astype(np.float64)

    def theirs() -> Image:
        found: Image = phasesym(exact, nscale=SCALES, norient=ORIENTATIONS)[0]
        return found

    difference = float(np.abs(ours(image) - theirs()).max())
    times = [(seconds(lambda: ours(image)), seconds(theirs)) for _ in range(ROUNDS)]
    row: Row = {"size_px": 512, "scales": SCALES, "orientations": ORIENTATIONS}
    row |= {"ours_s": statistics.median(own for own, _ in times)}
    row |= {"phasepack_s": statistics.median(other for _, other in times)}
    row |= {"times_as_fast": statistics.median(other / own for own, other in times)}
    return row | {"largest_difference": difference}


def over_sizes(sizes_px: list[int]) -> list[Row]:
    """Return the time of each size, and over its n log n."""
    rows = []
    for size_px in sizes_px:
        image = natural(size_px)
        ours(image)
        rounds = 3 if size_px >= 2048 else ROUNDS
        taken = statistics.median(seconds(lambda image=image: ours(image)) for _ in range(rounds))  # type: ignore[misc]
        pixels = size_px**2
        rows.append(
            {
                "size_px": size_px,
                "seconds": taken,
                "ns_per_n_log2_n": 1e9 * taken / (pixels * np.log2(pixels)),
            }
        )
    return rows


def memory(size_px: int) -> Row:
    """Return the bytes a pixel that are taken beyond the image."""
    image = natural(size_px)
    taken = peak_growth_bytes(lambda: ours(image))
    return {"size_px": size_px, "bytes_per_pixel": taken / image.size}


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--sizes", nargs="+", type=int, default=list(SIZES_PX))
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    result: Row = {"machine": machine(), "peer": peer(), "sizes": over_sizes(arguments.sizes)}
    result["memory"] = [memory(size_px) for size_px in MEMORY_PX]
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
