"""Relief and fog from one picture: speed, memory, and error against what was rendered, as JSON.

    python -m benchmarks.depth_and_fog [--parts speed fog relief] [--fog SET] [--still-life SET]
        [--photos DIR] [--output FILE]

`speed`: time and peak memory over sizes. `fog`: the edit of the clear image of the set `fog`
against the path-traced images (`volpath`), with the exact way of light in the fog, and with
distances that a user has instead; airlight from the clear picture, or measured where the fogged one
is thickest, three numbers. `relief`: as in table 8.1 of the thesis, the three lightings of the set
`still-life` against the true depth, of each object and of the scene; also of the photographs in
DIR (`*/diffuse.png`, `mask.png`, `depth.npz`: the MIT intrinsic images).
"""

import argparse
import statistics
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage.metrics import structural_similarity

from algorithms.color import encode_srgb, luminance
from algorithms.depth import (
    distance_of_relief,
    layered_distance,
    perceptual_relief,
    receding_distance,
    silhouette_relief,
)
from algorithms.fog import PRESETS, Fog, add_fog, white_level
from algorithms.images import read_channels, read_image, read_labels
from benchmarks.memory import peak_growth_bytes
from benchmarks.results import machine, write_result
from stimuli import StimulusSet, load

SIZES_PX = (512, 1024, 2048, 4096)
LIGHTINGS = ("original", "front", "back")
REPEATS = 5
THICKEST_PERCENTILE = 98
SMALLEST_OBJECT_PX = 400

Row = dict[str, Any]
Plane = NDArray[np.floating[Any]]
Mask = NDArray[np.bool_]


