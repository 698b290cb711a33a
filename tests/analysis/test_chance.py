import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from algorithms.errors import InputError
from analysis.thresholds.chance import (
    largest_level_at_chance,
    largest_level_at_chance_by_participant,
)

LEVELS = (10.0, 20.0, 30.0, 40.0)
GUESS_RATE = 1 / 8


@given(correct=st.lists(st.integers(0, 40), min_size=4, max_size=4))
def test_exact_test_is_that_of_scipy(correct: list[int]) -> None:
    # Another implementation: scipy's binomial survival function.
    limit = largest_level_at_chance(LEVELS, correct, [40] * 4, GUESS_RATE)
    expected = stats.binom.sf(np.array(correct) - 1, 40, GUESS_RATE)
    np.testing.assert_allclose(limit.p_values, expected)
    at_chance = [level for level, p in zip(LEVELS, expected, strict=True) if p >= 0.05]
    np.testing.assert_equal(limit.level, max(at_chance, default=np.nan))


def test_exact_test_keeps_its_level_when_everybody_guesses() -> None:
    # Theory: at most 5 % false alarms, also with many answers of each participant.
    hits = np.random.default_rng(1).binomial(48, GUESS_RATE, size=4000)
    counts = np.bincount(hits, minlength=49)
    alarms = sum(
        count
        for right, count in enumerate(counts)
        if largest_level_at_chance([1, 2], [right, 48], [48, 48], GUESS_RATE).p_values[0] < 0.05
    )
    assert alarms / 4000 < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 4000)


def test_participant_test_is_the_t_test_for_equal_numbers() -> None:
    # Another implementation: scipy's one-sample t-test of the participants' rates.
    generator = np.random.default_rng(2)
    correct = generator.binomial(12, (0.1, 0.15, 0.3, 0.9), size=(20, 4))
    limit = largest_level_at_chance_by_participant(LEVELS, correct, np.full((20, 4), 12), 1 / 8)
    expected = stats.ttest_1samp(correct / 12, 1 / 8, alternative="greater").pvalue
    np.testing.assert_allclose(limit.p_values, expected)


def test_participant_test_allows_for_differing_participants() -> None:
    # Property: two experts among guessers are evidence over answers, less so over participants.
    correct = np.array([[20, 20]] * 2 + [[2, 2]] * 18)
    total = np.full((20, 2), 20)
    over_answers = largest_level_at_chance(
        [10, 20], correct.sum(axis=0), total.sum(axis=0), GUESS_RATE
    )
    over_participants = largest_level_at_chance_by_participant([10, 20], correct, total, GUESS_RATE)
    assert np.isnan(over_answers.level)
    assert over_participants.level == 20
    assert over_participants.at_largest_level


def test_participants_alike_are_judged_by_their_number() -> None:
    # Theory: if a participant is either always right or never, three of them are right by chance
    # once in 8 cubed. Their t has no spread to go by and would be infinite.
    limit = largest_level_at_chance_by_participant(
        [1, 2], np.full((3, 2), 4), np.full((3, 2), 4), 1 / 8
    )
    assert np.isnan(limit.level)
    np.testing.assert_allclose(limit.p_values, (1 / 8) ** 3)


def test_levels_above_the_limit_are_a_fixed_sequence_that_keeps_alpha() -> None:
    # Theory (Maurer et al. 1995): where three levels of four are at chance, it is said of any of
    # these three that it is above at most once in 20 times, without a correction.
    generator = np.random.default_rng(3)
    correct = generator.binomial(40, (1 / 8, 1 / 8, 1 / 8, 0.9), size=(1000, 4))
    wrong = sum(
        not largest_level_at_chance(LEVELS, row, [40] * 4, GUESS_RATE).level >= 30
        for row in correct
    )
    assert wrong / 1000 < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 1000)


def test_table_names_test_and_definition() -> None:
    frame = largest_level_at_chance(LEVELS, [5, 5, 20, 40], [40] * 4, GUESS_RATE).to_frame()
    assert frame["above_chance"].tolist() == [False, False, True, True]
    assert set(frame["limit"]) == {20.0}
    assert set(frame["definition"]) == {"largest level not distinguishable from chance"}
    assert set(frame["test"]) == {"exact binomial"}


def test_refuses() -> None:
    with pytest.raises(InputError, match="alpha: 1 given, above 0 and below 1"):
        largest_level_at_chance([1, 2], [1, 2], [3, 3], 0.1, alpha=1)
    with pytest.raises(InputError, match="two participants or more"):
        largest_level_at_chance_by_participant([1, 2], np.ones((1, 2)), np.ones((1, 2)), 0.1)
    with pytest.raises(InputError, match="different levels in rising order"):
        largest_level_at_chance_by_participant([1, 1, 2], np.ones((2, 3)), np.ones((2, 3)), 0.1)
