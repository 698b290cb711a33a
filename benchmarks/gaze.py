"""Speed of fixation detection and what it finds again at several noise levels, as JSON.

    python -m benchmarks.gaze [--output FILE]

Scan paths are simulated: fixations of known place and duration, saccades of the main sequence
with a minimum-jerk course, Gaussian noise, and blinks. A fixation is found again if one detected
fixation, and only one, shares 70 % of the time of both.
"""

import argparse
import resource
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.bootstrap import Matrix
from analysis.gaze.fixations import Fixations, fixations_by_dispersion, fixations_by_velocity
from benchmarks.results import machine, write_result

SEED = 2011
PIXELS_PER_DEGREE = 38.0
IMAGE_DEG = (26.0, 15.0)  # 1000 x 600 pixels
NOISES_DEG = (0.0, 0.05, 0.1, 0.2, 0.4)
RATES_HZ = (60.0, 250.0, 500.0)
_LONGEST_FIXATION_S = 1.2
_SHARED = 0.7

Detect = Callable[[pd.DataFrame, float], Fixations]
METHODS: dict[str, Detect] = {
    "I-VT": fixations_by_velocity,
    "I-DT": fixations_by_dispersion,
}


@dataclass(frozen=True)
class ScanPath:
    """Simulated gaze of one trial and the fixations it is made of."""

    gaze: pd.DataFrame
    truth: pd.DataFrame


def scan_path(
    duration_s: float,
    rate_hz: float,
    noise_deg: float,
    generator: np.random.Generator,
    *,
    trial_index: int = 0,
    blinks: int = 0,
) -> ScanPath:
    """Simulate the gaze of one trial.

    Parameters
    ----------
    duration_s, rate_hz, noise_deg
        Of the trial, the tracker, and of the Gaussian noise of each axis.
    generator
        Draws everything.
    trial_index
        Of the trial.
    blinks
        Stretches of 0.1 to 0.25 s without valid samples.
    """
    truth = _fixations(duration_s, generator)
    time_s = np.arange(round(duration_s * rate_hz)) / rate_hz
    position_deg = _course(truth, time_s)
    position_deg += noise_deg * generator.standard_normal(position_deg.shape)
    valid = np.ones(len(time_s), dtype=bool)
    for _ in range(blinks):
        start_s = generator.uniform(0.5, duration_s - 0.5)
        valid[(time_s >= start_s) & (time_s < start_s + generator.uniform(0.1, 0.25))] = False
    position_deg[:, ~valid] = np.nan
    gaze = pd.DataFrame(
        {
            "participant": "simulated",
            "session": "1",
            "trial_index": trial_index,
            "time_s": time_s,
            "x_px": position_deg[0] * PIXELS_PER_DEGREE,
            "y_px": position_deg[1] * PIXELS_PER_DEGREE,
            "valid": valid,
        }
    )
    return ScanPath(gaze, truth)


def _fixations(duration_s: float, generator: np.random.Generator) -> pd.DataFrame:
    """Draw fixations of 0.12 to 1.2 s in an image, 1.5 degrees apart or more."""
    rows, start_s = [], 0.0
    place = np.array(IMAGE_DEG) / 2
    while start_s < duration_s:
        length_s = min(0.12 + generator.gamma(2, 0.08), _LONGEST_FIXATION_S)
        rows.append((start_s, min(start_s + length_s, duration_s), *place))
        following = place
        while np.hypot(*(following - place)) < 1.5:
            following = generator.uniform((0.5, 0.5), np.array(IMAGE_DEG) - 0.5)
        saccade_s = 0.021 + 0.0022 * np.hypot(*(following - place))  # Carpenter 1988
        start_s, place = start_s + length_s + saccade_s, following
    return pd.DataFrame(rows, columns=["start_s", "end_s", "x_deg", "y_deg"])


