import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.errors import InputError
from analysis.ranking.mean_ranks import normal_fit
from analysis.ranking.published_numbers import check_mean_ranks, possible_numbers

# Lopez-Moreno 2011, tables 7.4 and 7.5.
VASE = [3.759, 1.931, 4.701, 2.931, 1.828]
ELEPHANT = [4.149, 2.747, 2.851, 3.632, 5.471, 2.356]


def test_published_mean_ranks_do_not_add_up() -> None:
    for means, total, expected in ((VASE, 15.15, 15), (ELEPHANT, 21.21, 21)):
        check = check_mean_ranks(means, decimals=3)
        assert check.total == pytest.approx(total, abs=0.006)
        assert check.expected == expected
        assert not check.possible
        assert "complete rankings give" in str(check)


def test_published_mean_ranks_are_those_of_the_stated_participants() -> None:
    # Sec. 7.5 states 87 observers: all eleven means are multiples of 1 / 87, and of no other
    # number up to 173; so the ranks are whole, but 13 and 18 too many in sum.
    assert possible_numbers(VASE + ELEPHANT, decimals=3, largest=173) == [87]
    surplus = [sum(np.rint(np.array(means) * 87)) for means in (VASE, ELEPHANT)]
    assert surplus == [87 * 15 + 13, 87 * 21 + 18]


def test_published_percentages_of_realism_are_of_17_people() -> None:
    # Sec. 6.4.2: 70.59 % and 52.94 %, of 20 people as stated.
    assert possible_numbers([0.7059, 0.5294], decimals=4, largest=33) == [17]


def test_published_differences_of_preference_are_of_42_answers() -> None:
    # Sec. 8.7: differences of 2/42, 4/42 and 1/41, and 1.96 * 0.5 / sqrt(42) = 0.15121.
    assert 42 in possible_numbers([0.04762, 0.09524], decimals=5, largest=96)
    assert possible_numbers([0.02439], decimals=5, largest=60) == [41]
    assert 1.96 * np.sqrt(0.25 / 42) == pytest.approx(0.15121, abs=1e-5)  # printed cut, not rounded


@given(st.integers(2, 60), st.integers(2, 8), st.integers(0, 2**32 - 1), st.integers(1, 4))
def test_printed_means_of_true_rankings_pass(
    participants: int, items: int, seed: int, decimals: int
) -> None:
    generator = np.random.default_rng(seed)
    ranks = np.array([generator.permutation(items) + 1.0 for _ in range(participants)])
    printed = normal_fit(ranks)["mean"].round(decimals).tolist()
    check = check_mean_ranks(printed, decimals)
    assert check.possible
    assert "as complete rankings give" in str(check)
    assert participants in possible_numbers(printed, decimals)


def test_refuses() -> None:
    with pytest.raises(InputError, match=r"means: \[1.5\] given, two or more from 1 to 1 accepted"):
        check_mean_ranks([1.5], 1)
    with pytest.raises(InputError, match="two or more from 1 to 2 accepted"):
        check_mean_ranks([1.5, 2.5], 1)
    with pytest.raises(InputError, match="decimals: -1 given, 0 or more accepted"):
        check_mean_ranks([1.5, 1.5], -1)
    with pytest.raises(InputError, match="printed, largest: one mean or more"):
        possible_numbers([], 2)
