import numpy as np
import psignifit
import pytest
from numpy.typing import NDArray
from scipy import optimize, stats
from scipy.special import ndtr, ndtri, xlog1py, xlogy

from algorithms.errors import InputError
from analysis.thresholds.bayesian_fit import fit_threshold
from analysis.thresholds.likelihood_climb import LAPSE_POWER, Problem
from analysis.thresholds.maximum_likelihood import maximum_likelihood
from analysis.thresholds.sigmoid import rate_at

LEVELS = np.arange(10.0, 91.0, 10.0)
GUESS_RATE = 1 / 8


def drawn(data_sets: int, answers: int, seed: int) -> NDArray[np.int64]:
    """Right answers to functions of all kinds."""
    generator = np.random.default_rng(seed)
    threshold, width, lapse_rate = generator.uniform(
        (15, 10, 0), (80, 60, 0.1), size=(data_sets, 3)
    ).T[:, :, None]
    return generator.binomial(answers, rate_at(LEVELS, threshold, width, GUESS_RATE, lapse_rate))


def cost(parameters: NDArray[np.float64], correct: NDArray[np.int64], answers: int) -> float:
    """The penalised likelihood once more."""
    threshold, width, lapse_rate = parameters
    scaled = (LEVELS - threshold) * 2 * ndtri(0.95) / width
    rate = GUESS_RATE + (1 - GUESS_RATE - lapse_rate) * ndtr(scaled)
    likelihood = xlogy(correct, rate) + xlog1py(answers - correct, -rate)
    return -float(np.sum(likelihood)) - 9 * float(np.log1p(-lapse_rate))


@pytest.mark.parametrize("answers", [6, 40])
def test_no_maximum_of_scipy_is_higher(answers: int) -> None:
    # Another implementation: scipy's optimiser from the maximum and from three other points.
    correct = drawn(8, answers, seed=answers)
    fits = maximum_likelihood(LEVELS, correct, np.full(correct.shape, answers), GUESS_RATE)
    assert fits.converged.all()
    bounds = ((-30, 130), (10, 240), (1e-7, 0.5))
    for row in range(len(correct)):
        if not np.isfinite(fits.threshold[row]):
            continue
        found = (fits.threshold[row], fits.width[row], fits.lapse_rate[row])
        others = [
            optimize.minimize(cost, start, (correct[row], answers), "L-BFGS-B", bounds=bounds).fun
            for start in (found, (50, 30, 0.05), (25, 50, 0.02), (75, 15, 0.1))
        ]
        assert cost(np.array(found), correct[row], answers) <= min(others) + 1e-4


def test_agrees_with_psignifits_mode_without_overdispersion() -> None:
    # Another implementation: with eta 0 psignifit's posterior is this likelihood where its priors
    # of threshold and width are flat.
    correct = np.array([8, 9, 30, 52, 57, 58, 60, 59, 60])
    fits = maximum_likelihood(LEVELS, correct[None], np.full((1, 9), 60), GUESS_RATE)
    result = psignifit.psignifit(
        np.column_stack([LEVELS, correct, np.full(9, 60)]).astype(float),
        sigmoid="norm",
        experiment_type="yes/no",
        fixed_parameters={"eta": 1e-8, "gamma": GUESS_RATE},
        verbose=False,
    )
    mode = result.parameter_estimate_MAP
    assert fits.threshold[0] == pytest.approx(mode["threshold"], abs=0.02)
    assert fits.width[0] == pytest.approx(mode["width"], abs=0.1)
    assert fits.lapse_rate[0] == pytest.approx(mode["lambda"], abs=1e-3)


def test_recovers_the_function() -> None:
    # Recovery, and theory: standard errors of the mean of 500 data sets.
    truth = rate_at(LEVELS, 25, 30, GUESS_RATE, 0.02)
    correct = np.random.default_rng(1).binomial(400, truth, size=(500, 9))
    fits = maximum_likelihood(LEVELS, correct, np.full(correct.shape, 400), GUESS_RATE)
    for found, expected in ((fits.threshold, 25), (fits.width, 30), (fits.lapse_rate, 0.02)):
        assert found.mean() == pytest.approx(expected, abs=4 * found.std() / np.sqrt(500))


def test_finds_the_higher_of_two_maxima() -> None:
    # Property: answers that are never better than half right have two maxima, at a high lapse rate
    # and at a threshold far up; resamples of them must not end at the lower one.
    correct = np.array([10, 23, 27, 37, 32, 43, 46, 39, 34])
    redrawn = np.random.default_rng(2).binomial(80, correct / 80, size=(100, 9))
    fits = maximum_likelihood(
        LEVELS, np.vstack([correct, redrawn]), np.full((101, 9), 80), GUESS_RATE
    )
    assert fits.threshold[0] == pytest.approx(26.9, abs=0.1)
    assert fits.lapse_rate[0] == pytest.approx(0.494, abs=0.01)
    assert np.mean(fits.threshold < 45) > 0.8


