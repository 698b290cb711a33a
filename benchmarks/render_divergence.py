"""Speed, memory and noise of the images of experiment 1, beside Mitsuba's path tracer, as JSON.

    python -m benchmarks.render_divergence [--engine llvm] [--output FILE]

The limits are those of the project on two processor cores: 60 images of 1024 x 600 in two minutes,
less than 3 GB, and at most 1/255 RMS against 256 samples a pixel, in encoded values as displayed.
"""

import argparse
import resource
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.color import encode_srgb
from benchmarks.results import machine, write_result
from stimuli.camera import View
from stimuli.engine import choose_engine
from stimuli.light_linking.arrangement import BACKGROUND, FULL, QUICK
from stimuli.light_linking.render import Renderer, Rig, make_renderer
from stimuli.light_linking.rigs import AMBIENT, CENTRE_ELEVATIONS_DEG, diverging_keys
from stimuli.making import current_versions
from stimuli.sets import divergence
from stimuli.truth import Image
from tests.stimuli.path_tracer import PathTracer

Render = Callable[[], tuple[Image, Image]]

SEED = 2011
PLACEMENTS = tuple(CENTRE_ELEVATIONS_DEG)
TARGET = 2  # the shiny object in the middle of the upper row
REFERENCE_SAMPLES = 256
LIMITS = {"seconds": 120.0, "gigabytes": 3.0, "rms_of_255": 1.0}


@dataclass(frozen=True)
class Made:
    """What making the whole set took."""

    images: int
    seconds: float
    seconds_before_first_image: float
    seconds_per_image: float
    gigabytes: float
    exposure: float
    clipped_share: float


def make_full_set(engine: str | None) -> Made:
    """Make the full set in a folder that is thrown away; call it in a process of its own."""
    times_s: list[float] = []
    started = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        made = divergence.make(
            Path(folder),
            seed=SEED,
            engine=engine,
            progress=lambda _done, _total: times_s.append(time.perf_counter()),
        )
    seconds = time.perf_counter() - started
    kibibytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return Made(
        images=len(made.stimuli),
        seconds=seconds,
        seconds_before_first_image=times_s[0] - started,
        seconds_per_image=float(np.median(np.diff(times_s))),
        gigabytes=kibibytes * 1024 / 1e9,
        exposure=made.exposure,
        clipped_share=made.details["clipped_share"],
    )


def renderer_of_set() -> Renderer:
    """Build the main scene for the engine that is set."""
    generator = np.random.default_rng([SEED, 1])
    return make_renderer(divergence.place_letters(divergence.MAIN_ORDER, generator))


def rigs_of(placement: str) -> list[Rig]:
    """Return the lights as of an image at 90 degrees."""
    key, wrong = diverging_keys(placement, 90, 1)
    numbers = range(len(divergence.MAIN_ORDER))
    return [(wrong if number == TARGET else key, *AMBIENT) for number in numbers]


def linked_picture(renderer: Renderer, view: View, rigs: list[Rig]) -> tuple[Image, Image]:
    """Return radiance and coverage of our renderer's picture."""
    made = renderer.render(view, rigs)
    return made.radiance, made.coverage


def displayed(image: tuple[Image, Image], exposure: float) -> NDArray[np.float64]:
    """Return radiance and coverage as encoded values, 0..255."""
    radiance, coverage = image
    background = (1 - coverage[..., None]) * BACKGROUND
    return 255 * encode_srgb(radiance * exposure + background)


def rms(one: NDArray[Any], other: NDArray[Any]) -> float:
    """Return the root mean square of the difference."""
    return float(np.sqrt(((one - other) ** 2).mean()))


def noise(renderer: Renderer, view: View, exposure: float) -> dict[str, float]:
    """Return the RMS difference from many samples, in 1/255 of the display, by placement."""
    reference = replace(view, samples=REFERENCE_SAMPLES)
    return {
        placement: rms(
            *(
                displayed(linked_picture(renderer, each, rigs_of(placement)), exposure)
                for each in (view, reference)
            )
        )
        for placement in PLACEMENTS
    }


