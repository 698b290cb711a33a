import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import optimize, stats
from scipy.special import ndtr, ndtri

from algorithms.errors import InputError
from analysis.thresholds.bayesian_fit import ThresholdFit, fit_threshold
from analysis.thresholds.observer_bootstrap import fit_observers
from analysis.thresholds.over_participants import participant_interval

LEVELS = np.arange(10.0, 91.0, 10.0)
GUESS_RATE = 1 / 8
ANSWERS = 6


def rates(threshold: float, width: float, lapse_rate: float) -> NDArray[np.float64]:
    normal = ndtr((LEVELS - threshold) * 2 * ndtri(0.95) / width)
    return np.asarray(GUESS_RATE + (1 - GUESS_RATE - lapse_rate) * normal)


def people(number: int, spread: float, seed: int) -> NDArray[np.int64]:
    """Right answers of people whose thresholds differ with a standard deviation."""
    generator = np.random.default_rng(seed)
    own = [rates(threshold, 20, 0.02) for threshold in generator.normal(35, spread, number)]
    return generator.binomial(ANSWERS, np.array(own))


def fit(correct: NDArray[np.int64]) -> ThresholdFit:
    return fit_threshold(LEVELS, correct.sum(axis=0), [ANSWERS * len(correct)] * 9, GUESS_RATE)


def most_likely_threshold(correct: NDArray[np.int64]) -> float:
    hits, answers = correct.sum(axis=0), ANSWERS * len(correct)

    def cost(parameters: NDArray[np.float64]) -> float:
        rate = rates(*parameters)
        return -float(hits @ np.log(rate) + (answers - hits) @ np.log(1 - rate))

    bounds = ((0, 100), (5, 200), (1e-3, 0.4))
    return float(optimize.minimize(cost, (35, 30, 0.03), method="L-BFGS-B", bounds=bounds).x[0])


@pytest.mark.parametrize("spread", [0.0, 10.0])
def test_agrees_with_refitting_resampled_participants(spread: float) -> None:
    # Another method: the bootstrap over participants with maximum likelihood refits.
    correct = people(60, spread, 1)
    interval = participant_interval(fit(correct), correct, np.full(correct.shape, ANSWERS))
    generator = np.random.default_rng(2)
    thresholds = [
        most_likely_threshold(correct[generator.integers(0, 60, size=60)]) for _ in range(200)
    ]
    low, high = np.percentile(thresholds, (2.5, 97.5))
    assert interval.high - interval.low == pytest.approx(high - low, rel=0.25)
    assert (interval.high + interval.low) / 2 == pytest.approx((high + low) / 2, abs=1)


def test_widens_where_participants_differ() -> None:
    # Theory: the spread of thresholds alone gives a standard error of 10 / sqrt(60).
    correct = people(60, 10.0, 3)
    interval = participant_interval(fit(correct), correct, np.full(correct.shape, ANSWERS))
    assert interval.high - interval.low > 2 * stats.t.ppf(0.975, 59) * 0.8 * 10 / np.sqrt(60)


def test_no_interval_where_there_can_be_none() -> None:
    one = people(1, 0, 4)
    assert np.isnan(participant_interval(fit(one), one, np.full(one.shape, ANSWERS)).low)
    none = np.zeros((3, 9), int)
    assert np.isnan(participant_interval(fit(none), none, np.full(none.shape, ANSWERS)).low)


@pytest.mark.parametrize("share", [0.3, 0.8])
def test_interval_at_a_stated_share_agrees_with_the_observer_bootstrap(share: float) -> None:
    # Another method: maximum likelihood of resampled participants.
    correct = people(60, 10.0, 6)
    total = np.full(correct.shape, ANSWERS)
    interval = participant_interval(fit(correct), correct, total, share)
    drawn = fit_observers(LEVELS, correct, total, GUESS_RATE, np.random.default_rng(1))
    other = drawn.threshold_at(share).threshold
    length = other.high - other.low
    assert interval.low == pytest.approx(other.low, abs=0.2 * length)
    assert interval.high == pytest.approx(other.high, abs=0.2 * length)


def test_refuses_counts_that_were_not_fitted() -> None:
    correct = people(5, 0, 5)
    with pytest.raises(InputError, match=r"\(participants, 9\) with the sums that were fitted"):
        participant_interval(fit(correct), correct[:4], np.full((4, 9), ANSWERS))
