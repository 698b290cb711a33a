import math
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.errors import InputError
from analysis.paired.consistency import (
    chance_zeta,
    circular_triads,
    consistency,
    exact_is_feasible,
    group_consistency,
    most_circular_triads,
    triad_counts,
    triads_chi_square,
    triads_p_value,
)
from tests.analysis.published_pairs import DOG

CIRCLE = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]
ORDER = [[0, 1, 1], [0, 0, 1], [0, 0, 0]]


def every_tournament(items: int) -> np.ndarray:
    """Return all tournaments, shape (2^pairs, t, t)."""
    first, second = np.triu_indices(items, k=1)
    won = np.array(list(product((0, 1), repeat=first.size)))
    wins = np.zeros((len(won), items, items), dtype=np.int64)
    wins[:, first, second], wins[:, second, first] = won, 1 - won
    return wins


def coins(generator: np.random.Generator, number: int, items: int) -> np.ndarray:
    first, second = np.triu_indices(items, k=1)
    wins = np.zeros((number, items, items), dtype=np.int64)
    wins[:, first, second] = generator.integers(0, 2, size=(number, first.size))
    wins[:, second, first] = 1 - wins[:, first, second]
    return wins


def test_the_dog_of_kendall_and_babington_smith() -> None:
    # Published: the matrix on p. 326 of Biometrika 31; five triads of at most eight, and from
    # their table of all 2^15 tournaments P(d <= 5) = 16688 / 32768.
    result = consistency(DOG)
    assert (result.triads, result.most_triads, result.zeta) == (5, 8, 0.375)
    assert result.p_value == pytest.approx(16688 / 32768, abs=1e-12)
    assert result.method == "Kendall's zeta; p exact, by enumeration"


def test_counts_of_triads_are_the_published_ones() -> None:
    # Published: Kendall and Babington Smith 1940 (t = 7), Alway 1962 (t = 8 to 10; as in
    # dcircular() of R's package eba).
    assert triad_counts(7) == (
        *(5040, 8400, 21840, 33600, 75600, 90384, 179760, 188160, 277200, 280560),
        *(384048, 244160, 233520, 72240, 2640),
    )
    eight, nine, ten = (triad_counts(items) for items in (8, 9, 10))
    assert (eight[0], eight[10], eight[16], eight[20]) == (40320, 15821568, 37188480, 3230080)
    assert (nine[0], nine[22], nine[30]) == (362880, 7730384256, 3230080)
    assert (ten[1], ten[20], ten[32]) == (9676800, 417512148480, 3166378709760)
    assert ten[-1] == 48251508480


@pytest.mark.parametrize("items", [3, 4, 5, 6])
def test_counts_of_triads_are_those_of_all_tournaments(items: int) -> None:
    # Brute force, triads counted one by one.
    wins = every_tournament(items)
    by_hand = np.zeros(len(wins), dtype=int)
    for a, b, c in combinations(range(items), 3):
        by_hand += wins[:, a, b] & wins[:, b, c] & wins[:, c, a]
        by_hand += wins[:, b, a] & wins[:, c, b] & wins[:, a, c]
    np.testing.assert_array_equal(circular_triads(wins), by_hand)
    assert np.bincount(by_hand).tolist() == list(triad_counts(items))
    assert by_hand.max() == most_circular_triads(items)


@pytest.mark.parametrize("items", range(3, 11))
def test_exact_distribution_is_of_all_tournaments_with_a_quarter_circular(items: int) -> None:
    counts = triad_counts(items)
    assert sum(counts) == 2 ** math.comb(items, 2)
    mean = sum(d * number for d, number in enumerate(counts)) / sum(counts)
    assert mean == pytest.approx(math.comb(items, 3) / 4)
    assert 1 - mean / most_circular_triads(items) == pytest.approx(chance_zeta(items))


def test_chance_is_not_zero() -> None:
    # Published: method notes on Lopez-Moreno 2011, table 7.2: coins have 0.75 with three items.
    assert chance_zeta(3) == 0.75
    assert chance_zeta(6) == pytest.approx(0.375)


def test_zeta_by_the_formulas_for_odd_and_even_numbers() -> None:
    # Theory: 1 - 24 d / (t^3 - t) and 1 - 24 d / (t^3 - 4 t).
    for items, denominator in ((3, 24), (4, 48), (5, 120), (6, 192), (7, 336)):
        wins = coins(np.random.default_rng(items), 1, items)[0]
        result = consistency(wins)
        assert result.zeta == pytest.approx(1 - 24 * result.triads / denominator)


