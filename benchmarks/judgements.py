"""Whether intervals and tests of preferences and of d' hold what they promise, as JSON.

    python -m benchmarks.judgements [--repetitions 2000] [--output FILE]

With one answer a participant everything is summed exactly over the binomial distribution. With
several, participants' own shares are drawn from a beta distribution whose answers correlate with
0.1. For d', participants' criteria differ with a standard deviation of 0.4; the truth is the
sensitivity of the pooled answers of endlessly many of them.
"""

import argparse
from pathlib import Path

import numpy as np
from scipy import stats
from scipy.special import ndtri

from analysis.bounded_means import mean_interval, p_above, ratio_of_sums
from analysis.judgements.detection import sensitivity
from analysis.judgements.preference import preference
from analysis.judgements.shares import Binomial, check_answers, share_interval
from benchmarks.results import machine, write_result

SEED = 2011
ALPHA = 0.05
MARGIN = 0.1
CORRELATION = 0.1
D_PRIME, CRITERION, SPREAD = 0.8, -0.3, 0.4  # of observers; they call most images real
SINGLE = (10, 17, 30, 36, 44, 100)  # participants with one answer each
REPEATED = ((8, 18), (16, 3), (16, 18), (30, 6), (44, 4))  # participants, answers of each
YES_NO = ((10, 6), (20, 6), (30, 6), (44, 6), (30, 12))  # participants, images of a kind for each


def covered_single(participants: int, share: float, binomial: Binomial) -> float:
    """Return the probability that an interval holds the share, exactly."""
    holds = []
    for chosen in range(participants + 1):
        answers = check_answers(np.repeat([1, 0], [chosen, participants - chosen]))
        estimate, _ = share_interval(answers, binomial)
        holds.append(estimate.low <= share <= estimate.high)
    chances = stats.binom.pmf(np.arange(participants + 1), participants, share)
    return float(np.asarray(holds) @ chances)


def sizes_single(participants: int) -> dict[str, float]:
    """Return the probability of a false "differs" at one half, and "equivalent" at the margin."""
    counts = np.arange(participants + 1)
    outcomes = np.array(
        [
            preference(np.repeat([1, 0], [k, participants - k]), margin=MARGIN).outcome
            for k in counts
        ]
    )
    at_half = stats.binom.pmf(counts, participants, 0.5)
    at_margin = stats.binom.pmf(counts, participants, 0.5 + MARGIN)
    return {
        "differs": float(at_half[outcomes == "differs"].sum()),
        "equivalent": float(at_margin[outcomes == "equivalent"].sum()),
    }


def repeated(
    participants: int, asked: int, repetitions: int, generator: np.random.Generator
) -> dict[str, float]:
    """Return what holds with several answers a participant: coverage and false verdicts."""
    result = {}
    for share in (0.5, 0.5 + MARGIN, 0.85):
        scale = 1 / CORRELATION - 1
        own = generator.beta(scale * share, scale * (1 - share), size=(participants, repetitions))
        totals = np.asarray(generator.binomial(asked, own), dtype=float)
        mean, error = ratio_of_sums(totals, np.full(own.shape, float(asked)))
        low, high = mean_interval(mean, error, participants)
        result[f"covered_{share:g}"] = float(np.mean((low <= share) & (share <= high)))
        above, below = (p_above(one, error, participants, 0.5) for one in (mean, 1 - mean))
        beyond = [p_above(one, error, participants, 0.5 - MARGIN) for one in (mean, 1 - mean)]
        if share == 0.5:
            result["differs"] = float(np.mean(2 * np.minimum(above, below) < ALPHA))
        if share == 0.5 + MARGIN:
            result["equivalent"] = float(np.mean(np.maximum(*beyond) < ALPHA))
    return result


def covered_d_prime(
    participants: int, images: int, repetitions: int, generator: np.random.Generator
) -> dict[str, float]:
    """Return how often intervals hold the d' and the criterion of pooled answers."""
    spread = np.hypot(1, SPREAD)
    rates = stats.norm.cdf(
        [(D_PRIME / 2 - CRITERION) / spread, (-D_PRIME / 2 - CRITERION) / spread]
    )
    z = np.asarray(ndtri(rates))
    truth = {"d_prime": z[0] - z[1], "criterion": -z.sum() / 2}
    hits: dict[str, list[bool]] = {}
    shown = np.full(participants, images)
    for _ in range(repetitions):
        own = CRITERION + SPREAD * generator.standard_normal(participants)
        yes = [
            generator.binomial(images, stats.norm.cdf(side * D_PRIME / 2 - own)) for side in (1, -1)
        ]
        found = sensitivity(yes[0], shown, yes[1], shown, generator=generator, resamples=500)
        for name, value in truth.items():
            interval, drawn = getattr(found, name), found.bootstrap[name]
            reach = 1.96 * found.standard_errors[name]
            for kind, low, high in (
                ("over_participants", interval.low, interval.high),
                ("bootstrap", drawn.low, drawn.high),
                ("independent_answers", interval.value - reach, interval.value + reach),
            ):
                hits.setdefault(f"{name}_{kind}", []).append(bool(low <= value <= high))
    return {name: float(np.mean(each)) for name, each in hits.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=2000)
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    repetitions = arguments.repetitions
    generator = np.random.default_rng(SEED)
    kinds: tuple[Binomial, ...] = ("clopper-pearson", "wilson")
    result = {
        "machine": machine(),
        "seed": SEED,
        "repetitions": repetitions,
        "one_answer_each": {
            n: {
                **{
                    f"{kind}_{share:g}": covered_single(n, share, kind)
                    for kind in kinds
                    for share in (0.5, 0.7, 0.9)
                },
                **sizes_single(n),
            }
            for n in SINGLE
        },
        "several_answers_each": {
            f"{n} x {asked}": repeated(n, asked, repetitions, generator) for n, asked in REPEATED
        },
        "d_prime": {
            f"{n} x {images}": covered_d_prime(n, images, repetitions, generator)
            for n, images in YES_NO
        },
    }
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