def _course(truth: pd.DataFrame, time_s: Matrix) -> Matrix:
    """Return where the eye is at each time, shape (2, n): resting, or on a minimum-jerk course."""
    number = np.clip(np.searchsorted(truth["start_s"], time_s, side="right") - 1, 0, None)
    following = np.minimum(number + 1, len(truth) - 1)
    starts, ends = truth["start_s"].to_numpy(), truth["end_s"].to_numpy()
    length_s = np.maximum(starts[following] - ends[number], 1e-9)
    part = np.clip((time_s - ends[number]) / length_s, 0, 1)
    way = 10 * part**3 - 15 * part**4 + 6 * part**5
    place = truth[["x_deg", "y_deg"]].to_numpy().T
    return np.asarray(place[:, number] + way * (place[:, following] - place[:, number]))


def found_again(truth: pd.DataFrame, fixations: Fixations) -> pd.DataFrame:
    """Return the detected fixation of each true one: its errors; missing where there is none.

    Returns
    -------
    pandas.DataFrame
        `distance_deg`, `start_error_s`, `end_error_s`, one row a true fixation.
    """
    table = fixations.table
    start, end = (table[name].to_numpy(float) for name in ("start_s", "end_s"))
    rows = []
    for true in truth.to_dict("records"):
        shared = np.minimum(end, true["end_s"]) - np.maximum(start, true["start_s"])
        longest = np.maximum(end - start, true["end_s"] - true["start_s"])
        hits = np.flatnonzero(shared >= _SHARED * longest)
        if len(hits) != 1 or (shared > 0.1 * longest).sum() > 1:
            rows.append((np.nan, np.nan, np.nan))
            continue
        hit = table.iloc[hits[0]]
        x_deg, y_deg = hit["x_px"] / PIXELS_PER_DEGREE, hit["y_px"] / PIXELS_PER_DEGREE
        rows.append(
            (
                float(np.hypot(x_deg - true["x_deg"], y_deg - true["y_deg"])),
                hit["start_s"] - true["start_s"],
                hit["end_s"] - true["end_s"],
            )
        )
    return pd.DataFrame(rows, columns=["distance_deg", "start_error_s", "end_error_s"])


def recovered(method: str, rate_hz: float, noise_deg: float) -> dict[str, float]:
    """Return what a method finds again of a minute of gaze."""
    path = scan_path(60, rate_hz, noise_deg, np.random.default_rng(SEED))
    found = METHODS[method](path.gaze, PIXELS_PER_DEGREE)
    errors = found_again(path.truth, found)
    return {
        "true": len(path.truth),
        "detected": len(found.table),
        "found_again": float(errors["distance_deg"].notna().mean()),
        "distance_deg": float(errors["distance_deg"].median()),
        "start_error_s": float(errors["start_error_s"].median()),
        "end_error_s": float(errors["end_error_s"].median()),
    }


def an_hour() -> pd.DataFrame:
    """Simulate an hour at 500 Hz: 240 trials of 15 s with two blinks each."""
    generator = np.random.default_rng(SEED)
    paths = [
        scan_path(15, 500, 0.05, generator, trial_index=trial, blinks=2) for trial in range(240)
    ]
    return pd.concat([path.gaze for path in paths], ignore_index=True)


def seconds_of(run: Callable[[], object]) -> float:
    """Return the median time of three runs."""
    seconds = []
    for _ in range(3):
        started = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - started)
    return float(np.median(seconds))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    hour = an_hour()
    result = {
        "machine": machine(),
        "seed": SEED,
        "samples_of_an_hour": len(hour),
        "seconds_for_an_hour": {
            name: seconds_of(lambda detect=detect: detect(hour, PIXELS_PER_DEGREE))  # type: ignore[misc]
            for name, detect in METHODS.items()
        },
        "gigabytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9,
        "recovery": {
            name: {
                f"{rate:g} Hz": {
                    f"{noise:g} deg noise": recovered(name, rate, noise) for noise in NOISES_DEG
                }
                for rate in RATES_HZ
            }
            for name in METHODS
        },
    }
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
