import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.errors import InputError
from analysis.estimates import to_json
from analysis.thresholds.bayesian_fit import fit_threshold
from analysis.thresholds.maximum_likelihood import maximum_likelihood
from analysis.thresholds.observer_bootstrap import fit_observers, interval_of
from analysis.thresholds.over_participants import participant_interval
from analysis.thresholds.sigmoid import rate_at

LEVELS = np.arange(10.0, 91.0, 10.0)
GUESS_RATE = 1 / 8
ANSWERS = 6


def people(number: int, spread: float, seed: int, threshold: float = 35) -> NDArray[np.int64]:
    """Right answers of people whose thresholds differ with a standard deviation."""
    generator = np.random.default_rng(seed)
    own = generator.normal(threshold, spread, (number, 1))
    return generator.binomial(ANSWERS, rate_at(LEVELS, own, 30, GUESS_RATE, 0.02))


def all_answers(correct: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.full(correct.shape, ANSWERS)


@pytest.mark.parametrize("spread", [0.0, 10.0])
def test_interval_agrees_with_the_cluster_robust_one(spread: float) -> None:
    # Another method: the sandwich error of psignifit's fit.
    correct = people(50, spread, 1)
    found = fit_observers(
        LEVELS, correct, all_answers(correct), GUESS_RATE, np.random.default_rng(1)
    )
    fit = fit_threshold(LEVELS, found.correct, found.total, GUESS_RATE)
    other = participant_interval(fit, correct, all_answers(correct))
    length = other.high - other.low
    assert found.threshold.value == pytest.approx(fit.threshold.value, abs=0.1 * length)
    assert found.threshold.high - found.threshold.low == pytest.approx(length, rel=0.2)


def test_resamples_are_fits_of_redrawn_observers() -> None:
    # Property: a resample is the plain fit of the rows it drew.
    correct = people(8, 5.0, 2)
    found = fit_observers(
        LEVELS, correct, all_answers(correct), GUESS_RATE, np.random.default_rng(4), resamples=5
    )
    assert found.drawn is not None
    counts = np.random.default_rng(4).multinomial(8, np.full(8, 1 / 8), size=5)
    rows = np.repeat(np.arange(8), counts[3])
    again = maximum_likelihood(
        LEVELS, correct[rows].sum(axis=0)[None], np.full((1, 9), 8 * ANSWERS), GUESS_RATE
    )
    assert found.drawn.threshold[3] == pytest.approx(again.threshold[0], abs=1e-3)


def test_stated_share_lies_on_the_curve() -> None:
    correct = people(20, 5.0, 3)
    found = fit_observers(
        LEVELS, correct, all_answers(correct), GUESS_RATE, np.random.default_rng(1), resamples=200
    )
    stated = found.threshold_at(0.75)
    rate = rate_at(
        stated.threshold.value,
        found.threshold.value,
        found.width.value,
        GUESS_RATE,
        found.lapse_rate.value,
    )
    assert rate == pytest.approx(0.75)
    assert stated.threshold.low < stated.threshold.value < stated.threshold.high
    assert stated.definition != found.definition
    assert stated.method == found.method


def test_beyond_the_levels_is_infinite() -> None:
    guessing = np.random.default_rng(1).binomial(ANSWERS, 1 / 8, size=(10, 9))
    found = fit_observers(
        LEVELS, guessing, all_answers(guessing), GUESS_RATE, np.random.default_rng(1), 100
    )
    assert (found.reached, found.threshold.value, found.threshold.high) == ("above", np.inf, np.inf)


def test_interval_of_values_of_which_some_are_unknown() -> None:
    # Property: unknown values widen the interval on both sides.
    values = np.linspace(0, 1, 1000)
    low, high = interval_of(values, 10**6)
    assert (low, high) == pytest.approx((0.025, 0.975), abs=2e-3)
    assert interval_of(np.where(values > 0.9, np.inf, values), 10**6)[1] == np.inf
    assert interval_of(np.where(values > 0.9, np.nan, values), 10**6) == (-np.inf, np.inf)


def test_one_seed_one_result_and_a_row_that_says_what_it_is() -> None:
    correct = people(10, 5.0, 5)
    first, second = (
        fit_observers(
            LEVELS, correct, all_answers(correct), GUESS_RATE, np.random.default_rng(9), 100
        )
        for _ in range(2)
    )
    assert first == second
    row = first.to_frame().iloc[0]
    assert row["seed"] == 9
    assert row["participants"] == 10
    assert row["resamples"] == 100
    assert "maximum likelihood" in row["method"]
    assert row["definition"] == "mid-point of a psychometric function"
    assert "drawn" not in to_json(first)


def test_refuses() -> None:
    correct = people(4, 0.0, 6)
    total, generator = all_answers(correct), np.random.default_rng(1)
    with pytest.raises(InputError, match="1 participants given, two or more accepted"):
        fit_observers(LEVELS, correct[:1], total[:1], GUESS_RATE, generator)
    with pytest.raises(InputError, match="0 participants given, two or more accepted"):
        fit_observers(LEVELS, correct[:0], total[:0], GUESS_RATE, generator)
    with pytest.raises(InputError, match="resamples: 0 given, 1 or more"):
        fit_observers(LEVELS, correct, total, GUESS_RATE, generator, resamples=0)
    with pytest.raises(InputError, match="a level without any answer"):
        fit_observers(LEVELS, correct * 0, total * (LEVELS > 10), GUESS_RATE, generator)
    with pytest.raises(InputError, match=r"above the guess rate of 0\.125"):
        fit_observers(LEVELS, correct, total, GUESS_RATE, generator, 10).threshold_at(0.1)
