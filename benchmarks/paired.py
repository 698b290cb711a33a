"""Whether the tests of paired comparisons keep their level and the scale its coverage, as JSON.

    python -m benchmarks.paired [--repetitions 2000] [--processes 2] [--parts speed scale ...]

Parts: `speed` (beside choix in the same run); `consistency`, `agreement` and `groups` (how often
tests reject when every answer is a coin's); `tastes` (how often when observers are consistent but
have nothing in common); `scale` and `u` (how often 95 % intervals hold the truth when observers are
alike, and when they differ). All of it takes about an hour; a part does not depend on the others.
"""

import argparse
import math
import statistics
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import choix
import numpy as np
from scipy import stats

from analysis.bootstrap import Matrix
from analysis.paired.agreement import (
    agreeing_pairs,
    agreement,
    agreement_p_value,
    agreement_tail,
    kendall_chi_square,
    large_sample_chi_square,
    pair_wins,
)
from analysis.paired.consistency import (
    circular_triads,
    triad_counts,
    triads_chi_square,
    triads_p_value,
)
from analysis.paired.pair_data import Tournaments
from analysis.paired.scale_fit import (
    MODELS,
    Model,
    ModelName,
    covariance,
    differences,
    fit_values,
    has_maximum,
)
from analysis.paired.scale_intervals import (
    FROM_RESAMPLES,
    INTERVALS,
    interval_of_contrasts,
    resample_observers,
    sandwich,
)
from analysis.paired.scaling import RESAMPLES, scale_pairs
from analysis.paired.score_groups import david_chi_square, score_groups
from analysis.paired.score_range import (
    critical_difference,
    exact_is_feasible,
    exact_range,
    simulated_range,
)
from benchmarks.results import machine, write_result

SEED = 2010
ALPHAS = (0.05, 0.01)
PERMUTATIONS = 499
_QUADRATURE_POINTS = 60

Row = dict[str, Any]


def coins(generator: np.random.Generator, observers: int, items: int) -> Tournaments:
    """Return the tournaments of observers who toss a coin for every pair."""
    return _tournaments(generator.integers(0, 2, size=(observers, math.comb(items, 2))), items)


def tastes(
    generator: np.random.Generator, observers: int, items: int, conditions: int = 1
) -> Tournaments:
    """Return the tournaments of observers who each have an order, unrelated to the others'.

    With several conditions each observer gives the same answers in each.
    """
    place = np.argsort(generator.random((observers, items)), axis=1)
    first, second = np.triu_indices(items, k=1)
    own = _tournaments((place[:, first] < place[:, second]).astype(np.int64), items)
    return np.tile(own, (conditions, 1, 1))


@dataclass(frozen=True)
class Population:
    """Observers whose values of the items scatter normally about common ones, in JOD.

    Attributes
    ----------
    model
        By which they answer.
    values_jod
        The common values.
    spread_jod
        The standard deviation between observers; 0: all alike.
    """

    model: Model
    values_jod: Matrix
    spread_jod: float

    def draw(self, generator: np.random.Generator, observers: int) -> Tournaments:
        """Return the tournaments of some of them."""
        items = self.values_jod.size
        own = self.values_jod + generator.normal(0, self.spread_jod, size=(observers, items))
        first, second = np.triu_indices(items, k=1)
        share = self.model.probability(self.model.unit * (own[:, first] - own[:, second]))
        return _tournaments((generator.random(share.shape) < share).astype(np.int64), items)

    def shares(self) -> Matrix:
        """Return how often the row's item is preferred by all of them, by quadrature."""
        nodes, weights = np.polynomial.hermite_e.hermegauss(_QUADRATURE_POINTS)
        gap = differences(self.values_jod)[..., None] + math.sqrt(2) * self.spread_jod * nodes
        chosen = self.model.probability(self.model.unit * gap)
        return np.asarray((chosen * weights).sum(axis=-1) / weights.sum())

    def scale(self) -> Matrix:
        """Return the scale that all of them have together, on the model's own axis."""
        wins = self.shares() * (1 - np.eye(self.values_jod.size))
        return np.asarray(fit_values(wins[None], self.model)[0])


def _tournaments(won: Tournaments, items: int) -> Tournaments:
    first, second = np.triu_indices(items, k=1)
    wins = np.zeros((len(won), items, items), dtype=np.int64)
    wins[:, first, second], wins[:, second, first] = won, 1 - won
    return wins


