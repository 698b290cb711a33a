"""Adaptive designs against fixed ones and against the `questplus` library, as JSON.

    python -m benchmarks.adaptive [--repetitions 200] [--output FILE]

`quest_plus`: thresholds drawn over the levels are sought by QUEST+, by the same levels in random
order, and by the library that PsychoPy uses, on one grid and with one observer; `reach` is after
how many trials the posterior's standard deviation is at most 5 (median; None if never in most
runs). `staircase`: the share of right answers and the level where staircases settle, beside their
targets. `active_pairs`: 30 images with known qualities, 8 participants with 30 pairs each, every
one told what those before answered; as many random pairs without repetition, and the whole
design (435 pairs) for comparison, all scaled by the same posterior.
"""

import argparse
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from scipy.special import ndtri
from scipy.stats import spearmanr

from benchmarks.results import machine, write_result
from experiments.planning.adaptive.active_pairs import ScalePosterior
from experiments.planning.adaptive.quest_plus import QuestPlusTrack
from experiments.planning.adaptive.staircase import StaircaseTrack, staircase_target
from experiments.psychometric import psychometric_function
from experiments.responses import Response
from experiments.simulated.item_observers import NOISE_OF_A_DIFFERENCE, ItemObserver
from experiments.simulated.simulation import simulate_rows
from experiments.study import Study
from experiments.study_parts import QuestPlus, Staircase
from stimuli.manifest import Stimulus, StimulusSet

SEED = 2017
LEVELS = tuple(float(level) for level in range(0, 91, 5))
WIDTH, LAPSE_RATE, GUESS_RATE = 25.0, 0.02, 1 / 8
RULE = QuestPlus(thresholds=46, widths=(12.5, 25.0, 50.0), trials=80)
WANTED_SD = 5.0
IMAGES, PARTICIPANTS, PAIRS = 30, 8, 30
SPREAD_JOD = 1.5


class Procedure(Protocol):
    """What proposes levels and learns from answers."""

    def choose(self) -> float:
        """Return the level of the next trial."""

    def learn(self, level: float, *, right: bool) -> None:
        """Take an answer."""

    def estimate(self) -> dict[str, float | int | None]:
        """Return the threshold and its standard deviation."""


class RandomLevels(QuestPlusTrack):
    """The constant design: every level equally often, in random order, the same estimate."""

    def __init__(self, generator: np.random.Generator) -> None:
        super().__init__(RULE, LEVELS, GUESS_RATE)
        rounds = RULE.trials // len(LEVELS) + 1
        self._order = np.concatenate([generator.permutation(LEVELS) for _ in range(rounds)])

    def choose(self) -> float:
        """Return the level of the next trial."""
        return float(self._order[self.trials])


class Library:
    """The `questplus` library on the same grid."""

    def __init__(self) -> None:
        from questplus import QuestPlus as Peer

        deviations = [width / (ndtri(0.95) - ndtri(0.05)) for width in RULE.widths]
        self._peer = Peer(
            stim_domain={"intensity": list(LEVELS)},
            param_domain={
                "mean": np.linspace(LEVELS[0], LEVELS[-1], RULE.thresholds).tolist(),
                "sd": deviations,
                "lower_asymptote": [GUESS_RATE],
                "lapse_rate": list(RULE.lapse_rates),
            },
            outcome_domain={"response": ["right", "wrong"]},
            func="norm_cdf",
            stim_scale="linear",
        )

    def choose(self) -> float:
        """Return the level of the next trial."""
        return float(self._peer.next_stim["intensity"])

    def learn(self, level: float, *, right: bool) -> None:
        """Take an answer."""
        outcome = {"response": "right" if right else "wrong"}
        self._peer.update(stim={"intensity": level}, outcome=outcome)

    def estimate(self) -> dict[str, float | int | None]:
        """Return the threshold and its standard deviation."""
        marginal = self._peer.marginal_posterior["mean"]
        means = np.linspace(LEVELS[0], LEVELS[-1], RULE.thresholds)
        mean = float(marginal @ means)
        return {"estimate": mean, "sd": float(np.sqrt(marginal @ (means - mean) ** 2))}


def sought(
    make: Callable[[np.random.Generator], Procedure], repetitions: int, trials: Sequence[int]
) -> dict[str, Any]:
    """Return bias, standard deviation and speed of a procedure."""
    errors: dict[int, list[float]] = {count: [] for count in trials}
    reached, seconds, asked = [], 0.0, []
    for run in range(repetitions):
        generator = np.random.default_rng([SEED, run])
        threshold, procedure = generator.uniform(15, 75), make(generator.spawn(1)[0])
        chance = generator.random(max(trials))
        reach = np.inf
        for trial in range(max(trials)):
            start = time.perf_counter()
            level = procedure.choose()
            p = float(psychometric_function(level, threshold, WIDTH, GUESS_RATE, LAPSE_RATE))
            procedure.learn(level, right=bool(chance[trial] < p))
            seconds += time.perf_counter() - start
            asked.append(level)
            found = procedure.estimate()
            if float(found["sd"] or 0) <= WANTED_SD:
                reach = min(reach, trial + 1)
            if trial + 1 in errors:
                errors[trial + 1].append(float(found["estimate"] or 0) - threshold)
        reached.append(reach)
    median = float(np.median(reached))
    return {
        "trials": {
            count: {"bias": float(np.mean(each)), "sd": float(np.std(each))}
            for count, each in errors.items()
        },
        "reach": median if np.isfinite(median) else None,
        "ms_a_trial": 1000 * seconds / (repetitions * max(trials)),
        "levels": asked,
    }


