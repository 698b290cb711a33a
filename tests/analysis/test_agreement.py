import math
from collections import Counter
from itertools import permutations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from algorithms.errors import InputError
from analysis.paired.agreement import (
    Agreement,
    agreeing_pairs,
    agreement,
    agreement_over,
    agreement_p_value,
    coefficient,
    kendall_chi_square,
    large_sample_chi_square,
    pair_wins,
    smallest_agreement,
)
from analysis.paired.item_permutations import (
    enough_permutations,
    monte_carlo_p_value,
    permuted_pair_wins,
    permuted_scores,
)
from tests.analysis.published_pairs import CELEBRITIES
from tests.analysis.test_consistency import coins

ORDER = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]])


def test_the_school_subjects_of_kendall_and_babington_smith() -> None:
    # Published: Biometrika 31 (1940): 21 boys, 13 subjects and 25 girls, 11 subjects, as in the
    # documentation of kendall.u() in R's package eba. Sigma follows from the u it prints.
    for sigma, observers, items, u, chi_square, freedom, p_value in (
        (9718, 21, 13, 0.1866, 412.22, 90.75, 1.721e-42),
        (8928, 25, 11, 0.08218, 180.12, 62.38, 2.307e-13),
    ):
        pairs = math.comb(items, 2)
        result = kendall_chi_square(sigma, observers, pairs)
        assert coefficient(sigma, observers, pairs) == pytest.approx(u, abs=5e-5)
        assert result.statistic == pytest.approx(chi_square, abs=5e-3)
        assert result.freedom == pytest.approx(freedom, abs=5e-3)
        assert result.p_value == pytest.approx(p_value, rel=1e-2)
    assert smallest_agreement(21) == pytest.approx(-0.04762, abs=5e-6)
    assert smallest_agreement(25) == -0.04


def test_u_is_the_mean_agreement_of_two_observers() -> None:
    # Theory: u is the mean over pairs of observers of 2 (share of equal choices) - 1.
    wins = coins(np.random.default_rng(1), 9, 5)
    first, second = np.triu_indices(5, k=1)
    choices = wins[:, first, second]
    shares = [(choices[a] == choices[b]).mean() for a in range(9) for b in range(9) if a < b]
    assert agreement(wins).u.value == pytest.approx(2 * np.mean(shares) - 1)


@pytest.mark.parametrize(("observers", "items"), [(2, 4), (3, 4), (4, 3), (5, 2), (5, 4)])
def test_exact_distribution_is_that_of_all_pair_counts(observers: int, items: int) -> None:
    # Brute force over the wins of the first of each pair, weighted by how often coins give them.
    pairs = math.comb(items, 2)
    ways: Counter[int] = Counter()
    for counts in product(range(observers + 1), repeat=pairs):
        weight = math.prod(math.comb(observers, won) for won in counts)
        ways[agreeing_pairs(np.array(counts), observers)] += weight
    for sigma in ways:
        tail = sum(number for value, number in ways.items() if value >= sigma)
        p_value, method = agreement_p_value(sigma, observers, pairs)
        assert p_value == pytest.approx(tail / 2 ** (observers * pairs), rel=1e-12)
        assert method == "exact"
        assert (
            p_value
            >= sum(
                number
                for value, number in ways.items()
                if agreement_p_value(value, observers, pairs)[0] <= p_value
            )
            / 2 ** (observers * pairs)
            - 1e-12
        )  # never exceeds its level


def test_exact_tail_keeps_its_digits_far_out() -> None:
    # Theory: only full agreement on every pair reaches the largest Sigma.
    observers, pairs = 20, 10
    p_value, _ = agreement_p_value(math.comb(observers, 2) * pairs, observers, pairs)
    assert p_value == pytest.approx((2 * 0.5**observers) ** pairs, rel=1e-12)


