"""Power: how many participants it takes to find a difference that is there."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd
from scipy import stats

from algorithms.errors import InputError
from analysis.estimates import CONFIDENCE, Estimate, seed_of, software_version

ALPHA: Final = 0.05


@dataclass(frozen=True)
class Outcome:
    """What one simulated study finds; NaN where it can tell nothing."""

    estimate: float
    p_value: float


Run = Callable[[Sequence[int], np.random.Generator], Sequence[Outcome]]
"""Simulates a study once and returns what its first n participants find, for each n."""


@dataclass(frozen=True)
class PowerCurve:
    """How often a difference is found with so many participants.

    Attributes
    ----------
    participants
        Numbers of participants, rising.
    power
        By number: the share of runs whose p-value is below alpha, with the exact 95 % interval of
        Clopper and Pearson (1934) over runs.
    means, deviations
        By number: mean and standard deviation of the estimates over the runs that have one.
    failed
        By number: how many runs told nothing; they count as not found.
    runs, alpha
        How many runs, and the significance.
    quantity, test
        What is estimated, and how it is tested.
    seed, version
        Of the generator, and of Trompe.
    """

    participants: tuple[int, ...]
    power: tuple[Estimate, ...]
    means: tuple[float, ...]
    deviations: tuple[float, ...]
    failed: tuple[int, ...]
    runs: int
    alpha: float
    quantity: str
    test: str
    seed: int | None
    version: str

    def needed(self, power: float = 0.8) -> int | None:
        """Return the smallest number from which on the power is at least this, or None."""
        needed = None
        for number, found in zip(self.participants[::-1], self.power[::-1], strict=True):
            if found.value < power:
                break
            needed = number
        return needed

    def to_frame(self) -> pd.DataFrame:
        """Return one row a number of participants."""
        return pd.DataFrame(
            {
                "participants": self.participants,
                "power": [each.value for each in self.power],
                "power_low": [each.low for each in self.power],
                "power_high": [each.high for each in self.power],
                "mean_estimate": self.means,
                "sd_estimate": self.deviations,
                "failed": self.failed,
                "runs": self.runs,
                "alpha": self.alpha,
                "quantity": self.quantity,
                "test": self.test,
                "seed": self.seed,
                "version": self.version,
                "simulated": True,
            }
        )


def power_curve(
    run: Run,
    participants: Sequence[int],
    runs: int,
    generator: np.random.Generator,
    *,
    quantity: str,
    test: str,
    alpha: float = ALPHA,
    on_run: Callable[[int, int], None] | None = None,
) -> PowerCurve:
    """Simulate a study many times and count how often its difference is found.

    Parameters
    ----------
    run
        Simulates and tests it once.
    participants
        How many take part, two or more each; put in rising order.
    runs
        How often, 1 or more.
    generator
        Where chance comes from; each run has a generator of its own, spawned from it.
    quantity, test
        What `run` estimates and how it tests it, in words.
    alpha
        The significance, above 0 and below 1.
    on_run
        Called after each run with the number of runs done, and of all.

    Raises
    ------
    InputError
        If a number is out of its range.

    Notes
    -----
    One run serves all numbers of participants: its first n take part in the smaller study. Points
    of the curve so share their chance, and differences between them are surer than each is.
    """
    numbers = sorted(set(participants))
    if not numbers or numbers[0] < 2:
        raise InputError(f"participants: {list(participants)} given, 2 or more each accepted")
    if runs < 1:
        raise InputError(f"runs: {runs} given, 1 or more accepted")
    if not 0 < alpha < 1:
        raise InputError(f"alpha: {alpha} given, above 0 and below 1 accepted")
    outcomes = []
    for done, own in enumerate(generator.spawn(runs), start=1):
        outcomes.append(run(numbers, own))
        if on_run is not None:
            on_run(done, runs)
    p_values = np.array([[each.p_value for each in one] for one in outcomes], np.float64)
    estimates = np.array([[each.estimate for each in one] for one in outcomes], np.float64)
    told = np.isfinite(p_values)
    columns = [column[np.isfinite(column)] for column in estimates.T]
    return PowerCurve(
        participants=tuple(numbers),
        power=tuple(_share(int(np.sum(column < alpha)), runs) for column in p_values.T),
        means=tuple(float(c.mean()) if c.size else float("nan") for c in columns),
        deviations=tuple(float(c.std(ddof=1)) if c.size > 1 else float("nan") for c in columns),
        failed=tuple(int(count) for count in (~told).sum(axis=0)),
        runs=runs,
        alpha=alpha,
        quantity=quantity,
        test=test,
        seed=seed_of(generator),
        version=software_version(),
    )


def _share(found: int, runs: int) -> Estimate:
    interval = stats.binomtest(found, runs).proportion_ci(CONFIDENCE)
    return Estimate(found / runs, float(interval.low), float(interval.high))
