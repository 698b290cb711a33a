import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray

from algorithms.errors import InputError
from analysis.answers.trials import trial_table
from analysis.multiplicity import holm
from analysis.rates.effect_sentences import difference_sentences
from analysis.thresholds.bayesian_fit import ThresholdFit, fit_threshold
from analysis.thresholds.condition_differences import condition_differences
from analysis.thresholds.sigmoid import rate_at
from analysis.thresholds.threshold_difference import (
    ThresholdDifference,
    posterior_difference,
    threshold_difference,
)
from experiments.simulated.observers import Observer
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import rows_of

LEVELS = np.arange(10.0, 91.0, 10.0)
GUESS_RATE = 1 / 8
ANSWERS = 6

Counts = tuple[NDArray[np.int64], NDArray[np.int64]]


def conditions(
    people: int, shift: float, spread: float, seed: int, *, paired: bool = True
) -> tuple[Counts, Counts]:
    """Right answers and all answers in two conditions, the second's threshold lying higher."""
    generator = np.random.default_rng(seed)
    own = generator.normal(35, spread, (people, 1))
    others = own if paired else generator.normal(35, spread, (people, 1))
    first, second = (
        generator.binomial(ANSWERS, rate_at(LEVELS, thresholds, 30, GUESS_RATE, 0.02))
        for thresholds in (own, others + shift)
    )
    total = np.full(first.shape, ANSWERS)
    return (first, total), (second, total)


def difference(
    counts: tuple[Counts, Counts], *, paired: bool = True, correct: float | None = None
) -> ThresholdDifference:
    generator = np.random.default_rng(1)
    return threshold_difference(
        LEVELS, *counts, GUESS_RATE, generator, 500, paired=paired, correct=correct
    )


def fitted(answers: int, threshold: float, seed: int) -> ThresholdFit:
    correct = np.random.default_rng(seed).binomial(
        answers, rate_at(LEVELS, threshold, 30, GUESS_RATE, 0.02)
    )
    return fit_threshold(LEVELS, correct, [answers] * 9, GUESS_RATE)


@pytest.mark.parametrize("correct", [None, 0.75])
def test_recovers_a_difference(correct: float | None) -> None:
    # Recovery; with one width and lapse rate it is the same at every share of right answers.
    found = difference(conditions(60, 8.0, 5.0, 2), correct=correct)
    assert found.difference.low < -8 < found.difference.high < 0
    assert found.p_value < 0.01
    assert found.difference.value == pytest.approx(found.first - found.second)


def test_pairing_takes_out_what_participants_have_in_common() -> None:
    # Theory: thresholds that differ by 15 between people widen an unpaired interval only.
    counts = conditions(40, 0.0, 15.0, 3)
    paired, unpaired = difference(counts), difference(counts, paired=False)
    assert paired.difference.value == unpaired.difference.value
    lengths = [one.difference.high - one.difference.low for one in (paired, unpaired)]
    assert lengths[0] < 0.75 * lengths[1]
    assert (paired.participants, unpaired.participants) == (40, 80)


def test_unpaired_length_is_that_of_two_independent_intervals() -> None:
    # Theory: variances add; 60 people with a standard deviation of 12 each.
    found = difference(conditions(60, 0.0, 12.0, 4, paired=False), paired=False)
    expected = 2 * 1.98 * np.sqrt(2 / 60) * 12
    assert found.difference.high - found.difference.low > 0.8 * expected


@pytest.mark.parametrize("shift", [0.0, 3.0, 6.0])
def test_test_and_interval_agree(shift: float) -> None:
    # Property: below 5 % just where the interval leaves 0 out.
    for seed in range(4):
        found = difference(conditions(15, shift, 6.0, seed))
        excluded = not found.difference.low <= 0 <= found.difference.high
        assert excluded == (found.p_value < 0.05)


def test_swapping_the_conditions_turns_the_sign() -> None:
    counts = conditions(20, 4.0, 5.0, 6)
    there, back = difference(counts), difference(counts[::-1])
    assert there.difference.value == -back.difference.value
    assert there.difference.low == -back.difference.high
    assert there.p_value == back.p_value


def test_bayesian_difference_is_that_of_two_normal_posteriors() -> None:
    # Theory: with many answers posteriors are normal, so that squared lengths add.
    first, second = fitted(2000, 40, 1), fitted(2000, 35, 2)
    found = posterior_difference(first, second)
    one, other = (fit.threshold.high - fit.threshold.low for fit in (first, second))
    length = found.difference.high - found.difference.low
    assert length == pytest.approx(np.hypot(one, other), rel=0.05)
    assert found.difference.value == first.threshold.value - second.threshold.value
    assert found.difference.low < 5 < found.difference.high
    assert found.p_value < 1e-3