def quest_plus(repetitions: int) -> dict[str, Any]:
    """Compare QUEST+ with the constant design and with the library."""
    trials = (10, 20, 40, RULE.trials)
    ours = sought(lambda _: QuestPlusTrack(RULE, LEVELS, GUESS_RATE), repetitions, trials)
    constant = sought(RandomLevels, repetitions, trials)
    few = min(repetitions, 10)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the library's own dependencies
        library = sought(lambda _: Library(), few, trials)
    same = sum(a == b for a, b in zip(ours.pop("levels"), library.pop("levels"), strict=False))
    constant.pop("levels")
    return {
        "ours": ours,
        "constant": constant,
        "library": library,
        "same_levels_as_library": same / (few * max(trials)),
    }


def staircases(repetitions: int) -> list[dict[str, Any]]:
    """Return where staircases settle."""
    rows = []
    for rule in (
        Staircase(down=2, up=1, trials=400),
        Staircase(down=3, up=1, trials=400),
        Staircase(down=1, up=1, up_factor=3, trials=400),
    ):
        generator = np.random.default_rng(SEED)
        shares, found = [], []
        for _ in range(repetitions):
            track, right = StaircaseTrack(rule, LEVELS), []
            while not track.done:
                level = track.choose()
                p = float(psychometric_function(level, 45, 60, 0, 0))
                right.append(bool(generator.random() < p))
                track.learn(level, right=right[-1])
            shares.append(np.mean(right[50:]))
            found.append(float(track.estimate()["estimate"] or 0))
        at = float(psychometric_function(float(np.mean(found)), 45, 60, 0, 0))
        rows.append(
            {
                "rule": f"{rule.down} down, {rule.up} up, up {rule.up_factor} times as far",
                "target": staircase_target(rule),
                "share_right": float(np.mean(shares)),
                "function_at_mean_reversal": at,
            }
        )
    return rows


def pair_study(kind: str, **design: object) -> tuple[Study, StimulusSet]:
    """Return a study that compares all images, and its set."""
    study = Study.model_validate(
        {
            "name": "images",
            "title": "Images",
            "version": 1,
            "task": "two-alternative",
            "question": "Which is better?",
            "stimuli": {"set": "images", "item": "image"},
            "design": {"kind": kind, "seed": 1, **design},
            "consent": {"version": "1", "text": "Simulated."},
            "stopping": {"participants": 1},
        }
    )
    stimuli = tuple(
        Stimulus(id=f"{n:02d}", file=f"{n}.png", role="main", factors={"image": f"{n:02d}"})
        for n in range(IMAGES)
    )
    files = {each.file: "0" * 64 for each in stimuli}
    made = StimulusSet(
        name="images",
        generator="benchmarks.adaptive",
        parameters={},
        seed=1,
        engine="none",
        versions={},
        exposure=1.0,
        files=files,
        stimuli=stimuli,
    )
    return study, made


def scaled(rows: Sequence[Response], truth: np.ndarray) -> tuple[float, float]:
    """Return rank correlation and RMS error (JOD) of the scale from answers."""
    wins = np.zeros((IMAGES, IMAGES))
    for row in rows:
        better, worse = row.stimuli if row.answer == 1 else row.stimuli[::-1]
        wins[int(better), int(worse)] += 1
    found = ScalePosterior(wins, 2.0 / NOISE_OF_A_DIFFERENCE).qualities * NOISE_OF_A_DIFFERENCE
    error = found - found.mean() - (truth - truth.mean())
    return float(spearmanr(found, truth).statistic), float(np.sqrt(np.mean(error**2)))


def active_pairs(repetitions: int) -> list[dict[str, Any]]:
    """Compare active pairs with random ones, by number of comparisons."""
    rule = {"trials": PAIRS, "each_image": 2}
    active, images = pair_study("active-pairs", active_pairs=rule)
    whole, _ = pair_study("pairs")
    counts = tuple(PAIRS * n for n in range(1, PARTICIPANTS + 1))
    found: dict[tuple[str, int], list[tuple[float, float]]] = {}
    seconds = 0.0
    for run in range(repetitions):
        generator = np.random.default_rng([SEED, run])
        truth = generator.normal(0, SPREAD_JOD, IMAGES)
        observer = ItemObserver({f"{n:02d}": float(q) for n, q in enumerate(truth)})
        start = time.perf_counter()
        answers = simulate_rows(active, images, observer, PARTICIPANTS, generator)
        seconds += time.perf_counter() - start
        random = simulate_rows(whole, images, observer, 1, generator)
        for count in counts:
            found.setdefault(("active", count), []).append(scaled(answers[:count], truth))
            found.setdefault(("random", count), []).append(scaled(random[:count], truth))
        found.setdefault(("whole", len(random)), []).append(scaled(random, truth))
    return [
        {
            "pairs": kind,
            "comparisons": count,
            "rank_correlation": float(np.mean([each[0] for each in results])),
            "rms_error_jod": float(np.mean([each[1] for each in results])),
            "ms_a_trial": 1000 * seconds / (repetitions * max(counts))
            if kind == "active"
            else None,
        }
        for (kind, count), results in sorted(found.items())
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repetitions", type=int, default=200)
    parser.add_argument("--output", type=Path)
    given = parser.parse_args()
    result = {
        "machine": machine(),
        "repetitions": given.repetitions,
        "quest_plus": quest_plus(given.repetitions),
        "staircase": staircases(given.repetitions),
        "active_pairs": active_pairs(max(given.repetitions // 4, 1)),
    }
    write_result(result, given.output)


if __name__ == "__main__":
    main()
