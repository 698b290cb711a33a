"""Thresholds at a stated percent correct, slopes, and the posterior that they come from."""

from dataclasses import replace

import numpy as np
import psignifit
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy import optimize, stats
from scipy.special import xlog1py, xlogy

from algorithms.errors import InputError
from analysis.estimates import to_json
from analysis.thresholds.bayesian_fit import ThresholdFit, fit_threshold
from analysis.thresholds.posterior import Distribution
from analysis.thresholds.sigmoid import WIDTH_IN_SIGMAS, distance_to, rate_at, slope_at_threshold

LEVELS = np.arange(10.0, 91.0, 10.0)
GUESS_RATE = 1 / 8


def fitted(answers: int, seed: int = 1) -> ThresholdFit:
    generator = np.random.default_rng(seed)
    correct = generator.binomial(answers, rate_at(LEVELS, 35, 40, GUESS_RATE, 0.02))
    return fit_threshold(LEVELS, correct, [answers] * 9, GUESS_RATE)


@pytest.fixture(scope="module")
def fit() -> ThresholdFit:
    return fitted(60)


@pytest.mark.parametrize("correct", [0.2, 0.5, 0.75, 0.9])
def test_the_curve_has_the_stated_share_there(fit: ThresholdFit, correct: float) -> None:
    stated = fit.threshold_at(correct)
    assert fit.rate(stated.threshold.value) == pytest.approx(correct)
    assert stated.threshold.low < stated.threshold.value < stated.threshold.high


def test_agrees_with_draws_from_psignifits_posterior() -> None:
    # Another implementation: psignifit's own posterior samples, each turned into a level. Its grid
    # points are whole steps apart, which the tolerance allows for.
    fit = fitted(60)
    data = np.column_stack([LEVELS, fit.correct, fit.total]).astype(float)
    result = psignifit.psignifit(
        data,
        sigmoid="norm",
        experiment_type="yes/no",
        bounds={"gamma": (GUESS_RATE, GUESS_RATE)},
        verbose=False,
        debug=True,
    )
    drawn = result.posterior_samples(10_000, random_state=np.random.default_rng(1))
    for correct in (0.3, 0.75):
        far = distance_to(correct, drawn["width"], GUESS_RATE, drawn["lambda"])
        low, high = np.quantile(drawn["threshold"] + far, (0.025, 0.975))
        interval = fit.threshold_at(correct).threshold
        assert interval.low == pytest.approx(low, abs=0.08 * (high - low))
        assert interval.high == pytest.approx(high, abs=0.08 * (high - low))


def test_interval_agrees_with_the_profile_of_the_likelihood() -> None:
    # Theory: with 5,000 answers a level the posterior is normal, and its interval is that of the
    # profile likelihood, computed here by scipy alone.
    fit = fitted(5000)
    correct, total = np.array(fit.correct), np.array(fit.total)

    def cost(parameters: NDArray[np.float64], level: float | None = None) -> float:
        width, lapse_rate = parameters[-2:]
        threshold = (
            parameters[0]
            if level is None
            else level - float(distance_to(0.75, width, GUESS_RATE, lapse_rate))
        )
        rate = rate_at(LEVELS, threshold, width, GUESS_RATE, lapse_rate)
        return -float(np.sum(xlogy(correct, rate) + xlog1py(total - correct, -rate)))

    bounds = ((10, 90), (1e-4, 0.2))
    best = optimize.minimize(cost, (35, 40, 0.02), method="L-BFGS-B", bounds=((0, 90), *bounds)).fun

    def excess(level: float) -> float:
        found = optimize.minimize(cost, (40, 0.02), (level,), "L-BFGS-B", bounds=bounds).fun
        return float(found - best - stats.chi2.ppf(0.95, 1) / 2)

    stated = fit.threshold_at(0.75).threshold
    low = optimize.brentq(excess, stated.value - 3, stated.value)
    high = optimize.brentq(excess, stated.value, stated.value + 3)
    assert stated.low == pytest.approx(low, abs=0.15 * (high - low))
    assert stated.high == pytest.approx(high, abs=0.15 * (high - low))


