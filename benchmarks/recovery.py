"""Whether the analysis gives back the threshold of simulated observers, as JSON.

    python -m benchmarks.recovery [--repetitions 100] [--participants 200] [--processes 2]
    python -m benchmarks.recovery --grids

A repetition simulates participants with one known threshold, fits each placement, and asks whether
the 95 % interval holds the threshold. A second run gives one object more salience and reports
what that does; a third draws participants whose thresholds differ, which the credible interval
does not know of and the interval over participants does. `--grids` compares the grid of the fit
with psignifit's own, finer one.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from analysis.answers.trials import trial_table
from analysis.bootstrap import Matrix, sum_by_participant
from analysis.estimates import Estimate, to_json
from analysis.thresholds.bayesian_fit import GRID_STEPS, fit_threshold
from analysis.thresholds.over_participants import participant_interval
from experiments.simulated.observers import Observer, psychometric_function, simulate_responses
from experiments.study import load_study
from stimuli.manifest import StimulusSet, load
from tests.drawn_set import draw_set

THRESHOLD_DEG = 25.0
WIDTH_DEG = 30.0
LAPSE_RATE = 0.02
SEED = 2010
SALIENT_LABEL, SALIENT_WEIGHT = 5, 4.0
SPREAD_DEG = 8.0  # the standard deviation of thresholds where participants differ
ANSWERS_PER_LEVEL = 6  # of a participant: 3 placements, 2 materials
LEVELS_DEG = np.arange(10.0, 91.0, 10.0)
DEFAULT_GRID_STEPS = {"threshold": 40, "width": 40, "lambda": 20, "eta": 20}


@dataclass(frozen=True)
class Recovered:
    """One placement of one repetition: the threshold and its two intervals."""

    placement: str
    credible: Estimate
    over_participants: Estimate


def observer(salience: Mapping[int, float] | None = None) -> Observer:
    """Return the observer whose threshold is to be found again."""
    return Observer(THRESHOLD_DEG, WIDTH_DEG, LAPSE_RATE, salience=salience)


def answers(
    stimuli: StimulusSet, participants: int, repetition: int, simulated: Observer
) -> pd.DataFrame:
    """Return the scored trials of simulated participants."""
    study = load_study("lights-synthetic")
    generator = np.random.default_rng([SEED, repetition])
    responses = simulate_responses(study, stimuli, simulated, participants, generator)
    table = trial_table(responses, study, stimuli)
    return table[table["correct"].notna()]


def recover(
    folder: Path, participants: int, salience: Mapping[int, float] | None, repetition: int
) -> list[Recovered]:
    """Simulate participants and fit each placement."""
    table = answers(load(folder), participants, repetition, observer(salience))
    found = []
    for placement, trials in table.groupby("placement", observed=True):
        sums = sum_by_participant(trials, "correct", ["level"])
        levels = sums.cells["level"].to_numpy()
        found.append(_fitted(str(placement), levels, sums.totals, sums.counts))
    return found


def recover_from_differing(participants: int, repetition: int) -> list[Recovered]:
    """Draw answers of participants whose thresholds are normally distributed, and fit them all.

    The mean of their functions has its mid-point at the mean threshold, since it is a cumulative
    normal too.
    """
    generator = np.random.default_rng([SEED, repetition])
    thresholds = generator.normal(THRESHOLD_DEG, SPREAD_DEG, size=(participants, 1))
    rates = psychometric_function(LEVELS_DEG, thresholds, WIDTH_DEG, 1 / 8, LAPSE_RATE)
    correct = generator.binomial(ANSWERS_PER_LEVEL, rates).astype(float)
    return [_fitted("all", LEVELS_DEG, correct, np.full_like(correct, ANSWERS_PER_LEVEL))]


def _fitted(placement: str, levels: Matrix, correct: Matrix, total: Matrix) -> Recovered:
    fit = fit_threshold(levels, correct.sum(axis=0), total.sum(axis=0), 1 / 8)
    return Recovered(placement, fit.threshold, participant_interval(fit, correct, total))


def summary(found: Iterable[Recovered]) -> dict[str, dict[str, float]]:
    """Return coverage, bias and interval lengths for each placement."""
    rows = pd.DataFrame(
        [
            {
                "placement": one.placement,
                "estimate": one.credible.value,
                "covered": one.credible.low <= THRESHOLD_DEG <= one.credible.high,
                "length": one.credible.high - one.credible.low,
                "covered_over_participants": (
                    one.over_participants.low <= THRESHOLD_DEG <= one.over_participants.high
                ),
                "length_over_participants": one.over_participants.high - one.over_participants.low,
            }
            for one in found
        ]
    )
    return {
        str(placement): {
            "repetitions": len(group),
            "covered": int(group["covered"].sum()),
            "covered_over_participants": int(group["covered_over_participants"].sum()),
            "mean_estimate_deg": round(float(group["estimate"].mean()), 3),
            "sd_of_estimates_deg": round(float(group["estimate"].std()), 3),
            "mean_interval_length_deg": round(float(group["length"].mean()), 3),
            "mean_length_over_participants_deg": round(
                float(group["length_over_participants"].mean()), 3
            ),
        }
        for placement, group in rows.groupby("placement")
    }


def run(repetitions: int, participants: int, processes: int) -> dict[str, object]:
    """Run all repetitions without and with a salient object."""
    result: dict[str, object] = {
        "threshold_deg": THRESHOLD_DEG,
        "width_deg": WIDTH_DEG,
        "lapse_rate": LAPSE_RATE,
        "participants": participants,
        "salience": {"label": SALIENT_LABEL, "weight": SALIENT_WEIGHT},
        "spread_of_differing_thresholds_deg": SPREAD_DEG,
        "seed": SEED,
    }
    with tempfile.TemporaryDirectory() as name, ProcessPoolExecutor(processes) as pool:
        folder = Path(name)
        draw_set(folder)
        salient = {SALIENT_LABEL: SALIENT_WEIGHT}
        cases: dict[str, Callable[[int], list[Recovered]]] = {
            "unbiased": partial(recover, folder, participants, None),
            "salient object": partial(recover, folder, participants, salient),
            "differing participants": partial(recover_from_differing, participants),
        }
        for case, once in cases.items():
            started = time.perf_counter()
            found = [one for some in pool.map(once, range(repetitions)) for one in some]
            result[case] = summary(found)
            result[f"{case}, seconds"] = round(time.perf_counter() - started, 1)
    return result


def compare_grids(repetitions: int, participants: int) -> dict[str, object]:
    """Compare threshold intervals and times between our grid and psignifit's own steps."""
    differences, seconds = [], {"ours": 0.0, "psignifit": 0.0}
    with tempfile.TemporaryDirectory() as name:
        stimuli = draw_set(Path(name))
        for repetition in range(repetitions):
            table = answers(stimuli, participants, repetition, observer())
            counts = table.groupby("level")["correct"].agg(["sum", "count"])
            fits = {}
            for grid, steps in (("ours", GRID_STEPS), ("psignifit", DEFAULT_GRID_STEPS)):
                started = time.perf_counter()
                fits[grid] = fit_threshold(
                    counts.index.to_numpy(),
                    counts["sum"].to_numpy(int),
                    counts["count"].to_numpy(int),
                    1 / 8,
                    grid_steps=steps,
                ).threshold
                seconds[grid] += time.perf_counter() - started
            ours, fine = fits["ours"], fits["psignifit"]
            gap = max(abs(ours.low - fine.low), abs(ours.high - fine.high))
            differences.append(gap / (fine.high - fine.low))
    return {
        "repetitions": repetitions,
        "largest_difference_of_interval_ends": round(max(differences), 5),
        "seconds_per_fit": {grid: round(s / repetitions, 3) for grid, s in seconds.items()},
    }


def main() -> None:
    """Read the arguments, run, and print the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--repetitions", type=int, default=100)
    parser.add_argument("--participants", type=int, default=200)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--grids", action="store_true", help="compare the grids of the fit")
    given = parser.parse_args()
    if given.grids:
        result = compare_grids(given.repetitions, given.participants)
    else:
        result = run(given.repetitions, given.participants, given.processes)
    print(to_json(result))


if __name__ == "__main__":
    main()
