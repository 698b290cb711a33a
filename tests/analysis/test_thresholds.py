import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import optimize, stats

from algorithms.errors import InputError
from analysis.thresholds.bayesian_fit import ThresholdFit, fit_threshold

LEVELS = np.arange(10.0, 91.0, 10.0)
GUESS_RATE = 1 / 8


def rates(threshold: float, width: float, lapse_rate: float) -> NDArray[np.float64]:
    deviation = width / (stats.norm.ppf(0.95) - stats.norm.ppf(0.05))
    normal = stats.norm.cdf(LEVELS, threshold, deviation)
    return np.asarray(GUESS_RATE + (1 - GUESS_RATE - lapse_rate) * normal)


def drawn(answers: int, seed: int, threshold: float = 25, width: float = 30) -> NDArray[np.int64]:
    generator = np.random.default_rng(seed)
    return generator.binomial(answers, rates(threshold, width, 0.02))


def fitted(correct: Sequence[int] | NDArray[Any], answers: int) -> ThresholdFit:
    return fit_threshold(LEVELS, correct, np.full(LEVELS.size, answers), GUESS_RATE)


def maximum_likelihood(correct: NDArray[np.int64], answers: int) -> NDArray[np.float64]:
    """Threshold, width and lapse rate by scipy's optimiser: no code or library shared."""

    def cost(parameters: NDArray[np.float64]) -> float:
        return -float(np.sum(stats.binom.logpmf(correct, answers, rates(*parameters))))

    found = optimize.minimize(
        cost, (40, 40, 0.05), method="L-BFGS-B", bounds=((0, 100), (5, 200), (1e-4, 0.4))
    )
    assert found.success
    return np.asarray(found.x)


@pytest.mark.parametrize("seed", range(4))
def test_agrees_with_maximum_likelihood_where_the_prior_hardly_matters(seed: int) -> None:
    # Another implementation. With 2000 answers a level the standard error is about 0.2 deg.
    correct = drawn(2000, seed)
    threshold, width, lapse_rate = maximum_likelihood(correct, 2000)
    fit = fitted(correct, 2000)
    assert fit.threshold.value == pytest.approx(threshold, abs=0.2)
    assert fit.width.value == pytest.approx(width, abs=1.0)
    assert fit.lapse_rate.value == pytest.approx(lapse_rate, abs=0.005)


def test_intervals_shrink_with_the_square_root_of_the_answers() -> None:
    # Theory: a hundred times the answers, a tenth of the interval. psignifit alone stops
    # shrinking, because its first grid is too coarse to find overdispersion 0.
    few, many = (fitted(np.round(n * rates(25, 30, 0.02)), n).threshold for n in (10**4, 10**6))
    assert (few.high - few.low) / (many.high - many.low) == pytest.approx(10, rel=0.25)


def test_interval_is_centred_on_the_posterior_of_symmetric_data() -> None:
    # Property: with many answers the posterior is normal, so the mean halves the interval.
    # psignifit's own percentiles lie half a grid step too low.
    threshold = fitted(np.round(10**5 * rates(25, 30, 0.02)), 10**5).threshold
    middle = (threshold.low + threshold.high) / 2
    assert abs(middle - threshold.value) < 0.02 * (threshold.high - threshold.low)


def test_overdispersed_rates_widen_the_interval() -> None:
    # Recovery: rates drawn around the curve with standard deviation eta * sqrt(p (1 - p)).
    generator = np.random.default_rng(5)
    eta = 0.2
    mean = rates(25, 30, 0.02)
    spread = 1 / eta**2 - 1
    correct = generator.binomial(400, generator.beta(mean * spread, (1 - mean) * spread))
    fit, plain = fitted(correct, 400), fitted(drawn(400, 5), 400)
    assert fit.overdispersion.low < eta < fit.overdispersion.high
    assert plain.overdispersion.high < eta
    assert fit.threshold.high - fit.threshold.low > 2 * (plain.threshold.high - plain.threshold.low)


