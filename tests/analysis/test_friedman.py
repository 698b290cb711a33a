import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from analysis.bootstrap import Matrix
from analysis.ranking.friedman import concordance, exact_p_value, friedman
from tests.analysis.rankings import DIURETICS, RUNNERS


def rankings(participants: int, items: int, seed: int) -> Matrix:
    generator = np.random.default_rng(seed)
    return np.array([generator.permutation(items) + 1.0 for _ in range(participants)])


def test_published_examples() -> None:
    # Hollander and Wolfe 1973, p. 140 (ties) and Sachs 1997, p. 675, as R's friedman.test has them.
    runners = friedman(RUNNERS, ties=True)
    assert runners.chi_square == pytest.approx(11.143, abs=5e-4)
    assert runners.p_chi_square == pytest.approx(0.003805, abs=5e-7)
    diuretics = friedman(DIURETICS, exact=False)
    assert diuretics.chi_square == pytest.approx(23.333, abs=5e-4)
    assert diuretics.degrees_of_freedom == 5


@pytest.mark.parametrize(
    ("participants", "items", "five_percent", "one_percent"),
    [
        (4, 3, 6.500, 8.000),
        (5, 3, 6.400, 8.400),
        (6, 3, 7.000, 9.000),
        (7, 3, 7.143, 8.857),
        (8, 3, 6.250, 9.000),
        (9, 3, 6.222, 9.556),
        (10, 3, 6.200, 9.600),
        (13, 3, 6.615, 9.385),
        (3, 4, 7.400, 9.000),
        (4, 4, 7.800, 9.600),
        (5, 4, 7.800, 9.960),
        (3, 5, 8.533, 10.133),
    ],
)
def test_exact_distribution_gives_the_published_critical_values(
    participants: int, items: int, five_percent: float, one_percent: float
) -> None:
    # Tables since Friedman 1937: the smallest statistic whose probability is at most alpha.
    generator = np.random.default_rng(1)
    identity = np.tile(np.arange(1.0, items + 1), (20_000, participants, 1))
    everything = generator.permuted(identity, axis=2)
    w, first = np.unique(concordance(everything).round(9), return_index=True)
    p_values = [exact_p_value(everything[place]) for place in first]
    for alpha, critical in ((0.05, five_percent), (0.01, one_percent)):
        smallest = min(
            one for one, p in zip(w, p_values, strict=True) if p is not None and p <= alpha
        )
        assert participants * (items - 1) * smallest == pytest.approx(critical, abs=2e-3)


@pytest.mark.parametrize("tied", [False, True])
def test_exact_p_value_equals_enumeration(tied: bool) -> None:
    # Brute force over all orders of every participant's ranks.
    ranks = rankings(4, 3, 5)
    if tied:
        ranks[0], ranks[2] = [1.5, 1.5, 3], [1, 2.5, 2.5]
    orders = [list(itertools.permutations(row)) for row in ranks]
    everything = np.array(list(itertools.product(*orders)))
    at_least = concordance(everything) >= concordance(ranks) - 1e-12
    assert exact_p_value(ranks) == pytest.approx(at_least.mean(), abs=1e-12)


def test_exact_test_keeps_its_size_and_large_samples_agree() -> None:
    # Theory: P(p <= alpha) <= alpha under the null, here over all 6**4 outcomes.
    orders = list(itertools.permutations([1.0, 2.0, 3.0]))
    everything = np.array(list(itertools.product(orders, repeat=4)))
    p_of: dict[float, float | None] = {}
    for ranks in everything:
        p_of.setdefault(round(float(concordance(ranks)), 9), exact_p_value(ranks))
    p_values = np.array([p_of[round(float(w), 9)] for w in concordance(everything)])
    for alpha in (0.01, 0.05, 0.1, 0.5):
        assert (p_values <= alpha).mean() <= alpha
    many = friedman(rankings(100, 3, 1))
    assert many.p_exact == pytest.approx(many.p_chi_square, abs=0.005)


@given(st.integers(2, 12), st.integers(2, 6), st.integers(0, 2**32 - 1), st.booleans())
def test_agrees_with_scipy(participants: int, items: int, seed: int, tied: bool) -> None:
    # Another implementation; it wants three items or more.
    ranks = rankings(participants, items, seed)
    if tied:
        ranks = np.asarray(stats.rankdata(np.minimum(ranks, items - 1), axis=1), dtype=float)
        if items == 2:  # all tied
            return
    found = friedman(ranks, ties=True, exact=False)
    assert found.chi_square == pytest.approx(participants * (items - 1) * found.w)
    if items > 2:
        expected = stats.friedmanchisquare(*ranks.T)
        assert found.chi_square == pytest.approx(expected.statistic)
        assert found.p_chi_square == pytest.approx(expected.pvalue)


@given(st.integers(2, 8), st.integers(3, 6), st.integers(0, 2**32 - 1))
def test_mean_spearman_is_that_of_all_pairs(participants: int, items: int, seed: int) -> None:
    # Theory (Kendall and Gibbons 1990, sec. 6.7), for rankings without ties.
    ranks = rankings(participants, items, seed)
    correlation = np.asarray(np.corrcoef(ranks))[np.triu_indices(participants, 1)].mean()
    found = friedman(ranks, exact=False)
    assert found.mean_spearman == pytest.approx(correlation, abs=1e-9)


def test_all_rankings_alike() -> None:
    found = friedman(np.tile([2, 1, 3, 4], (5, 1)))
    assert found.w == pytest.approx(1)
    assert found.f == np.inf
    assert found.p_exact == pytest.approx(24 ** (1 - 5), rel=1e-9)
    assert found.method == "Friedman's test, exact"


def test_gives_up_the_exact_p_value_where_it_would_take_long() -> None:
    for ranks in (rankings(60, 6, 1), rankings(5, 9, 1)):
        found = friedman(ranks)
        assert found.p_exact is None
        assert found.p_value == found.p_chi_square
        assert found.method == "Friedman's test, chi-square"