@pytest.mark.parametrize("items", [3, 4, 5, 6])
def test_exact_test_never_exceeds_its_level(items: int) -> None:
    # Enumeration: P(p <= alpha) <= alpha for every alpha that p can have.
    probability = np.array(triad_counts(items)) / 2.0 ** math.comb(items, 2)
    p_values = np.array([triads_p_value(d, items) for d in range(len(probability))])
    for alpha in p_values:
        assert probability[p_values <= alpha].sum() <= alpha + 1e-12


def test_chi_square_is_close_to_the_exact_distribution() -> None:
    # Theory: the largest number of items for which the exact one is used.
    exact = np.cumsum(triad_counts(10)) / 2.0**45
    approximate = np.array([triads_chi_square(d, 10) for d in range(exact.size)])
    assert np.abs(exact - approximate).max() < 0.011
    usual = (exact > 0.005) & (exact < 0.1)
    assert np.abs(approximate[usual] / exact[usual] - 1).max() < 0.16


def test_sum_over_observers_is_a_convolution() -> None:
    # Brute force: all pairs of tournaments of four items.
    triads = circular_triads(every_tournament(4))
    pairs = (triads[:, None] + triads).ravel()
    for total in range(5):
        assert triads_p_value(total, 4, 2) == pytest.approx((pairs <= total).mean())


def test_sum_over_observers_of_many_items_is_close_to_simulated_coins() -> None:
    # Simulation, standard error 0.005.
    drawn = circular_triads(coins(np.random.default_rng(1), 40_000, 12)).reshape(-1, 5).sum(axis=1)
    for quantile in (0.05, 0.3):
        total = int(np.quantile(drawn, quantile))
        assert triads_p_value(total, 12, 5) == pytest.approx((drawn <= total).mean(), abs=0.015)


def test_very_many_observers_are_summed_by_chi_square() -> None:
    assert exact_is_feasible(10, 200)
    assert not exact_is_feasible(10, 300)
    assert not exact_is_feasible(11)
    assert exact_is_feasible(3, 10_000)
    for total in (5800, 5900, 6000):
        exact = triads_p_value(total, 10, 200)
        assert triads_chi_square(total, 10, 200) == pytest.approx(exact, abs=0.003)


@given(st.integers(3, 8), st.integers(0, 2**32 - 1))
def test_names_of_items_do_not_matter(items: int, seed: int) -> None:
    generator = np.random.default_rng(seed)
    wins = coins(generator, 1, items)[0]
    order = generator.permutation(items)
    assert consistency(wins[np.ix_(order, order)]).triads == consistency(wins).triads
    assert consistency(wins.T).triads == consistency(wins).triads


def test_an_order_has_no_circle() -> None:
    wins = np.triu(np.ones((12, 12), dtype=int), k=1)
    result = consistency(wins)
    assert (result.triads, result.zeta) == (0, 1.0)
    assert result.p_value < 1e-6
    assert result.method == "Kendall's zeta; p by Kendall's chi-square"


def test_group_counts_each_participant_once() -> None:
    wins = [ORDER, ORDER, CIRCLE, ORDER]
    result = group_consistency(wins, ["p", "p", "q", "q"])
    assert (result.n, result.tournaments) == (2, 4)
    assert result.table["zeta"].tolist() == [1, 1, 0, 1]
    assert result.mean_zeta.value == 0.75
    assert (result.mean_zeta.low, result.mean_zeta.high) == (0, 1)  # two people say little
    assert result.p_value == pytest.approx(1 - 1 / 4**4 * (1 + 4 * 3 + 6 * 9))
    assert result.to_frame()["participant"].tolist() == ["p", "p", "q", "q"]


def test_group_interval_is_students_over_observers() -> None:
    result = group_consistency([ORDER] * 15 + [CIRCLE] * 5)
    error = np.std([1] * 15 + [0] * 5, ddof=1) / np.sqrt(20)
    assert result.mean_zeta.low == pytest.approx(0.75 - 2.093024 * error)
    assert np.isnan(group_consistency([ORDER] * 3).mean_zeta.low)  # all alike


def test_refuses() -> None:
    with pytest.raises(InputError, match=r"one observer's \(items, items\) accepted .*group_cons"):
        consistency([ORDER])
    with pytest.raises(InputError, match="2 items given, 3 or more accepted"):
        consistency([[0, 1], [0, 0]])
    with pytest.raises(InputError, match="2 items given, 3 or more accepted"):
        group_consistency([[[0, 1], [0, 0]]])
    with pytest.raises(InputError, match="both 0"):
        consistency([[0, 1, 1], [0, 0, 0], [0, 0, 0]])
    with pytest.raises(InputError, match="participants: 1 given, one for each of 2 tournaments"):
        group_consistency([ORDER, ORDER], ["p"])
