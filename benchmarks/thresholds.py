"""Whether thresholds, differences and effects of factors are what they claim, as JSON.

    python -m benchmarks.thresholds coverage|tests|differences|speed [--output FILE]
        [--repetitions N] [--observers 10 30 60] [--processes 2]

`coverage`: how often 95 % intervals of a threshold hold it, by number of observers, where these
are alike and where they differ. `tests`: how often effects of factors that have none are found
(5 % asked), beside statsmodels' exchangeable GEE with its bias-reduced covariance. `differences`:
the same for two conditions with one threshold. `speed`: everything on a study of 100,000 answers,
and fits by maximum likelihood beside psignifit's.
"""

import argparse
import resource
import time
import warnings
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import statsmodels.api as sm
from numpy.typing import NDArray
from statsmodels.genmod.cov_struct import Exchangeable

from analysis.rates.clustered_regression import Kind, clustered_regression
from analysis.rates.effects import hit_effects, time_effects
from analysis.rates.factors import Design, design_of
from analysis.rates.hits import hit_rates
from analysis.rates.salience import object_salience
from analysis.thresholds.bayesian_fit import fit_threshold
from analysis.thresholds.by_condition import group_thresholds
from analysis.thresholds.condition_differences import condition_differences
from analysis.thresholds.maximum_likelihood import maximum_likelihood
from analysis.thresholds.observer_bootstrap import fit_observers
from analysis.thresholds.over_participants import participant_interval
from analysis.thresholds.sigmoid import WIDTH_IN_SIGMAS, rate_at
from analysis.thresholds.threshold_difference import threshold_difference
from benchmarks.results import machine, write_result

THRESHOLD, WIDTH, LAPSE_RATE, GUESS_RATE = 25.0, 30.0, 0.02, 1 / 8
SPREADS = {"alike": 0.0, "differing": 8.0}  # standard deviations of the observers' thresholds
LEVELS = np.arange(10.0, 91.0, 10.0)
PLACEMENTS = ("front", "back", "front-back")
MATERIALS = ("diffuse", "shiny")
ANSWERS = len(PLACEMENTS) * len(MATERIALS)  # of an observer at a level
STATED = 0.75
SEED = 2011
RESAMPLES = 1000

Row = dict[str, float]
Values = NDArray[np.float64]


def observers(number: int, spread: float, generator: np.random.Generator) -> tuple[Values, Values]:
    """Return the thresholds and the right answers of observers."""
    own = generator.normal(THRESHOLD, spread, (number, 1))
    rates = rate_at(LEVELS, own, WIDTH, GUESS_RATE, LAPSE_RATE)
    return own, generator.binomial(ANSWERS, rates).astype(float)


def stated_threshold(spread: float) -> float:
    """Return the level of the stated share for the mean of the observers' functions.

    It is a cumulative normal with the variances added.
    """
    width = np.hypot(WIDTH, spread * WIDTH_IN_SIGMAS)
    at = np.linspace(0, 90, 90_001)
    return float(np.interp(STATED, rate_at(at, THRESHOLD, width, GUESS_RATE, LAPSE_RATE), at))


def covered(
    number: int, spread: float, psignifit: bool, repetition: int, resamples: int = RESAMPLES
) -> Row:
    """Fit observers once and say which intervals hold the threshold."""
    generator = np.random.default_rng([SEED, repetition])
    _, correct = observers(number, spread, generator)
    total = np.full(correct.shape, float(ANSWERS))
    found = fit_observers(LEVELS, correct, total, GUESS_RATE, generator, resamples)
    stated, truth = found.threshold_at(STATED).threshold, stated_threshold(spread)
    row = {
        "observer bootstrap": found.threshold.low <= THRESHOLD <= found.threshold.high,
        "observer bootstrap, 75 % right": stated.low <= truth <= stated.high,
    }
    if psignifit:
        fit = fit_threshold(LEVELS, correct.sum(axis=0), total.sum(axis=0), GUESS_RATE)
        wide = participant_interval(fit, correct, total)
        row["over participants"] = wide.low <= THRESHOLD <= wide.high
        at = participant_interval(fit, correct, total, STATED)
        row["over participants, 75 % right"] = at.low <= truth <= at.high
        row["credible"] = fit.threshold.low <= THRESHOLD <= fit.threshold.high
    return {name: float(held) for name, held in row.items()}


