import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.stats.weightstats import DescrStatsW

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import to_json
from analysis.ranking.friedman import friedman
from analysis.ranking.mean_ranks import normal_fit, rank_summary
from analysis.ranking.ranks import check_ranks
from benchmarks.ranking import (
    LOG_WORTHS,
    covered_mean_ranks,
    draw_rankings,
    falsely_split,
    mean_ranks,
    rejected,
)
from tests.analysis.rankings import RUNNERS


@pytest.fixture(scope="module")
def ranks() -> Matrix:
    return np.asarray(draw_rankings(LOG_WORTHS, 44, 1, np.random.default_rng(1))[0])


def test_table_is_in_order_of_mean_rank_with_intervals_around_it(ranks: Matrix) -> None:
    generator = np.random.default_rng(2)
    summary = rank_summary(ranks, items=list("abcde"), generator=generator)
    table = summary.to_frame()
    assert table["mean"].is_monotonic_increasing
    assert dict(zip(table["item"], table["mean"], strict=True)) == dict(
        zip("abcde", ranks.mean(axis=0), strict=True)
    )
    for kind in ("", "_t", "_bootstrap"):
        assert (table[f"low{kind}"] < table["mean"]).all()
        assert (table["mean"] < table[f"high{kind}"]).all()
    assert (table["low"] > 1).all()
    assert (table["high"] < 5).all()
    assert (summary.seed, summary.resamples, summary.participants) == (2, 2000, 44)


def test_normal_fit_is_that_of_other_implementations(ranks: Matrix) -> None:
    # statsmodels for the t interval; scipy's chi-square as used for a variance in any textbook.
    fit = normal_fit(ranks)
    low, high = DescrStatsW(ranks).tconfint_mean()
    np.testing.assert_allclose(fit["low_t"], low)
    np.testing.assert_allclose(fit["high_t"], high)
    variance = ranks.var(axis=0, ddof=1)
    np.testing.assert_allclose(fit["standard_deviation"] ** 2, variance)
    lower = 43 * variance / stats.chi2(43).ppf(0.975)
    np.testing.assert_allclose(fit["low_standard_deviation"] ** 2, lower)


def test_carries_the_tests_of_friedman_and_pairs() -> None:
    summary = rank_summary(RUNNERS, ties=True)
    assert summary.tied
    assert summary.concordance == friedman(RUNNERS, ties=True)
    # Hollander and Wolfe 1973, p. 151: the wide angle differs from rounding out, not (at .05) from
    # the narrow angle.
    assert summary.comparisons.groups == (("3", "2"), ("2", "1"))
    assert "low_bootstrap" not in summary.table


def test_json_has_no_nan_where_all_rankings_are_alike() -> None:
    summary = rank_summary(np.tile([1, 2, 3], (4, 1)), generator=np.random.default_rng(1))
    assert "NaN" not in to_json(summary)
    assert summary.table["low"].iloc[1] < 2 < summary.table["high"].iloc[1]


def test_same_generator_same_table(ranks: Matrix) -> None:
    first, second = (rank_summary(ranks, generator=np.random.default_rng(3)) for _ in range(2))
    pd.testing.assert_frame_equal(first.table, second.table)


def test_mean_rank_of_an_item_is_one_plus_those_ahead() -> None:
    # Theory: what the benchmark takes for the truth.
    ranks = draw_rankings(LOG_WORTHS, 200_000, 1, np.random.default_rng(1))[0]
    np.testing.assert_allclose(ranks.mean(axis=0), mean_ranks(LOG_WORTHS), atol=0.01)
    assert mean_ranks(LOG_WORTHS).sum() == pytest.approx(15)


@pytest.mark.parametrize(("participants", "items"), [(30, 5), (44, 3)])
def test_friedman_rejects_at_the_nominal_rate(participants: int, items: int) -> None:
    # Calibration: 2,000 repetitions, binomial error 0.0049; three of them.
    rates = rejected(participants, items, 2000, np.random.default_rng(4))
    assert rates["chi_square"] == pytest.approx(0.05, abs=0.015)
    assert rates["f"] == pytest.approx(0.05, abs=0.015)
    assert rates.get("exact", 0) < 0.05 + 0.015


def test_pairs_keep_the_rate_of_the_family() -> None:
    # Calibration: 400 repetitions, binomial error 0.011.
    rates = falsely_split(30, 5, 400, np.random.default_rng(5))
    assert rates["nemenyi"] < 0.05 + 3 * 0.011
    assert rates["conover"] < 0.05 + 3 * 0.011


def test_intervals_hold_the_mean_rank() -> None:
    # Recovery: 1,000 repetitions of 30 participants, binomial error 0.007.
    covered = covered_mean_ranks(30, 1000, np.random.default_rng(6), resamples=1)
    assert all(0.93 <= rate <= 0.97 for rate in covered["wilson_type"])
    # The last item is nearly always last: there t is too narrow, which is why it is not used.
    assert covered["t"][-1] < 0.93


def test_refuses() -> None:
    with pytest.raises(InputError, match="ranks: row 1 has tied ranks"):
        rank_summary([[1, 2], [1, 1]])
    with pytest.raises(InputError, match="resamples: 0 given, 1 or more accepted"):
        rank_summary([[1, 2], [2, 1]], generator=np.random.default_rng(1), resamples=0)
    with pytest.raises(InputError, match="alpha: 0 given"):
        rank_summary([[1, 2], [2, 1]], alpha=0)


def test_two_items_are_the_sign_test() -> None:
    # Theory: Friedman's exact test of two items is the two-sided sign test.
    ranks = check_ranks([[1, 2]] * 9 + [[2, 1]] * 2).ranks
    assert friedman(ranks).p_exact == pytest.approx(stats.binomtest(9, 11).pvalue)
