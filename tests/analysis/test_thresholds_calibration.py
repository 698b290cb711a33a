"""Small versions of benchmarks/thresholds.py, which has the repetitions for real limits."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pandas as pd
import pytest

from analysis.thresholds.sigmoid import rate_at
from benchmarks.thresholds import Row, covered, different, rejected, stated_threshold

REPETITIONS = 40
RESAMPLES = 150


def share(once: Callable[[int], Row]) -> "pd.Series[float]":
    return pd.DataFrame([once(repetition) for repetition in range(REPETITIONS)]).mean()


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.0, 8.0])
def test_intervals_over_observers_hold_the_threshold(spread: float) -> None:
    # Recovery: 30 observers, alike or differing. Of 40 intervals of 95 %, fewer than 33 hold the
    # truth once in 5,000.
    found = share(partial(covered, 30, spread, False, resamples=RESAMPLES))
    assert len(found) == 2
    assert (found >= 33 / 40).all()


def test_threshold_at_a_stated_share_of_differing_observers() -> None:
    # Theory, by a mean over many observers: 75 % of their answers are right there.
    own = np.random.default_rng(1).normal(25, 8, 200_000)
    level = stated_threshold(8.0)
    assert rate_at(level, own, 30, 1 / 8, 0.02).mean() == pytest.approx(0.75, abs=1e-3)


@pytest.mark.slow
def test_nothing_is_found_where_there_is_nothing() -> None:
    # Theory: of 40 tests at 5 %, more than 9 reject once in 10,000.
    assert (share(partial(rejected, 20, False)) <= 9 / 40).all()
    assert (share(partial(different, 20, 8.0, resamples=RESAMPLES)) <= 9 / 40).all()