@pytest.mark.parametrize(
    ("correct", "reached"), [([0] * 9, "above"), ([3] * 9, "above"), ([24] * 9, "below")]
)
def test_says_that_the_threshold_is_not_reached(correct: list[int], reached: str) -> None:
    fit = fitted(correct, 24)
    assert fit.reached == reached
    assert fit.threshold.value == (np.inf if reached == "above" else -np.inf)
    assert np.isnan(fit.rate(LEVELS)).all()


def test_an_end_beyond_the_levels_is_no_number() -> None:
    fit = fitted(np.round(4 * rates(18, 40, 0.0)), 4)
    assert fit.reached == "within"
    assert fit.threshold.low == -np.inf


def test_levels_that_occur_twice_are_pooled_and_empty_ones_dropped() -> None:
    correct, total = drawn(60, 3), np.full(9, 60)
    pooled = fit_threshold(
        [*LEVELS, *LEVELS, 200], [*correct, *correct, 0], [*total, *total, 0], GUESS_RATE
    )
    assert pooled == fit_threshold(LEVELS, 2 * correct, 2 * total, GUESS_RATE)


@pytest.mark.parametrize("guess_rate", [0.0, 0.25, 0.5])
def test_the_guess_rate_is_kept(guess_rate: float) -> None:
    # Theory: the fitted curve is half-way between guess rate and best rate at the threshold.
    generator = np.random.default_rng(1)
    rate = guess_rate + (1 - guess_rate - 0.02) * stats.norm.cdf(LEVELS, 45, 12)
    fit = fit_threshold(LEVELS, generator.binomial(300, rate), [300] * 9, guess_rate)
    middle = (guess_rate + 1 - fit.lapse_rate.value) / 2
    assert fit.rate(fit.threshold.value) == pytest.approx(middle)
    assert fit.correct_at_threshold == pytest.approx(middle)
    assert fit.threshold.low < 45 < fit.threshold.high


@pytest.mark.parametrize("answers", [1, 2, 5, 50])
def test_no_warning_escapes(answers: int) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fit = fitted(drawn(answers, 7), answers)
    assert fit.n == 9 * answers


def test_table_and_definition() -> None:
    frame = fitted(drawn(50, 2), 50).to_frame()
    assert frame["definition"].item() == "mid-point of a psychometric function"
    assert (
        frame["threshold_low"].item() < frame["threshold"].item() < frame["threshold_high"].item()
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"guess_rate": 0.6}, "guess_rate: 0.6 given, 0 to 0.5 accepted"),
        ({"guess_rate": float("nan")}, "guess_rate: nan given"),
        ({"levels": [10, 20]}, "levels, correct, total: 2, 3 and 3 entries given"),
        ({"levels": [[10, 20, 30]]}, r"levels: shape \(1, 3\) given"),
        ({"levels": [10, 20, float("nan")]}, "levels: NaN or infinite"),
        ({"levels": ["low", "middle", "high"]}, "levels: not a sequence of numbers"),
        ({"levels": [10, 10, 10]}, "levels: 1 with answers given, two or more"),
        ({"correct": [1, 2, 11]}, "correct: more right answers than answers"),
        ({"correct": [1, 2, -1]}, "correct: whole numbers of 0 or more"),
        ({"correct": [1, 2, 2.5]}, "correct: whole numbers of 0 or more"),
        ({"total": [0, 0, 0], "correct": [0, 0, 0]}, "levels: 0 with answers given"),
        ({"total": []}, "levels, correct, total: 3, 3 and 0 entries"),
        ({"grid_steps": {"treshold": 40}}, "grid_steps: .* 3 or more for each of threshold"),
    ],
)
def test_refuses(change: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {
        "levels": [10, 20, 30],
        "correct": [1, 5, 9],
        "total": [10, 10, 10],
        "guess_rate": GUESS_RATE,
    }
    with pytest.raises(InputError, match=message):
        fit_threshold(**good | change)
