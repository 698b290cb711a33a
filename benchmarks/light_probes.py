"""How many lights are found on rendered probes, and how far off, as JSON.

    python -m benchmarks.light_probes [--seeds 4 5] [--output FILE]

Of each seed, which draws shapes and lights: one light, two of several separations and ratios, and
three (those of table 3.2 as well) on O1 to O4, with and without surroundings, of 256 x 256 pixels.
The constants of `algorithms.lights.fitting` were chosen on the seeds 1 to 3 and on photographs.
"""

import argparse
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from algorithms import Light, detect_lights
from analysis.errors import light_error
from benchmarks.results import machine, write_result
from stimuli.camera import View
from stimuli.engine import choose_engine
from stimuli.light_linking.rigs import KEY_INTENSITY
from stimuli.scenes.probe_lights import TABLE_3_2, light_of_chapter_3
from stimuli.sets.lightprobes import AMBIENT, ProbeImage, Studio
from stimuli.shapes.displaced_spheres import LIGHTPROBES

VIEW = View(width_px=256, height_px=256, radius_px=115, samples=9)
SEPARATIONS_DEG = (50, 50, 50, 60, 80, 120, 180)
"""The smallest, which is the hardest, is drawn three times."""

RATIOS = ((1, 0.0), (1, AMBIENT), (2, 0.0), (3, AMBIENT))
"""Of two intensities, and the surroundings."""

SINGLE_ELEVATIONS_DEG = (-30, 0, 20, 40, 60)

Row = dict[str, Any]


def images(generator: np.random.Generator) -> Iterator[ProbeImage]:
    """Yield what is rendered of a seed."""

    def light(azimuth_deg: float, ratio: float = 1) -> Light:
        return Light(azimuth_deg % 360, generator.uniform(-25, 45), KEY_INTENSITY / ratio)

    for apart_deg, probe, (ratio, ambient) in product(SEPARATIONS_DEG, LIGHTPROBES, RATIOS):
        azimuth_deg = generator.uniform(0, 360)
        pair = (light(azimuth_deg), light(azimuth_deg + apart_deg, ratio))
        yield ProbeImage(f"two, {apart_deg} deg", probe, pair, ambient)
    for probe, elevation_deg, ambient in product(
        LIGHTPROBES, SINGLE_ELEVATIONS_DEG, (0.0, AMBIENT)
    ):
        single = Light(generator.uniform(0, 360), elevation_deg, KEY_INTENSITY)
        yield ProbeImage("one", probe, (single,), ambient)
    published = tuple(light_of_chapter_3(*angles) for angles in TABLE_3_2)
    for probe in LIGHTPROBES:
        yield ProbeImage("three, table 3.2", probe, published)
        for ambient in (0.0, AMBIENT):
            azimuth_deg = generator.uniform(0, 360)
            second_deg, third_deg = np.cumsum(generator.uniform(70, 145, 2)).tolist()
            three = (
                light(azimuth_deg),
                light(azimuth_deg + second_deg),
                light(azimuth_deg + third_deg, 2),
            )
            yield ProbeImage("three", probe, three, ambient)


def detected(seed: int) -> Iterator[Row]:
    """Yield what fitting finds in each image of a seed."""
    studio = Studio(seed, quick=False)
    for image in images(np.random.default_rng([seed, 77])):
        made = studio.picture(image, VIEW)
        error = light_error(
            detect_lights(made.radiance, made.coverage > 1 / 2).lights, image.lights
        )
        yield {
            "lights": image.group,
            "probe": image.probe,
            "ratio": image.factors["intensity_ratio"],
            "number_right": error.number_is_right,
            "missed": error.missed,
            "strong_extra": error.strong_extra,
            "azimuth_deg": mean(error.azimuth_deg),
            "elevation_deg": mean(error.elevation_deg),
            "angle_deg": mean(error.angle_deg),
        }


def mean(values: tuple[float, ...]) -> float:
    """Return the mean over the lights that were found; NaN for none."""
    return float(np.mean(values)) if values else float("nan")


def cells(rows: pd.DataFrame, by: str) -> list[Row]:
    """Return number of images and means of the rows of each cell."""
    numbers = [name for name in rows.select_dtypes(["number", "bool"]) if name != by]
    table = rows.groupby(by, observed=True)[numbers].agg("mean").reset_index()
    table["images"] = rows.groupby(by, observed=True).size().to_numpy()
    return [{str(name): value for name, value in row.items()} for row in table.to_dict("records")]


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--seeds", nargs="+", type=int, default=[4, 5])
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    choose_engine(None)
    rows = pd.DataFrame([row for seed in arguments.seeds for row in detected(seed)])
    closest = rows[rows["lights"] == f"two, {min(SEPARATIONS_DEG)} deg"]
    result = {
        "machine": machine(),
        "seeds": arguments.seeds,
        "by_lights": cells(rows, "lights"),
        "closest_pairs_by_probe": cells(closest, "probe"),
        "closest_pairs_by_ratio": cells(closest, "ratio"),
        "singles_95th_percentile_deg": float(
            rows.loc[rows["lights"] == "one", "angle_deg"].quantile(0.95)
        ),
    }
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