def test_slope_and_information_are_those_of_finite_differences() -> None:
    # Derivatives: central differences; the expected information is that of the mean answers.
    parameters = np.array([[0.2, -1.0, 0.03], [0.6, -0.4, 0.1]])
    problem = Problem((LEVELS - 10) / 80, np.zeros((2, 9)), np.full((2, 9), 50.0), GUESS_RATE)
    expected = 50 * problem.rate(parameters)[0]
    problem = Problem(problem.levels, expected, problem.total, GUESS_RATE)
    _, slope, information = problem.evaluate(parameters)
    for k in range(3):
        step = 1e-5 * np.eye(3)[k]
        higher, lower = problem.evaluate(parameters + step), problem.evaluate(parameters - step)
        np.testing.assert_allclose((higher[0] - lower[0]) / 2e-5, slope[:, k], atol=1e-5)
        np.testing.assert_allclose(
            -(higher[1] - lower[1]) / 2e-5, information[:, :, k], rtol=1e-4, atol=1e-2
        )


def test_penalty_is_that_of_psignifits_prior() -> None:
    assert stats.beta(1, LAPSE_POWER + 1).pdf(0.2) / stats.beta(1, LAPSE_POWER + 1).pdf(
        0.0
    ) == pytest.approx(0.8**LAPSE_POWER)


def test_a_row_is_fitted_alike_alone_and_among_others() -> None:
    correct = drawn(50, 20, 3)
    total = np.full(correct.shape, 20)
    together = maximum_likelihood(LEVELS, correct, total, GUESS_RATE)
    for row in (0, 17, 49):
        alone = maximum_likelihood(LEVELS, correct[[row]], total[[row]], GUESS_RATE)
        assert alone.threshold[0] == pytest.approx(together.threshold[row], rel=1e-6)


def test_beyond_the_levels_is_infinite() -> None:
    correct = np.array([[1] * 9, [8] * 9, [0, 0, 1, 0, 2, 4, 7, 8, 8]])
    fits = maximum_likelihood(LEVELS, correct, np.full(correct.shape, 8), GUESS_RATE)
    assert fits.threshold[0] == np.inf
    assert fits.threshold[1] == -np.inf
    assert 50 < fits.threshold[2] < 70
    np.testing.assert_array_equal(fits.thresholds_at(0.9)[:2], (np.inf, -np.inf))


def test_stated_share_is_that_of_the_function() -> None:
    correct = drawn(20, 200, 4)
    fits = maximum_likelihood(LEVELS, correct, np.full(correct.shape, 200), GUESS_RATE)
    at = fits.thresholds_at(0.6)
    inside = np.isfinite(at) & np.isfinite(fits.threshold)
    assert inside.sum() > 10
    rates = rate_at(
        at[inside], fits.threshold[inside], fits.width[inside], GUESS_RATE, fits.lapse_rate[inside]
    )
    np.testing.assert_allclose(rates, 0.6)


def test_agrees_with_the_bayesian_fit_where_answers_are_many() -> None:
    correct = drawn(3, 3000, 5)
    fits = maximum_likelihood(LEVELS, correct, np.full(correct.shape, 3000), GUESS_RATE)
    for row in range(3):
        bayesian = fit_threshold(LEVELS, correct[row], [3000] * 9, GUESS_RATE)
        spread = bayesian.threshold.high - bayesian.threshold.low
        assert fits.threshold[row] == pytest.approx(bayesian.threshold.value, abs=0.15 * spread)


def test_refuses() -> None:
    correct, total = np.ones((2, 9)), np.full((2, 9), 4)
    with pytest.raises(InputError, match=r"levels: two or more different ones in rising order"):
        maximum_likelihood(LEVELS[::-1], correct, total, GUESS_RATE)
    with pytest.raises(InputError, match=r"correct, total: shapes \(2, 8\) and \(2, 9\) given"):
        maximum_likelihood(LEVELS, correct[:, :8], total, GUESS_RATE)
    with pytest.raises(InputError, match="correct: more right answers than answers"):
        maximum_likelihood(LEVELS, correct + 4, total, GUESS_RATE)
    with pytest.raises(InputError, match="correct: NaN or infinite"):
        maximum_likelihood(LEVELS, correct * np.nan, total, GUESS_RATE)
    with pytest.raises(InputError, match=r"correct: shape \(9,\) given, \(n, levels\) accepted"):
        maximum_likelihood(LEVELS, correct[0], total, GUESS_RATE)