def people(number: int, generator: np.random.Generator, replicates: int = 1) -> pd.DataFrame:
    """Return the trials of some participants, with what is known of them, without answers."""
    table = pd.MultiIndex.from_product(
        [range(number), LEVELS, PLACEMENTS, MATERIALS, range(replicates)],
        names=["number", "level", "placement", "material", "replicate"],
    ).to_frame(index=False)
    who = table["number"].to_numpy()
    return table.assign(
        participant=table["number"].map("P{:04d}".format),
        cell=who * len(PLACEMENTS) + table["placement"].map(PLACEMENTS.index).to_numpy(),
        artistic_background=np.where(who < max(2, number // 3), "yes", "no"),
        gender=np.where(who % 2 == 0, "female", "male"),
        age=np.exp(generator.normal(3.4, 0.25, number)).round()[who],
    )


def answer(table: pd.DataFrame, generator: np.random.Generator) -> tuple[Values, Values]:
    """Return right answers and logarithms of times that depend on the level and on who answers.

    Participants differ, and each differs between placements, but not on average.
    """
    who, cell = table["number"].to_numpy(), table["cell"].to_numpy()
    number, cells = int(who.max()) + 1, int(cell.max()) + 1
    own = generator.normal(THRESHOLD, SPREADS["differing"], number)[who]
    own = own + generator.normal(0, SPREADS["differing"] / 2, cells)[cell]
    rates = rate_at(table["level"], own, WIDTH, GUESS_RATE, LAPSE_RATE)
    speed = generator.normal(2.0, 0.4, number)[who] + generator.normal(0, 0.1, cells)[cell]
    times = speed + generator.normal(0, 0.5, len(table))
    return generator.binomial(1, rates).astype(float), times


def study(number: int, generator: np.random.Generator, replicates: int = 1) -> pd.DataFrame:
    """Return the trials of some participants with their answers."""
    table = people(number, generator, replicates)
    right, log_time = answer(table, generator)
    return table.assign(correct=right > 0, answer=1, reaction_time_s=np.exp(log_time))


WITHIN = ("level", "placement", "material")
BETWEEN = ("artistic_background", "gender", "age")
FACTORS = WITHIN + BETWEEN


@cache
def designs(number: int) -> tuple[pd.DataFrame, Design, Design]:
    """Return the trials of a study and the designs that `analysis.hit_effects` makes of them."""
    table = people(number, np.random.default_rng([SEED, number])).assign(correct=0.0)
    return (
        table,
        design_of(table, WITHIN, "correct", binary=False),
        design_of(table, FACTORS, "correct", binary=False),
    )


def rejected(number: int, peer: bool, repetition: int) -> Row:
    """Test the factors of a study in which only the level has an effect."""
    table, within, every = designs(number)
    right, log_time = answer(table, np.random.default_rng([SEED, repetition]))
    row: Row = {}
    responses: tuple[tuple[str, Kind, Values], ...] = (
        ("hit rate", "binomial", right),
        ("time", "normal", log_time),
    )
    for name, kind, response in responses:
        for design, factors in ((within, WITHIN[1:]), (every, BETWEEN)):
            fit = clustered_regression(design.matrix, response, design.cluster, kind)
            units = np.eye(len(fit.coefficients))
            for factor in design.factors:
                if factor.name in factors:
                    p_value = fit.test(units[list(factor.columns)]).p_value
                    row[f"{name}: {factor.name}"] = float(p_value < 0.05)
    return row | (_peer(right, every) if peer else {})


def _peer(right: Values, design: Design) -> Row:
    """Test them by statsmodels: exchangeable, Mancl and DeRouen's covariance, normal tails."""
    model = sm.GEE(
        right,
        design.matrix,
        groups=design.cluster,
        family=sm.families.Binomial(),
        cov_struct=Exchangeable(),
    )
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        fit = model.fit(cov_type="bias_reduced")
    if not fit.converged or not np.isfinite(fit.bse).all():
        return {"statsmodels: not converged": 1.0}
    return {"statsmodels: not converged": 0.0} | {
        f"statsmodels: {factor.name}": float(fit.pvalues[factor.first] < 0.05)
        for factor in design.factors
        if factor.name in ("material", *BETWEEN)
    }


def different(number: int, spread: float, repetition: int, resamples: int = RESAMPLES) -> Row:
    """Compare two conditions with one threshold, over the same and over other observers."""
    generator = np.random.default_rng([SEED, repetition])
    own, first = observers(number, spread, generator)
    _, others = observers(number, spread, generator)
    moved = own + generator.normal(0, spread / 2, own.shape)
    rates = rate_at(LEVELS, moved, WIDTH, GUESS_RATE, LAPSE_RATE)
    second = generator.binomial(ANSWERS, rates).astype(float)
    total = np.full(first.shape, float(ANSWERS))
    paired, unpaired = (
        threshold_difference(
            LEVELS, (first, total), (other, total), GUESS_RATE, generator, resamples, paired=pair
        )
        for other, pair in ((second, True), (others, False))
    )
    return {"paired": float(paired.p_value < 0.05), "unpaired": float(unpaired.p_value < 0.05)}


def shares(
    once: Callable[[int], Row], repetitions: int, pool: ProcessPoolExecutor
) -> dict[str, float | int]:
    """Return the share of repetitions of each thing, and how many there were."""
    rows = list(pool.map(once, range(repetitions), chunksize=10))
    means = pd.DataFrame(rows).mean()
    return {str(name): float(share) for name, share in means.items()} | {"repetitions": len(rows)}


def simulate(
    cases: Mapping[str, Callable[[int], Row]], repetitions: int, processes: int
) -> dict[str, Any]:
    """Run every case."""
    with ProcessPoolExecutor(processes) as pool:
        result = {}
        for name, once in cases.items():
            started = time.perf_counter()
            result[name] = shares(once, repetitions, pool)
            result[name]["seconds"] = time.perf_counter() - started
    return result


def timed(compute: Callable[[], object]) -> float:
    """Return the processor seconds of the quickest of three runs."""
    seconds = []
    for _ in range(3):
        started = time.process_time()
        compute()
        seconds.append(time.process_time() - started)
    return min(seconds)


def speed() -> dict[str, Any]:
    """Time everything on 100,000 answers, and one fit by each method."""
    generator = np.random.default_rng(SEED)
    table = study(1000, generator, replicates=2).iloc[:-8000]  # 108,000 answers less 8,000
    table = table.assign(
        control=(generator.random(len(table)) < 0.1),
        target=pd.array(generator.integers(1, 9, len(table)), dtype="Int64"),
    )
    answer = generator.integers(1, 9, len(table))
    answer = np.where(table["correct"], table["target"].to_numpy(int), answer)
    table["answer"] = pd.array(answer, dtype="Int64")
    table["correct"] = table["correct"].astype("boolean").mask(table["control"])
    table["target"] = table["target"].mask(table["control"])
    conditions = ("placement", "material")
    objects = {label: chr(96 + label) for label in range(1, 9)}
    parts: dict[str, Callable[[], object]] = {
        "thresholds of 12 groups": lambda: group_thresholds(table, conditions, GUESS_RATE),
        "hit rates": lambda: hit_rates(table, ("level", *conditions), GUESS_RATE, generator),
        "effects on hits": lambda: hit_effects(table, FACTORS),
        "effects on times": lambda: time_effects(table, FACTORS),
        "differences of placements": lambda: condition_differences(
            table, "placement", GUESS_RATE, generator
        ),
        "salience": lambda: object_salience(table, objects, ("placement",), generator),
    }
    seconds = {name: timed(compute) for name, compute in parts.items()}
    return {
        "answers": len(table),
        "processor seconds": seconds,
        "all": sum(seconds.values()),
        "peak memory, GB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
        **_fits(generator),
    }


def _fits(generator: np.random.Generator) -> dict[str, float]:
    rates = rate_at(LEVELS, THRESHOLD, WIDTH, GUESS_RATE, LAPSE_RATE)
    correct = generator.binomial(180, rates, size=(2000, len(LEVELS)))
    total = np.full(correct.shape, 180)
    many = timed(lambda: maximum_likelihood(LEVELS, correct, total, GUESS_RATE)) / 2000
    one = timed(lambda: fit_threshold(LEVELS, correct[0], total[0], GUESS_RATE))
    return {
        "seconds a fit, maximum likelihood": many,
        "seconds a fit, psignifit": one,
        "ratio": one / many,
    }


def cases_of(part: str, numbers: Iterable[int]) -> dict[str, Callable[[int], Row]]:
    """Return the cases of a part of the simulation, by name."""
    cases: dict[str, Callable[[int], Row]] = {}
    for number in numbers:
        if part == "tests":
            cases[f"{number} participants"] = partial(rejected, number, number == 20)
            continue
        for kind, spread in SPREADS.items():
            once = (
                partial(covered, number, spread, True)
                if part == "coverage"
                else partial(different, number, spread)
            )
            cases[f"{number} observers, {kind}"] = once
    return cases


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("part", choices=["coverage", "tests", "differences", "speed"])
    parser.add_argument("--repetitions", type=int, default=2000)
    parser.add_argument("--observers", type=int, nargs="+", default=[10, 20, 30, 60])
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--output", type=Path)
    given = parser.parse_args()
    about: dict[str, Any] = {"machine": machine(), "seed": SEED}
    if given.part == "speed":
        result = speed()
    else:
        cases = cases_of(given.part, given.observers)
        result = simulate(cases, given.repetitions, given.processes)
    write_result(about | {given.part: result}, given.output)


if __name__ == "__main__":
    main()