def test_smallest_u_is_reached_by_an_even_split() -> None:
    for observers in (2, 3, 8, 9, 44):
        wins = np.array([ORDER] * (observers // 2) + [ORDER.T] * (observers - observers // 2))
        result = agreement(wins)
        assert result.u.value == pytest.approx(smallest_agreement(observers))
        assert result.minimum == smallest_agreement(observers)
        assert result.p_value == pytest.approx(1)
    assert smallest_agreement(44) == pytest.approx(-1 / 43)


def test_large_sample_chi_square_is_pearsons() -> None:
    # Another implementation: the sum over pairs of (first - second)^2 / n.
    counts = pair_wins(CELEBRITIES)
    result = large_sample_chi_square(agreeing_pairs(counts, 234), 234, 36)
    assert result.statistic == pytest.approx(((2 * counts - 234) ** 2 / 234).sum())
    assert result.freedom == 36


@pytest.mark.parametrize(("observers", "items"), [(15, 4), (44, 3), (50, 6)])
def test_approximations_are_close_to_the_exact_test(observers: int, items: int) -> None:
    pairs = math.comb(items, 2)
    compared = 0
    for sigma in range(0, math.comb(observers, 2) * pairs, 3):
        exact = agreement_p_value(sigma, observers, pairs)[0]
        if 0.005 < exact < 0.1:
            compared += 1
            kendall = kendall_chi_square(sigma, observers, pairs).p_value
            large = large_sample_chi_square(sigma, observers, pairs).p_value
            assert kendall == pytest.approx(exact, abs=0.01)
            assert large == pytest.approx(exact, abs=0.02)
    assert compared > 5


def test_too_large_for_the_exact_test_is_said() -> None:
    wins = coins(np.random.default_rng(1), 1000, 10)
    result = agreement(wins)
    assert result.p_method == "Kendall's chi-square"
    assert result.p_value == result.kendall_p_value


def test_jackknife_is_that_of_leaving_each_observer_out() -> None:
    wins = coins(np.random.default_rng(2), 12, 4)
    wins[:8] = np.triu(np.ones((4, 4), dtype=int), k=1)
    result = agreement(wins)
    without = [agreement(np.delete(wins, one, axis=0)).u.value for one in range(12)]
    pseudo = 12 * result.u.value - 11 * np.array(without)
    reach = stats.t.ppf(0.975, 11) * pseudo.std(ddof=1) / np.sqrt(12)
    assert result.u.low == pytest.approx(result.u.value - reach)
    assert result.u.high == pytest.approx(min(1, result.u.value + reach))


def test_two_observers_have_no_interval_and_no_chi_square() -> None:
    result = agreement([ORDER, ORDER.T])
    assert result.u.value == -1
    assert np.isnan([result.u.low, result.kendall_p_value]).all()


def test_conditions_are_more_pairs() -> None:
    generator = np.random.default_rng(3)
    conditions = [coins(generator, 7, 3) for _ in range(4)]
    result = agreement_over(conditions)
    assert result.u.value == pytest.approx(np.mean([agreement(one).u.value for one in conditions]))
    assert result.p_value == agreement_p_value(result.agreeing, 7, 12)[0]
    assert (result.conditions, result.freedom, result.n) == (4, 12, 7)


def test_permutation_test_is_that_of_all_permutations() -> None:
    # Brute force: the items of three observers shuffled in every way, 6^2 relative to the first.
    wins = np.array([ORDER, ORDER, ORDER[np.ix_([0, 2, 1], [0, 2, 1])]])
    observed = agreement(wins).u.value
    orders = [list(order) for order in permutations(range(3))]
    every = [
        agreement([wins[0], wins[1][np.ix_(b, b)], wins[2][np.ix_(c, c)]]).u.value
        for b in orders
        for c in orders
    ]
    expected = np.mean(np.array(every) >= observed - 1e-12)
    result = agreement(wins, np.random.default_rng(4), permutations=20_000)
    assert result.permutation_p_value == pytest.approx(expected, abs=0.01)
    assert (result.permutations, result.seed) == (20_000, 4)
    assert np.isnan(agreement(wins).permutation_p_value)


def test_permutations_shuffle_conditions_alike() -> None:
    # Theory: one observer with the same order in two conditions wins the same pairs in both.
    one = np.array([[ORDER], [ORDER], [ORDER.T]])
    drawn = np.concatenate(list(permuted_pair_wins(one, np.random.default_rng(5), 300)))
    assert drawn.shape == (300, 3, 3)
    np.testing.assert_array_equal(drawn[:, 0], drawn[:, 1])
    np.testing.assert_array_equal(drawn[:, 0], 1 - drawn[:, 2])
    assert len({shuffle.tobytes() for shuffle in drawn[:, 0]}) == 6  # every order occurs


def test_permutations_keep_an_observers_tournaments_together() -> None:
    wins = np.array([ORDER, ORDER, ORDER.T])
    drawn = np.concatenate(
        list(permuted_scores(wins, np.random.default_rng(5), 300, ["p", "p", "q"]))
    )
    assert (drawn.sum(axis=1) == 9).all()
    # Twice an order and once another: 4, 2, 0 with 2, 1, 0 in any arrangement.
    expected = {tuple(np.add((4, 2, 0), other)) for other in permutations((2, 1, 0))}
    assert {tuple(sorted(one, reverse=True)) for one in drawn.tolist()} == {
        tuple(sorted(one, reverse=True)) for one in expected
    }


def test_monte_carlo_p_value_is_never_zero() -> None:
    assert monte_carlo_p_value(0, 99) == 0.01


def test_very_many_answers_are_shuffled_less_often() -> None:
    assert enough_permutations(np.zeros((44, 6, 6), dtype=np.int64)) == 10_000
    assert enough_permutations(np.zeros((20_000, 10, 10), dtype=np.int8)) == 999


@given(st.integers(2, 12), st.integers(2, 5), st.integers(0, 2**32 - 1))
def test_u_is_within_its_bounds_whatever_the_names(observers: int, items: int, seed: int) -> None:
    generator = np.random.default_rng(seed)
    wins = coins(generator, observers, items)
    result: Agreement = agreement(wins)
    assert result.minimum - 1e-12 <= result.u.value <= 1
    assert 0 < result.p_value <= 1
    order = generator.permutation(items)
    assert agreement(wins[:, order][:, :, order]).agreeing == result.agreeing


def test_table_is_one_row() -> None:
    frame = agreement([ORDER] * 4).to_frame()
    assert frame[["u", "minimum", "n", "items"]].to_numpy().tolist() == [[1, -1 / 3, 4, 3]]


def test_refuses() -> None:
    with pytest.raises(InputError, match="wins: one observer given, agreement needs two or more"):
        agreement(ORDER)
    with pytest.raises(InputError, match=r"conditions: shapes \[\(2, 3, 3\), \(3, 3, 3\)\] given"):
        agreement_over([[ORDER] * 2, [ORDER] * 3])
    with pytest.raises(InputError, match=r"conditions: shapes \[\] given"):
        agreement_over([])
    with pytest.raises(InputError, match="permutations: 0 given, 1 or more accepted"):
        agreement([ORDER] * 2, np.random.default_rng(1), permutations=0)
    with pytest.raises(InputError, match="observers: 1 given, one for each of 2 tournaments"):
        list(permuted_scores(np.array([ORDER] * 2), np.random.default_rng(1), 1, ["p"]))