def test_the_mid_point_is_the_level_of_its_own_share(fit: ThresholdFit) -> None:
    at_middle = fit.threshold_at(fit.correct_at_threshold).threshold
    assert at_middle.value == pytest.approx(fit.threshold.value)
    # The share is held fixed, so that an uncertain lapse rate counts: a little wider at most.
    assert at_middle.high - at_middle.low == pytest.approx(
        fit.threshold.high - fit.threshold.low, rel=0.15
    )


def test_a_share_that_is_never_reached_is_infinite(fit: ThresholdFit) -> None:
    stated = fit.threshold_at(0.999)
    assert (stated.reached, stated.threshold.value) == ("above", np.inf)
    assert stated.threshold.high == np.inf


def test_results_name_method_definition_and_share(fit: ThresholdFit) -> None:
    row = fit.threshold_at(0.75).to_frame().iloc[0]
    assert row["correct"] == 0.75
    assert row["definition"] == "level at which a stated share of the answers is right"
    assert row["definition"] != fit.definition
    assert row["method"] == fit.method
    assert "posterior" not in fit.to_frame().columns
    assert "posterior" not in to_json(fit).replace(fit.method, "")


def test_slope_is_the_derivative_of_the_curve(fit: ThresholdFit) -> None:
    # Theory: by central differences.
    step = 1e-4
    ends = fit.rate([fit.threshold.value - step, fit.threshold.value + step])
    assert fit.slope.value == pytest.approx(np.diff(ends).item() / (2 * step), rel=1e-6)
    assert fit.slope.low < fit.slope.value < fit.slope.high
    truth = float(slope_at_threshold(40, GUESS_RATE, 0.02))
    assert fit.slope.low < truth < fit.slope.high


def test_sigmoid_is_that_of_its_definition() -> None:
    # Theory: 5 % and 95 % points a width apart, the mid-point half-way.
    rates = rate_at([20, 35, 50], 35, 30, 0.0, 0.0)
    np.testing.assert_allclose(rates, (0.05, 0.5, 0.95))
    assert pytest.approx(2 * stats.norm.ppf(0.95)) == WIDTH_IN_SIGMAS


NUMBERS = st.floats(-3, 3)


@settings(max_examples=30)
@given(NUMBERS, NUMBERS, st.floats(0.2, 2), st.floats(0.2, 2))
def test_difference_of_normal_distributions(
    first: float, second: float, spread: float, other_spread: float
) -> None:
    # Theory: means subtract, variances add.
    def normal(mean: float, deviation: float) -> Distribution:
        values = np.linspace(mean - 6 * deviation, mean + 6 * deviation, 1000)
        return Distribution(values, stats.norm.cdf(values, mean, deviation))

    low, high = normal(first, spread).minus(normal(second, other_spread)).interval
    deviation = np.hypot(spread, other_spread)
    expected = stats.norm.ppf((0.025, 0.975), first - second, deviation)
    np.testing.assert_allclose((low, high), expected, atol=0.02 * deviation)


def test_difference_with_infinite_parts() -> None:
    # Theory: by counting the four ways in which 10 and 20 % can be infinite.
    values = np.linspace(0, 1, 200)
    upwards = Distribution(values, 0.8 * values)  # 20 % infinite
    both = Distribution(values, 0.1 + 0.9 * values)  # 10 % minus infinite
    found = upwards.minus(both)
    assert 1 - found.cumulative[-1] == pytest.approx(0.2 + 0.8 * 0.1)
    assert found.cumulative[0] == pytest.approx(0.0, abs=1e-9)
    assert found.quantile(0.99) == np.inf
    known = upwards.minus(upwards)
    assert known.cumulative[0] == pytest.approx(0.8 * 0.2 + 0.2 * 0.2 / 2)
    assert 1 - known.cumulative[-1] == pytest.approx(0.2 * 0.8 + 0.2 * 0.2 / 2)


@pytest.mark.parametrize("correct", [0.0, 1 / 8, 1.0, float("nan")])
def test_refuses_impossible_shares(fit: ThresholdFit, correct: float) -> None:
    with pytest.raises(InputError, match=r"correct: .* above the guess rate of 0.125 and below 1"):
        fit.threshold_at(correct)


def test_refuses_a_fit_without_its_posterior(fit: ThresholdFit) -> None:
    with pytest.raises(InputError, match="a fit as `fit_threshold` returns it"):
        replace(fit, posterior=None).threshold_at(0.75)