def level(rejections: int, repetitions: int, alpha: float) -> Row:
    """Return a rate of rejection, and how likely it is if the true one is (at most) alpha."""
    both, more = (
        stats.binomtest(rejections, repetitions, alpha, alternative=side).pvalue
        for side in ("two-sided", "greater")
    )
    rate = rejections / repetitions
    return {"rate": rate, "p_nominal": float(both), "p_at_most_nominal": float(more)}


def consistency_sizes(repetitions: int, items: int) -> list[Row]:
    """Return the exact test's true size and the rejections of coins."""
    generator = np.random.default_rng([SEED, 1, items])
    triads = circular_triads(coins(generator, repetitions, items)).tolist()
    p_values = np.array([triads_p_value(d, items) for d in triads])
    rows = []
    for alpha in ALPHAS:
        row: Row = {"items": items, "alpha": alpha}
        row |= level(int((p_values <= alpha).sum()), repetitions, alpha)
        if items < 11:
            row["exact_true_size"] = _size_of_triads(items, alpha, triads_p_value)
            if items > 4:
                row["chi_square_true_size"] = _size_of_triads(items, alpha, triads_chi_square)
        rows.append(row)
    return rows


def _size_of_triads(items: int, alpha: float, p_value: Callable[[int, int], float]) -> float:
    probability = np.array(triad_counts(items)) / 2.0 ** math.comb(items, 2)
    rejected = [p_value(d, items) <= alpha for d in range(probability.size)]
    return float(probability[rejected].sum())


def _exact(sigma: int, observers: int, pairs: int) -> float:
    return agreement_p_value(sigma, observers, pairs)[0]


def _kendall(sigma: int, observers: int, pairs: int) -> float:
    return kendall_chi_square(sigma, observers, pairs).p_value


def _large_sample(sigma: int, observers: int, pairs: int) -> float:
    return large_sample_chi_square(sigma, observers, pairs).p_value


TESTS_OF_U = {"exact": _exact, "kendall": _kendall, "large sample": _large_sample}


def agreement_sizes(repetitions: int, observers: int, items: int) -> list[Row]:
    """Return the true sizes of the three tests of u, and their rejections of coins."""
    generator = np.random.default_rng([SEED, 2, observers, items])
    pairs = math.comb(items, 2)
    won = pair_wins(coins(generator, observers * repetitions, items))
    by_study = won.reshape(repetitions, observers, pairs).sum(axis=1)
    sigmas = [agreeing_pairs(study, observers) for study in by_study]
    rows: list[Row] = []
    for (method, p_value), alpha in product(TESTS_OF_U.items(), ALPHAS):
        rejected = sum(p_value(sigma, observers, pairs) <= alpha for sigma in sigmas)
        rows.append(
            {"observers": observers, "items": items, "method": method, "alpha": alpha}
            | {"true_size": _size_of_sigma(observers, pairs, method, alpha)}
            | level(rejected, repetitions, alpha)
        )
    return rows


def _size_of_sigma(observers: int, pairs: int, method: str, alpha: float) -> float:
    """Return the exact probability that a test rejects coins."""
    least, tail = agreement_tail(observers, pairs)
    probability = -np.diff(np.append(tail, 0.0))
    p_value = TESTS_OF_U[method]
    rejected = [
        place
        for place in np.flatnonzero(probability > 0).tolist()
        if p_value(least + place, observers, pairs) <= alpha
    ]
    return float(probability[rejected].sum())


def group_sizes(repetitions: int, items: int, observers: int) -> list[Row]:
    """Return how often the formula's R_c, and David's D, split equal items."""
    generator = np.random.default_rng([SEED, 3, items, observers])
    feasible = exact_is_feasible(items, observers)
    null = (
        exact_range(items, observers)
        if feasible
        else simulated_range(items, observers, generator, 1_000_000)
    )
    wins = coins(generator, observers * repetitions, items)
    by_study = wins.reshape(repetitions, observers, items, items).sum(axis=(1, 3))
    d = stats.chi2.sf([david_chi_square(s.tolist(), observers) for s in by_study], items - 1)
    rows: list[Row] = []
    for alpha in ALPHAS:
        rounded = math.ceil(critical_difference(items, observers, alpha))
        size = float(null.tail[rounded]) if rounded < null.tail.size else 0.0
        rows.append(
            {"items": items, "observers": observers, "alpha": alpha, "null": null.method}
            | {"formula": rounded, "exact": null.critical(alpha), "formula_true_size": size}
            | level(int(np.count_nonzero(np.ptp(by_study, axis=1) >= rounded)), repetitions, alpha)
            | {"david": level(int(np.count_nonzero(d <= alpha)), repetitions, alpha)}
        )
    return rows