def speed() -> Iterator[Row]:
    """Yield median time and peak memory of each edit at each size."""
    for size_px in SIZES_PX:
        generator = np.random.default_rng(1)
        small = generator.uniform(0, 1, (size_px // 16, size_px // 16, 3)).astype(np.float32)
        image = np.repeat(np.repeat(small, 16, axis=0), 16, axis=1)
        image += generator.uniform(0, 0.05, image.shape).astype(np.float32)
        rows, columns = (np.arange(size_px) + 0.5) / size_px - 0.5, np.arange(size_px) / size_px
        disc = rows[:, None] ** 2 + (columns - 0.5) ** 2 < 0.23
        distance = np.repeat(np.linspace(1, 0.05, size_px, dtype=np.float32)[:, None], size_px, 1)
        edits: dict[str, Callable[[], object]] = {
            "silhouette_relief": lambda disc=disc: silhouette_relief(disc),  # type: ignore[misc]
            "perceptual_relief": lambda image=image, disc=disc: perceptual_relief(image, disc),  # type: ignore[misc]
            "fog": lambda image=image, distance=distance: add_fog(image, distance, Fog(1.0)),  # type: ignore[misc]
            "fog_with_noise": lambda image=image, distance=distance: add_fog(  # type: ignore[misc]
                image, distance, PRESETS["house-left"], generator=np.random.default_rng(1)
            ),
        }
        for name, edit in edits.items():
            peak = peak_growth_bytes(edit)
            yield {
                "edit": name,
                "megapixels": size_px**2 / 1e6,
                "seconds": _seconds(edit),
                "bytes_per_pixel_and_channel": peak / size_px**2 / 3,
            }


def _seconds(work: Callable[[], object]) -> float:
    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def fog(images: StimulusSet) -> Iterator[Row]:
    """Yield the error of each way to add fog, by density."""
    clear, *fogged = images.stimuli
    before = read_channels(images.path(clear.truth["radiance"]))
    view_deg = float(images.details["camera"]["field_of_view_deg"])
    truth = images.path(clear.truth["fog_way"]), images.path(clear.truth["distance"])
    way, distance = (read_channels(path)[..., 0] for path in truth)
    sky = ~np.isfinite(distance)
    for stimulus in fogged:
        after = read_channels(images.path(stimulus.truth["radiance"]))
        rate = float(stimulus.factors["extinction_per_m"])
        asymmetry = float(stimulus.details["fog"]["asymmetry"])
        thickest = way > np.percentile(way, THICKEST_PERCENTILE)
        red, green, blue = (after[thickest].mean(axis=0) / white_level(before)).tolist()
        default = Fog(rate, forward_scattering=asymmetry)
        ways = {
            "as it was": (None, default),
            "exact": (way, default),
            "exact, airlight measured": (
                way,
                replace(default, airlight=(red, green, blue)),
            ),
            "exact, without glow": (way, replace(default, glow=0)),
            "perceptual": (_perceptual(before, way), default),
            "two planes by hand": (_planes(way, sky), default),
        }
        for name, (depth, medium) in ways.items():
            edited = before
            if depth is not None:
                edited = add_fog(before, depth, medium, field_of_view_deg=view_deg)
            row: Row = {"density": stimulus.factors["density"], "depth": name}
            yield row | _errors(edited, after, sky, images.exposure)


def _perceptual(image: Plane, way: Plane) -> Plane:
    """Return the distance of the picture's perceptual relief, between ends that a user knows."""
    near, far = np.percentile(way, [2, 98])
    relief = perceptual_relief(image, np.ones(image.shape[:2], bool))
    return distance_of_relief(relief, float(near), float(far))


def _planes(way: Plane, sky: Mask) -> Plane:
    """Return a ground that recedes from the lower border to the horizon, and the sky selected."""
    height, width = way.shape
    # Level ground, the horizon in the row below which most of the sky ends.
    horizon = float(np.flatnonzero(sky.any(axis=1))[-1])
    middle = width / 2
    nearest = float(np.median(way[-1]))
    ground = receding_distance(
        (height, width), (middle, height), (middle, horizon), nearest, np.inf
    )
    farthest = float(np.percentile(way, 98))
    ground = np.minimum(ground, np.float32(farthest))
    return layered_distance([~sky], [ground], float(np.median(way[sky])))


def _errors(edited: Plane, truth: Plane, sky: Mask, exposure: float) -> Row:
    error = np.abs(luminance(edited) / luminance(truth) - 1)
    shown = [encode_srgb(picture * exposure) for picture in (edited, truth)]
    return {
        "median_relative_error": float(np.median(error)),
        "of_objects": float(np.median(error[~sky])),
        "of_sky": float(np.median(error[sky])),
        "median_relative_error_rgb": float(np.median(np.abs(edited - truth) / truth)),
        "ssim": float(structural_similarity(*shown, channel_axis=2, data_range=1)),
    }


def relief(images: StimulusSet) -> Iterator[Row]:
    """Yield correlation and L2 by lighting and estimate, of the scene and the mean over objects."""
    stimuli = {stimulus.factors["lighting"]: stimulus for stimulus in images.stimuli}
    for lighting in LIGHTINGS:
        stimulus = stimuli[lighting]
        picture = read_channels(images.path(stimulus.truth["radiance"]))
        regions = read_labels(images.path(stimulus.regions or ""))
        true_relief, distance = (
            read_channels(images.path(stimulus.truth[name]))[..., 0]
            for name in ("relief", "distance")
        )
        yield from _compared("scene", lighting, [(picture, regions > 0, -distance)])
        objects = [
            (picture, regions == number, true_relief)
            for number in range(1, int(regions.max()) + 1)
            if (regions == number).sum() >= SMALLEST_OBJECT_PX
        ]
        yield from _compared("objects", lighting, objects)


def photographs(folder: Path) -> Iterator[Row]:
    """Yield the same of photographs with a measured depth."""
    objects = []
    for each in sorted(folder.iterdir()):
        depth = np.load(each / "depth.npz")
        depth = np.asarray(depth[depth.files[0]], dtype=np.float64)
        inside = (read_image(each / "mask.png").max(axis=2) > 0.5) & np.isfinite(depth)
        objects.append((read_image(each / "diffuse.png"), inside, depth))
    yield from _compared("photographs", "one lamp", objects)


def _compared(
    what: str, lighting: str, cases: list[tuple[NDArray[np.float32], Mask, Plane]]
) -> Iterator[Row]:
    generator = np.random.default_rng(1)
    estimates: dict[str, Callable[[NDArray[np.float32], Mask], Plane]] = {
        "perceptual": perceptual_relief,
        "luminance alone": lambda image, mask: perceptual_relief(image, mask, inflation=0),
        "silhouette": lambda _, mask: silhouette_relief(mask),
        "noise": lambda _, mask: generator.random(mask.shape),
    }
    for name, estimate in estimates.items():
        scores = [_scores(estimate(image, mask), truth, mask) for image, mask, truth in cases]
        correlation, l2, l2_affine = np.mean(scores, axis=0)
        row: Row = {"of": what, "lighting": lighting, "estimate": name, "n": len(cases)}
        yield row | {"correlation": correlation, "l2": l2, "l2_best_affine": l2_affine}


def _scores(estimate: Plane, truth: Plane, mask: Mask) -> tuple[float, float, float]:
    """Return correlation, and RMS differences of depths scaled to 0..1, without and with a fit."""
    found, true = (
        (values - values.min()) / max(float(np.ptp(values)), 1e-9)
        for values in (np.asarray(estimate)[mask].astype(np.float64), np.asarray(truth)[mask])
    )
    correlation = float(np.corrcoef(found, true)[0, 1])
    l2 = float(np.sqrt(np.mean((found - true) ** 2)))
    return correlation, l2, float(true.std() * np.sqrt(1 - correlation**2))


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--parts", nargs="+", default=["speed", "fog", "relief"])
    parser.add_argument("--fog", type=Path, help="the folder of the set fog")
    parser.add_argument("--still-life", type=Path, help="the folder of the set still-life")
    parser.add_argument("--photos", type=Path, help="the folder of the MIT intrinsic images")
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    result: Row = {"machine": machine()}
    if "speed" in arguments.parts:
        result["speed"] = list(speed())
    for name, folder, part in (
        ("fog", arguments.fog, fog),
        ("relief", arguments.still_life, relief),
    ):
        if name in arguments.parts and folder is None:
            print(f"{name}: left out, no folder of its set is given")
        elif name in arguments.parts:
            result[name] = list(part(load(folder)))
    if "relief" in arguments.parts and arguments.photos is None:
        print("photographs: left out, --photos names no folder")
    elif "relief" in arguments.parts:
        result["photographs"] = list(photographs(arguments.photos))
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
