"""Whether tests and intervals of rankings hold what they promise, and how fast; as JSON.

    python -m benchmarks.ranking [--repetitions 2000] [--output FILE]

Under the null hypothesis every order is equally likely; else participants rank by the model of
Plackett and Luce, with five items of which one is nearly always last. Intervals of 95 % are
counted as holding the true mean rank, standard deviation or log worth. The last part times the
bootstrap of a Plackett-Luce scale beside a loop over choix.
"""

import argparse
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import choix
import numpy as np
from numpy.typing import NDArray
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix, bootstrap_means
from analysis.bounded_means import mean_interval
from analysis.ranking.comparisons import critical_difference, p_conover
from analysis.ranking.friedman import concordance, exact_p_value
from analysis.ranking.mean_ranks import normal_fit
from analysis.ranking.plackett_luce import plackett_luce
from benchmarks.results import machine, write_result

SEED = 2011
ALPHA = 0.05
LOG_WORTHS = np.array([2.0, 1.0, 0.5, 0.0, -1.5])
DESIGNS = ((5, 4), (10, 4), (15, 5), (30, 5), (44, 6), (87, 6))  # participants, items
PARTICIPANTS = (5, 10, 20, 30, 44, 87)
_FIT_REPETITIONS = 400


def draw_rankings(
    log_worths: Matrix, participants: int, repetitions: int, generator: np.random.Generator
) -> Matrix:
    """Return rankings by Plackett-Luce observers, shape (repetitions, participants, items)."""
    shape = (repetitions, participants, len(log_worths))
    utilities = np.asarray(log_worths) + generator.gumbel(size=shape)
    return np.asarray(stats.rankdata(-utilities, axis=-1), dtype=float)


def mean_ranks(log_worths: Matrix) -> Matrix:
    """Return the true mean ranks: 1 plus the probabilities that another item is ahead."""
    worths = np.exp(log_worths)
    ahead = worths / (worths + worths[:, None])
    return np.asarray(0.5 + ahead.sum(axis=1))


def rejected(
    participants: int, items: int, repetitions: int, generator: np.random.Generator
) -> dict[str, float]:
    """Return how often each form of Friedman's test rejects when every order is equally likely."""
    ranks = draw_rankings(np.zeros(items), participants, repetitions, generator)
    w = concordance(ranks)
    freedom = items - 1
    rates = {
        "chi_square": stats.chi2.sf(participants * freedom * w, freedom) < ALPHA,
        "f": stats.f.sf((participants - 1) * w / (1 - w), freedom, freedom * (participants - 1))
        < ALPHA,
    }
    exact = _exact_of(ranks)
    if exact is not None:
        rates["exact"] = exact < ALPHA
    return {name: float(np.mean(hits)) for name, hits in rates.items()}


def falsely_split(
    participants: int, items: int, repetitions: int, generator: np.random.Generator
) -> dict[str, float]:
    """Return how often at least one pair is found to differ when every order is equally likely."""
    ranks = draw_rankings(np.zeros(items), participants, repetitions, generator)
    ranges = np.ptp(ranks.mean(axis=1), axis=1)
    split = {
        "nemenyi": ranges >= critical_difference(participants, items, ALPHA),
        "conover": np.array([p_conover(one).min() < ALPHA for one in ranks]),
    }
    return {name: float(np.mean(hits)) for name, hits in split.items()}


def _exact_of(ranks: Matrix) -> Matrix | None:
    """Return exact p-values, each outcome's computed once; None where they take too long."""
    if exact_p_value(ranks[0]) is None:
        return None
    found: dict[int, float] = {}
    p_values = []
    for one in ranks:
        squares = int((one.sum(axis=0) ** 2).sum())
        if squares not in found:
            found[squares] = exact_p_value(one) or 0.0
        p_values.append(found[squares])
    return np.array(p_values)


@cache
def _true_deviations() -> Matrix:
    ranks = draw_rankings(LOG_WORTHS, 1_000_000, 1, np.random.default_rng(SEED))[0]
    return np.asarray(ranks.std(axis=0))