def taste_sizes(
    repetitions: int, observers: int, items: int, conditions: int, alpha: float = 0.05
) -> list[Row]:
    """Return how often tests find a difference among observers with nothing in common."""
    generator = np.random.default_rng([SEED, 4, observers, items, conditions])
    people = list(range(observers)) * conditions
    counted = dict.fromkeys(
        ("formula", "permuted", "david", "permuted_david", "u_coins", "u_permuted"), 0
    )
    for _ in range(repetitions):
        wins = tastes(generator, observers, items, conditions)
        groups = score_groups(
            wins, alpha, observers=people, generator=generator, permutations=PERMUTATIONS
        )
        counted["formula"] += len(groups.groups) > 1
        counted["permuted"] += groups.permuted_range_p_value <= alpha
        counted["david"] += groups.p_value <= alpha
        counted["permuted_david"] += groups.permuted_p_value <= alpha
        u = agreement(wins[:observers], generator, PERMUTATIONS)
        counted["u_coins"] += u.p_value <= alpha
        counted["u_permuted"] += u.permutation_p_value <= alpha
    return [
        {"observers": observers, "items": items, "conditions": conditions, "alpha": alpha}
        | {name: level(number, repetitions, alpha) for name, number in counted.items()}
    ]


def scale_coverage(
    repetitions: int,
    name: ModelName,
    items: int,
    span_jod: float,
    spread_jod: float,
    observers: int,
) -> list[Row]:
    """Return how often the intervals of items, and of differences, hold the truth.

    The items lie evenly over `span_jod`.
    """
    model = MODELS[name]
    generator = np.random.default_rng([SEED, 5, observers, items, int(span_jod), int(spread_jod)])
    values_jod = np.linspace(-span_jod / 2, span_jod / 2, items)
    population = Population(model, values_jod, spread_jod)
    every = np.eye(items)
    first, second = np.triu_indices(items, k=1)
    contrasts = np.concatenate([every - 1 / items, every[first] - every[second]])
    truth = contrasts @ population.scale()
    held: dict[str, list[NDBool]] = {kind: [] for kind in INTERVALS}
    without = 0
    for _ in range(repetitions):
        counts = population.draw(generator, observers).astype(float)
        if not has_maximum(counts.sum(axis=0)):
            without += 1
            continue
        for kind, (low, high) in _intervals(counts, contrasts, model, generator).items():
            held[kind].append((low <= truth) & (truth <= high))
    shares = {kind: np.mean(inside, axis=0) for kind, inside in held.items()}
    return [
        {"model": name, "items": items, "observers": observers}
        | {"span_jod": span_jod, "spread_jod": spread_jod, "no_finite_scale": without}
        | {"items_held": {kind: float(share[:items].mean()) for kind, share in shares.items()}}
        | {"gaps_held": {kind: float(share[items:].mean()) for kind, share in shares.items()}}
        | {"worst_held": {kind: float(share.min()) for kind, share in shares.items()}}
    ]


NDBool = np.ndarray[Any, np.dtype[np.bool_]]


def _intervals(
    counts: Matrix, contrasts: Matrix, model: Model, generator: np.random.Generator
) -> dict[str, tuple[Matrix, Matrix]]:
    """Return all kinds of intervals, those over resamples from the same ones."""
    none, pooled = np.zeros(counts.shape[1:]), counts.sum(axis=0)
    values = fit_values(pooled[None], model)[0]
    drawn = resample_observers(counts, none, model, generator, RESAMPLES).estimates
    spreads = {
        **dict.fromkeys(FROM_RESAMPLES, drawn),
        "sandwich": sandwich(counts, none, values, model),
        "fisher": covariance(pooled, values, model),
    }
    return {
        kind: interval_of_contrasts(kind, contrasts, values, spreads[kind], len(counts))
        for kind in INTERVALS
    }


def u_coverage(
    repetitions: int, items: int, span_jod: float, spread_jod: float, observers: int
) -> list[Row]:
    """Return how often the interval of u holds the population's u, and the mean of u."""
    generator = np.random.default_rng([SEED, 6, items, observers])
    values_jod = np.linspace(-span_jod / 2, span_jod / 2, items)
    population = Population(MODELS["thurstone"], values_jod, spread_jod)
    share = population.shares()[np.triu_indices(items, k=1)]
    truth = float(((2 * share - 1) ** 2).mean())
    found = [agreement(population.draw(generator, observers)).u for _ in range(repetitions)]
    return [
        {"items": items, "observers": observers, "span_jod": span_jod, "spread_jod": spread_jod}
        | {"truth": truth, "mean": statistics.fmean(one.value for one in found)}
        | {"held": statistics.fmean(not (one.high < truth or one.low > truth) for one in found)}
    ]