def test_bayesian_and_bootstrap_difference_agree_for_people_alike() -> None:
    # Another method: where participants do not differ, answers are independent.
    counts = conditions(60, 5.0, 0.0, 7)
    first, second = (
        fit_threshold(LEVELS, right.sum(axis=0), total.sum(axis=0), GUESS_RATE)
        for right, total in counts
    )
    bayesian, bootstrap = posterior_difference(first, second), difference(counts)
    length = bootstrap.difference.high - bootstrap.difference.low
    assert bayesian.difference.value == pytest.approx(bootstrap.difference.value, abs=0.15 * length)
    assert bayesian.difference.high - bayesian.difference.low == pytest.approx(length, rel=0.25)


def test_bayesian_difference_at_a_stated_share() -> None:
    first, second = fitted(500, 40, 1), fitted(500, 35, 2)
    found = posterior_difference(first, second, correct=0.75)
    assert found.first == first.threshold_at(0.75).threshold.value
    assert found.difference.low < found.difference.value < found.difference.high
    assert found.definition == "difference of levels at 75 % right of psychometric functions"


def test_no_difference_where_a_threshold_is_beyond_the_levels() -> None:
    (right, total), other = conditions(10, 0.0, 0.0, 8)
    found = difference(((np.zeros_like(right), total), other))
    assert np.isnan([found.difference.value, found.difference.low, found.p_value]).all()
    assert found.first == np.inf


def test_row_says_what_it_is() -> None:
    row = difference(conditions(10, 0.0, 5.0, 9)).to_frame().iloc[0]
    assert row["definition"] == "difference of mid-points of psychometric functions"
    assert "paired expanded percentile bootstrap over observers" in row["method"]
    assert (row["participants"], row["n"], row["resamples"], row["seed"]) == (10, 1080, 500, 1)


@pytest.fixture(scope="module")
def table(study: Study, drawn_set: StimulusSet) -> pd.DataFrame:
    observer = Observer(
        threshold={"front": 40, "back": 25, "front-back": 25}, width=30, condition="placement"
    )
    return trial_table(rows_of(study, drawn_set, 25, 3, observer), study, drawn_set)


def test_conditions_of_a_study_are_compared_in_pairs(table: pd.DataFrame) -> None:
    # Recovery: the front's threshold is 15 deg higher, the other two are alike.
    found = condition_differences(table, "placement", 1 / 8, np.random.default_rng(1), 300)
    assert list(found.differences) == ["front - back", "front - front-back", "back - front-back"]
    frame = found.to_frame()
    assert (frame["p_holm"] < 0.05).tolist() == [True, True, False]
    assert frame["difference_low"].iloc[0] < 15 < frame["difference_high"].iloc[0]
    np.testing.assert_allclose(frame["p_holm"], holm(frame["p_value"]))
    assert frame["paired"].all()


def test_one_sentence_for_each_pair(table: pd.DataFrame) -> None:
    never = table.assign(correct=table["correct"] & (table["placement"] != "front-back"))
    found = condition_differences(never, "placement", 1 / 8, np.random.default_rng(1), 300)
    first, *others = difference_sentences(found, "deg")
    assert first.startswith("Threshold by placement: front - back +1")
    assert ", p " in first
    assert "Holm" not in first  # two of the three pairs have no test
    assert all("a threshold lies beyond the levels tested" in other for other in others)


def test_groups_of_people_are_compared_unpaired(table: pd.DataFrame) -> None:
    artists = {name: number % 3 == 0 for number, name in enumerate(table["participant"].unique())}
    mapped = table.assign(artist=table["participant"].map(artists))
    found = condition_differences(mapped, "artist", 1 / 8, np.random.default_rng(1), 100)
    (one,) = found.differences.values()
    assert not one.paired
    assert one.participants == 25


def test_what_cannot_be_compared_is_said(table: pd.DataFrame) -> None:
    generator = np.random.default_rng(1)
    one = table[(table["placement"] != "back") | (table["level"] == 10)]
    found = condition_differences(one, "placement", 1 / 8, generator, 50)
    assert list(found.differences) == ["front - front-back"]
    assert found.left_out["front - back"].startswith("levels: 1 shown with both")
    with pytest.raises(InputError, match="condition: 'colour' given, a column of the table"):
        condition_differences(table, "colour", 1 / 8, generator)
    with pytest.raises(InputError, match="condition: no two values of simulated to compare"):
        condition_differences(table, "simulated", 1 / 8, generator)
    single = table[table["participant"] == table["participant"].iloc[0]]
    with pytest.raises(InputError, match="1 participants given, two or more"):
        condition_differences(single, "placement", 1 / 8, generator)


def test_refuses() -> None:
    first, second = conditions(5, 0.0, 0.0, 1)
    with pytest.raises(InputError, match="5 and 4 participants given, the same participants"):
        difference((first, (second[0][:4], second[1][:4])))
    with pytest.raises(InputError, match="second: 1 participants given, two or more"):
        difference((first, (second[0][:1], second[1][:1])), paired=False)
    with pytest.raises(InputError, match=r"correct: 0\.1 given, above the guess rate"):
        difference((first, second), correct=0.1)
    with pytest.raises(InputError, match=r"guess rates 0\.125 and 0 given"):
        posterior_difference(
            fitted(20, 40, 1), fit_threshold(LEVELS, [0, 1, 5, 9, 9, 9, 9, 9, 9], [9] * 9, 0.0)
        )
