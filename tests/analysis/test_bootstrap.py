import numpy as np
import pandas as pd
import pytest
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import (
    EXACT,
    EXACT_OVER_PARTICIPANTS,
    bootstrap_means,
    expanded_p_value,
    expanded_percentiles,
    rate_intervals,
    sum_by_participant,
)


def test_interval_is_binomial_for_independent_answers() -> None:
    # Theory: for independent answers the interval is +-1.96 sqrt(p (1 - p) / n).
    generator = np.random.default_rng(1)
    counts = np.full((400, 3), 6.0)
    totals = generator.binomial(6, (0.2, 0.5, 0.9), size=(400, 3)).astype(float)
    low, high = bootstrap_means(totals, counts, generator, resamples=20_000)
    p = totals.sum(axis=0) / counts.sum(axis=0)
    expected = stats.norm.ppf(0.975) * np.sqrt(p * (1 - p) / (400 * 6))
    np.testing.assert_allclose((high - low) / 2, expected, rtol=0.1)


def test_interval_widens_where_participants_differ() -> None:
    # Theory: all answers of a participant alike, so that only participants count.
    generator = np.random.default_rng(2)
    counts = np.full((200, 1), 9.0)
    totals = 9 * generator.binomial(1, 0.5, size=(200, 1)).astype(float)
    low, high = bootstrap_means(totals, counts, generator, resamples=20_000)
    p = totals.mean() / 9
    expected = stats.norm.ppf(0.975) * np.sqrt(p * (1 - p) / 200)
    np.testing.assert_allclose((high - low) / 2, expected, rtol=0.1)


def test_same_generator_same_interval() -> None:
    totals, counts = np.arange(12.0).reshape(6, 2), np.full((6, 2), 20.0)
    first, second = (bootstrap_means(totals, counts, np.random.default_rng(3)) for _ in range(2))
    np.testing.assert_array_equal(first, second)


def test_sums_follow_participants_and_leave_out_missing_values() -> None:
    table = pd.DataFrame(
        {
            "participant": ["a", "a", "b", "b", "b"],
            "level": [10, 20, 10, 10, 20],
            "correct": pd.array([True, False, True, None, True], dtype="boolean"),
        }
    )
    sums = sum_by_participant(table, "correct", ["level"])
    assert sums.cells["level"].tolist() == [10, 20]
    np.testing.assert_array_equal(sums.totals, [[1, 0], [1, 1]])
    np.testing.assert_array_equal(sums.counts, [[1, 1], [1, 1]])
    np.testing.assert_array_equal(sums.means, [1, 0.5])


@pytest.mark.parametrize("right", [False, True])
def test_answers_all_alike_have_the_exact_interval_over_participants(*, right: bool) -> None:
    # Published method: for 0 of m, Clopper and Pearson's upper end is 1 - 0.025 ** (1 / m). Answers
    # of one participant are no independent evidence, so m is 3 here and not 12.
    table = pd.DataFrame({"participant": list("abc") * 4, "cell": 1, "correct": right})
    sums = sum_by_participant(table, "correct", ["cell"])
    low, high, methods = rate_intervals(sums, np.random.default_rng(1))
    reach = 1 - 0.025 ** (1 / 3)
    np.testing.assert_allclose((low[0], high[0]), (1 - reach, 1) if right else (0, reach))
    assert methods == [EXACT_OVER_PARTICIPANTS]


@pytest.mark.parametrize("right", [0, 3, 12])
def test_one_answer_a_participant_has_the_exact_interval(right: int) -> None:
    # Another implementation: scipy's, over answers that are independent.
    table = pd.DataFrame(
        {"participant": range(12), "cell": 1, "correct": [k < right for k in range(12)]}
    )
    low, high, methods = rate_intervals(
        sum_by_participant(table, "correct", ["cell"]), np.random.default_rng(1)
    )
    expected = stats.binomtest(right, 12).proportion_ci(0.95)
    assert (low[0], high[0]) == (expected.low, expected.high)
    assert methods == [EXACT]


def test_expanded_interval_has_the_length_of_t() -> None:
    # Theory (Hesterberg 2015): of a mean it is the t interval, as long as resamples are normal.
    generator = np.random.default_rng(3)
    values = generator.normal(size=(12, 1))
    low, high = bootstrap_means(values, np.ones((12, 1)), generator, resamples=200_000)
    reach = stats.t.ppf(0.975, 11) * values.std(ddof=1) / np.sqrt(12)
    assert high[0] - low[0] == pytest.approx(2 * reach, rel=0.03)


@pytest.mark.parametrize("participants", [4, 12, 300])
def test_expanded_p_value_agrees_with_the_interval(participants: int) -> None:
    # Property: at the interval's own tail the p-value is 5 %; a resample in the middle gives 1.
    tail = expanded_percentiles(participants)[0] / 100
    assert expanded_p_value(tail, participants) == pytest.approx(0.05)
    assert expanded_p_value(0.5, participants) == pytest.approx(1)
    assert expanded_percentiles(10**6) == pytest.approx((2.5, 97.5), abs=1e-3)


def test_refuses() -> None:
    with pytest.raises(InputError, match=r"shapes \(2, 3\) and \(2, 2\) given"):
        bootstrap_means(np.ones((2, 3)), np.ones((2, 2)), np.random.default_rng(1))
    with pytest.raises(InputError, match="resamples: 0 given, 1 or more"):
        bootstrap_means(np.ones((2, 3)), np.ones((2, 3)), np.random.default_rng(1), resamples=0)