def _seconds(work: Callable[[], object], repeats: int = 5) -> float:
    """Return the median time of some repeats."""
    times = []
    for _ in range(repeats):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return statistics.median(times)


def speed(_: int, observers: int, items: int) -> list[Row]:
    """Return the time of the observer bootstrap beside choix in a loop, and of exact tests."""
    generator = np.random.default_rng([SEED, 7])
    population = Population(MODELS["bradley-terry"], np.linspace(-1, 1, items), 0.5)
    wins = population.draw(generator, observers)
    samples = generator.integers(0, observers, size=(RESAMPLES, observers))

    def ours(name: ModelName) -> None:
        scale_pairs(wins, model=name, generator=np.random.default_rng(1))

    def spectral() -> None:
        for sample in samples:
            choix.ilsr_pairwise_dense(wins[sample].sum(axis=0).astype(float), alpha=1e-3)

    def newton() -> None:
        for sample in samples[: RESAMPLES // 10]:
            counts = wins[sample].sum(axis=0)
            data = [(int(i), int(j)) for i, j in np.argwhere(counts) for _ in range(counts[i, j])]
            choix.opt_pairwise(items, data, alpha=1e-3)

    times = {f"{name}_s": _seconds(partial(ours, name)) for name in MODELS}
    times |= {"choix_ilsr_pairwise_dense_s": _seconds(spectral, 3)}
    times |= {"choix_opt_pairwise_s": 10 * _seconds(newton, 3)}
    exact: dict[str, Callable[[], object]] = {
        "u_of_50_observers_10_items_s": partial(agreement_tail.__wrapped__, 50, 45),
        "triads_of_10_items_s": partial(triad_counts.__wrapped__, 10),
        "range_of_44_observers_3_items_s": partial(exact_range.__wrapped__, 3, 44),
        "range_of_44_observers_4_items_s": partial(exact_range.__wrapped__, 4, 44),
    }
    return [
        {"resamples": RESAMPLES, "observers": observers, "items": items, "bootstrap": times}
        | {"choix_over_ours": times["choix_ilsr_pairwise_dense_s"] / times["bradley-terry_s"]}
        | {"exact": {name: _seconds(work, 3) for name, work in exact.items()}}
    ]


PARTS: dict[str, tuple[Callable[..., list[Row]], Sequence[tuple[Any, ...]]]] = {
    "speed": (speed, [(20, 6)]),
    "consistency": (consistency_sizes, [(3,), (4,), (5,), (6,), (8,), (10,), (11,), (12,), (15,)]),
    "agreement": (agreement_sizes, [(5, 4), (15, 3), (15, 6), (30, 4), (44, 3), (50, 6)]),
    "groups": (group_sizes, list(product((3, 4, 5, 6, 8), (5, 10, 15, 20, 30, 44)))),
    "tastes": (taste_sizes, [(20, 3, 1), (44, 3, 1), (20, 6, 1), (44, 3, 4)]),
    "scale": (
        scale_coverage,
        [
            (name, items, *spans, observers)
            for name, items, spans, observers in product(
                MODELS, (3, 6), ((2.0, 0.0), (2.0, 1.0), (4.0, 1.0)), (8, 15, 30, 50)
            )
        ],
    ),
    "u": (
        u_coverage,
        [
            (items, *spans, observers)
            for items, spans, observers in product(
                (3, 6), ((0.0, 0.0), (0.0, 1.0), (1.0, 0.5), (3.0, 0.5)), (8, 15, 30, 50)
            )
        ],
    ),
}


def run(part: str, repetitions: int, processes: int) -> list[Row]:
    """Run a part, its cells side by side; each has a seed of its own."""
    work, cells = PARTS[part]
    tasks = [partial(work, repetitions, *cell) for cell in cells]
    if processes < 2 or len(tasks) < 2:
        return [row for task in tasks for row in task()]
    with ProcessPoolExecutor(processes) as pool:
        return [row for rows in pool.map(_call, tasks) for row in rows]


def _call(task: Callable[[], list[Row]]) -> list[Row]:
    return task()


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--repetitions", type=int, default=2000)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS))
    parser.add_argument("--output", type=Path)
    given = parser.parse_args()
    result: Row = {"machine": machine(), "repetitions": given.repetitions, "seed": SEED}
    for part in given.parts:
        started = time.perf_counter()
        result[part] = run(part, given.repetitions, given.processes)
        result[f"{part}, seconds"] = time.perf_counter() - started
    write_result(result, given.output)


if __name__ == "__main__":
    main()
