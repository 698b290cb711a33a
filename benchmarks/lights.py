"""How fast light detection is, and how far off on real photographs, as JSON.

    python -m benchmarks.lights [--parts speed photographs] [--photos DIR] [--output FILE]

`speed`: preparation and estimation apart, of a sphere under two lights, over sizes. `photographs`:
one light, and sums of two, on the gray sphere and the cat of the photometric stereo images that
DIR holds (`gray.npz`, `cat.npz`: `images`, `mask`, `lights`); the sphere is also turned in the
image plane. Lights closer than 20 degrees to the viewing axis are left out, sums whose azimuths
differ by less than 60 as well.
"""

import argparse
import statistics
import time
from collections.abc import Callable, Iterator
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms import Light, detect_lights
from algorithms.lights.contour import contour_of
from algorithms.lights.estimate import Method
from algorithms.lights.fitting import fit_lights
from algorithms.lights.probe import prepare_probe
from algorithms.lights.shading import shading_of
from algorithms.lights.shape import interior_of
from algorithms.lights.trim import trimmed
from algorithms.lights.voting import vote_lights
from analysis.errors import azimuth_error_deg, light_error
from benchmarks.results import machine, write_result

SIZES_PX = (128, 256, 512, 1024, 2048, 4096)
METHODS: tuple[Method, ...] = ("fitting", "voting")
RIG = (Light(20, 20, 0.8), Light(140, 30, 0.5))
LEAST_TO_AXIS_DEG = 20
LEAST_APART_DEG = 60
REPEATS = 5

Row = dict[str, Any]
Image = NDArray[np.float64]
Mask = NDArray[np.bool_]


def sphere(size_px: int) -> tuple[NDArray[np.float32], Mask]:
    """Return the picture of a sphere under two lights, and its mask."""
    places = ((np.arange(size_px) + 0.5) / size_px * 2 - 1) / 0.9
    x, y = np.meshgrid(places, -places)
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    normals = np.stack([x, y, z], axis=-1)
    shading = sum(light.intensity * np.maximum(normals @ light.direction, 0) for light in RIG)
    mask = x**2 + y**2 < 1
    return np.repeat(np.where(mask, shading, 0.2)[..., None], 3, axis=2).astype(np.float32), mask


def seconds(work: Callable[[], object]) -> float:
    """Return the median time of some repeats."""
    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def speed() -> Iterator[Row]:
    """Yield the times of each size: preparation, both estimators, and both methods as a whole."""
    for size_px in SIZES_PX:
        image, mask = sphere(size_px)
        probe = trimmed(prepare_probe(image, mask))
        interior = interior_of(probe)
        contour = contour_of(probe, interior)
        shading = shading_of(interior, contour)

        def prepare(image: NDArray[np.float32] = image, mask: Mask = mask) -> None:
            made = trimmed(prepare_probe(image, mask))
            contour_of(made, interior_of(made))

        row: Row = {"size_px": size_px, "preparation_s": seconds(prepare)}
        row["fitting_s"] = seconds(lambda s=shading: fit_lights(s))  # type: ignore[misc]
        row["voting_s"] = seconds(lambda c=contour, s=shading: vote_lights(c, s))  # type: ignore[misc]
        yield row | {
            f"{method}_with_preparation_s": row["preparation_s"] + row[f"{method}_s"]
            for method in METHODS
        }


def photographs(folder: Path) -> Iterator[Row]:
    """Yield errors of single lights and of sums of two, per object and method."""
    for name, turned in (("gray", True), ("cat", False)):
        stored = np.load(folder / f"{name}.npz")
        images, mask = stored["images"] / 255.0, stored["mask"]
        lights = [Light.from_direction(direction) for direction in stored["lights"]]
        for method in METHODS:
            yield {"object": name, "method": method, "lights": 1} | _singles(
                images, mask, lights, method
            )
            for turns in (False, True) if turned else (False,):
                row: Row = {"object": name, "method": method, "lights": 2, "turned": turns}
                yield row | _sums(images, mask, lights, method, turns=turns)


def _singles(images: Image, mask: Mask, lights: list[Light], method: Method) -> Row:
    errors, counts = [], []
    for image, light in zip(images, lights, strict=True):
        if light.elevation_deg <= 90 - LEAST_TO_AXIS_DEG:
            found = detect_lights(image, mask, method).lights
            errors.append(light_error(found, [light]))
            counts.append(len(found))
    return {
        "n": len(errors),
        "right_number": float(np.mean([count == 1 for count in counts])),
        "azimuth_deg": float(np.mean([error.azimuth_deg[0] for error in errors])),
        "angle_deg": float(np.mean([error.angle_deg[0] for error in errors])),
        "largest_angle_deg": float(np.max([error.angle_deg[0] for error in errors])),
    }


def _sums(images: Image, mask: Mask, lights: list[Light], method: Method, *, turns: bool) -> Row:
    errors, counts = [], []
    for i, j in combinations(range(len(images)), 2):
        for quarters in (1, 2, 3) if turns else (0,):
            second = Light(lights[j].azimuth_deg + 90 * quarters, lights[j].elevation_deg)
            near_axis = max(lights[i].elevation_deg, second.elevation_deg) > 90 - LEAST_TO_AXIS_DEG
            if near_axis or azimuth_error_deg(lights[i], second) < LEAST_APART_DEG:
                continue
            image, inside = _added(images[i], images[j], mask, quarters)
            found = detect_lights(image, inside, method).lights
            counts.append(len(found))
            errors.append(light_error(found, [lights[i], second]))
    return {
        "n": len(errors),
        "two_found": float(np.mean([count == 2 for count in counts])),
        "azimuth_deg": float(np.mean([a for error in errors for a in error.azimuth_deg])),
        "angle_deg": float(np.mean([a for error in errors for a in error.angle_deg])),
    }


def _added(first: Image, second: Image, mask: Mask, quarters: int) -> tuple[Image, Mask]:
    """Add two photographs of a sphere, the second one turned about the sphere's middle."""
    if quarters == 0:
        return first + second, mask
    rows, columns = np.nonzero(mask)
    middle = (int(rows.min() + rows.max()) // 2, int(columns.min() + columns.max()) // 2)
    half = max(int(np.ptp(rows)), int(np.ptp(columns))) // 2 + 4
    box = tuple(slice(place, place + 2 * half + 1) for place in middle)
    around = ((half, half), (half, half))
    one, other = (np.pad(image, (*around, (0, 0)))[box] for image in (first, second))
    inside = np.pad(mask, around)[box]
    return one + np.rot90(other, quarters), inside & np.rot90(inside, quarters)


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--parts", nargs="+", default=["speed", "photographs"])
    parser.add_argument("--photos", type=Path, help="the folder of gray.npz and cat.npz")
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    result: Row = {"machine": machine()}
    if "speed" in arguments.parts:
        result["speed"] = list(speed())
    if "photographs" in arguments.parts:
        if arguments.photos is None or not (arguments.photos / "gray.npz").is_file():
            print("photographs: left out, --photos names no folder with gray.npz and cat.npz")
        else:
            result["photographs"] = list(photographs(arguments.photos))
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