def covered_mean_ranks(
    participants: int, repetitions: int, generator: np.random.Generator, resamples: int = 1000
) -> dict[str, list[float]]:
    """Return how often intervals hold the truth, by kind of interval and item."""
    means, deviations = mean_ranks(LOG_WORTHS), _true_deviations()
    items = len(means)
    hits: dict[str, list[NDArray[np.bool_]]] = {}
    for ranks in draw_rankings(LOG_WORTHS, participants, repetitions, generator):
        fit = normal_fit(ranks).to_numpy().T
        error = fit[3] / np.sqrt(participants)
        ends = {
            "wilson_type": (*mean_interval(fit[0], error, participants, (1, items)), means),
            "t": (fit[1], fit[2], means),
            "bootstrap": (
                *bootstrap_means(ranks, np.ones_like(ranks), generator, resamples),
                means,
            ),
            "standard_deviation": (fit[4], fit[5], deviations),
        }
        for kind, (low, high, truth) in ends.items():
            hits.setdefault(kind, []).append((low <= truth) & (truth <= high))
    return {kind: np.mean(each, axis=0).tolist() for kind, each in hits.items()}


def covered_scale(
    participants: int, repetitions: int, generator: np.random.Generator
) -> dict[str, float]:
    """Return how often intervals of a log worth hold the truth, over all items."""
    truth = LOG_WORTHS - LOG_WORTHS.mean()
    hits: dict[str, list[float]] = {"over_participants": [], "bootstrap": [], "likelihood": []}
    refused = 0
    for ranks in draw_rankings(LOG_WORTHS, participants, repetitions, generator):
        try:
            scale = plackett_luce(ranks, generator=generator, resamples=500)
        except InputError:  # an item ahead of all others in every ranking
            refused += 1
            continue
        table = scale.table.sort_values("item")
        worth = table["log_worth"].to_numpy()
        reach = 1.96 * table["standard_error"].to_numpy()
        ends = {
            "over_participants": (table["low"], table["high"]),
            "bootstrap": (table["low_bootstrap"], table["high_bootstrap"]),
            "likelihood": (worth - reach, worth + reach),
        }
        for kind, (low, high) in ends.items():
            hits[kind].append(float(np.mean((low <= truth) & (truth <= high))))
    rates = {kind: float(np.mean(each)) if each else np.nan for kind, each in hits.items()}
    return {**rates, "refused": refused / repetitions}


def seconds_of(run: Callable[[], Any], times: int = 5) -> float:
    """Return the median time of some runs."""
    seconds = []
    for _ in range(times):
        started = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - started)
    return float(np.median(seconds))


def bootstrap_beside_choix(resamples: int = 500) -> dict[str, float]:
    """Time the bootstrap of a scale of six items by 20 participants."""
    generator = np.random.default_rng(SEED)
    ranks = draw_rankings(np.append(LOG_WORTHS, -0.3), 20, 1, generator)[0]
    orders = [np.argsort(row).tolist() for row in ranks]
    drawn = generator.integers(0, 20, size=(resamples, 20))

    def loop() -> None:
        for rows in drawn:
            choix.ilsr_rankings(6, [orders[row] for row in rows], alpha=0.01)

    ours = seconds_of(
        lambda: plackett_luce(ranks, generator=np.random.default_rng(1), resamples=resamples)
    )
    theirs = seconds_of(loop, times=1)
    return {"seconds": ours, "choix_seconds": theirs, "ratio": theirs / ours}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=2000)
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    repetitions = arguments.repetitions
    fits = min(repetitions, _FIT_REPETITIONS)
    generator = np.random.default_rng(SEED)
    result = {
        "machine": machine(),
        "seed": SEED,
        "repetitions": repetitions,
        "repetitions_of_fits": fits,
        "rejected_under_the_null": {
            f"{participants} participants, {items} items": rejected(
                participants, items, repetitions, generator
            )
            for participants, items in DESIGNS
        },
        "equal_items_split": {
            f"{participants} participants, {items} items": falsely_split(
                participants, items, repetitions, generator
            )
            for participants, items in DESIGNS
        },
        "mean_rank_intervals_hold_the_truth": {
            participants: covered_mean_ranks(participants, repetitions, generator)
            for participants in PARTICIPANTS
        },
        "log_worth_intervals_hold_the_truth": {
            participants: covered_scale(participants, fits, generator)
            for participants in PARTICIPANTS[1:]
        },
        "bootstrap_of_a_scale": bootstrap_beside_choix(),
    }
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