def seconds_of(render: Render) -> float:
    """Return the median of five calls; an earlier one has compiled."""
    seconds = []
    for _ in range(5):
        started = time.perf_counter()
        render()
        seconds.append(time.perf_counter() - started)
    return float(np.median(seconds))


def beside_the_path_tracer(renderer: Renderer, exposure: float) -> dict[str, float]:
    """Compare time and noise at equal samples, under one key light for all objects."""
    key, _ = diverging_keys("front", 0, 1)
    rigs: list[Rig] = [(key, *AMBIENT)] * len(renderer.objects)
    view = QUICK
    tracer = PathTracer(renderer.objects, (key, *AMBIENT), view)
    renders: dict[str, Render] = {
        "linked": lambda: linked_picture(renderer, view, rigs),
        "path": lambda: tracer.render(view.samples, seed=1),
    }
    images = {name: displayed(render(), exposure) for name, render in renders.items()}
    seconds = {name: seconds_of(render) for name, render in renders.items()}
    references = {
        "linked": linked_picture(renderer, replace(view, samples=REFERENCE_SAMPLES), rigs),
        "path": tracer.render(REFERENCE_SAMPLES, seed=2),
    }
    errors = {name: rms(images[name], displayed(references[name], exposure)) for name in images}
    return {
        "samples": view.samples,
        "linked_seconds": seconds["linked"],
        "path_seconds": seconds["path"],
        "linked_rms_of_255": errors["linked"],
        "path_rms_of_255": errors["path"],
        "time_ratio": seconds["path"] / seconds["linked"],
        "error_ratio": errors["path"] / errors["linked"],
    }


def beside_the_scalar_engine(linked: Renderer, exposure: float) -> dict[str, dict[str, float]]:
    """Return the RMS difference of the scalar engine's images, in 1/255, and the largest."""

    def pictures_of(renderer: Renderer) -> dict[str, NDArray[np.float64]]:
        return {
            p: displayed(linked_picture(renderer, QUICK, rigs_of(p)), exposure) for p in PLACEMENTS
        }

    pictures = pictures_of(linked)
    choose_engine("scalar")
    superposed = pictures_of(renderer_of_set())
    differences = {p: pictures[p] - superposed[p] for p in PLACEMENTS}
    return {
        p: {
            "rms_of_255": rms(difference, np.zeros(())),
            "largest_of_255": float(np.abs(difference).max()),
        }
        for p, difference in differences.items()
    }


def run(engine: str | None) -> dict[str, Any]:
    """Run everything."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        made = pool.submit(make_full_set, engine).result()
    chosen = choose_engine(engine)
    result: dict[str, Any] = {
        "machine": machine(),
        "engine": chosen,
        "versions": current_versions(chosen),
        "limits": LIMITS,
        "full_set": asdict(made),
    }
    renderer = renderer_of_set()
    result["rms_of_255_against_256_samples"] = noise(renderer, FULL, made.exposure)
    if chosen != "scalar":
        result["beside_the_path_tracer"] = beside_the_path_tracer(renderer, made.exposure)
        result["beside_the_scalar_engine"] = beside_the_scalar_engine(renderer, made.exposure)
    result["within_limits"] = {
        "seconds": made.seconds <= LIMITS["seconds"],
        "gigabytes": made.gigabytes < LIMITS["gigabytes"],
        "rms_of_255": max(result["rms_of_255_against_256_samples"].values())
        <= LIMITS["rms_of_255"],
    }
    return result


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--engine", help="cuda, llvm or scalar; else the fastest that works")
    parser.add_argument("--output", type=Path, help="a file instead of the terminal")
    given = parser.parse_args()
    write_result(run(given.engine), given.output)


if __name__ == "__main__":
    main()
