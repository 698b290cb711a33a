import numpy as np
import pandas as pd
import pytest
from scipy import stats

from algorithms.errors import InputError
from analysis.answers.trials import trial_table
from analysis.bootstrap import Sums
from analysis.multiplicity import holm
from analysis.rates.hits import hit_rates
from analysis.rates.salience import object_salience
from analysis.rates.times import answer_times
from analysis.thresholds.rate_tests import rates_above
from experiments.simulated.observers import Observer, psychometric_function
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import OBSERVER, rows_of

PARTICIPANTS = 150


@pytest.fixture(scope="module")
def table(study: Study, drawn_set: StimulusSet) -> pd.DataFrame:
    return trial_table(rows_of(study, drawn_set, PARTICIPANTS, seed=4), study, drawn_set)


@pytest.fixture(scope="module")
def biased(study: Study, drawn_set: StimulusSet) -> pd.DataFrame:
    observer = Observer(threshold=25, width=30, salience={5: 4.0})
    rows = rows_of(study, drawn_set, PARTICIPANTS, seed=5, observer=observer)
    return trial_table(rows, study, drawn_set)


def test_hit_rates_recover_the_psychometric_function(table: pd.DataFrame) -> None:
    # Recovery, and theory: of 54 intervals of 95 %, fewer than 44 hold the truth once in 10^4.
    rates = hit_rates(
        table, ("level", "placement", "material"), 1 / 8, np.random.default_rng(1)
    ).table
    expected = psychometric_function(rates["level"], 25, OBSERVER.width, 1 / 8, OBSERVER.lapse_rate)
    held = (rates["low"] <= expected) & (expected <= rates["high"])
    assert len(rates) == 9 * 3 * 2
    assert held.sum() >= 44
    assert (rates["answers"] == PARTICIPANTS).all()


def test_hit_rate_intervals_are_binomial_for_independent_answers(table: pd.DataFrame) -> None:
    # Theory: simulated answers are independent, so the interval is the binomial one.
    rates = hit_rates(table, ("placement",), 1 / 8, np.random.default_rng(2)).table
    chances = psychometric_function(table["level"], 25, OBSERVER.width, 1 / 8, OBSERVER.lapse_rate)
    scored = chances[~table["control"].to_numpy()]
    variance = np.mean(scored * (1 - scored)) / (PARTICIPANTS * 18)
    length = 2 * stats.norm.ppf(0.975) * np.sqrt(variance)
    np.testing.assert_allclose(rates["high"] - rates["low"], length, rtol=0.2)


def test_independent_answers_have_the_exact_test(table: pd.DataFrame) -> None:
    # Another implementation: scipy's exact test, where each participant answered a cell once.
    rates = hit_rates(
        table, ("level", "placement", "material"), 1 / 8, np.random.default_rng(1)
    ).table
    expected = stats.binom.sf(rates["hits"] - 1, rates["answers"], 1 / 8)
    np.testing.assert_allclose(rates["p_value"], expected)
    np.testing.assert_allclose(rates["p_holm"], holm(rates["p_value"]))
    assert set(rates["test"]) == {"exact binomial"}
    assert set(rates["interval"]) == {"Clopper-Pearson"}


def test_several_answers_of_a_participant_have_a_test_over_participants() -> None:
    # Property: two experts among guessers are evidence over answers, less so over participants.
    right = np.array([[20, 20]] * 2 + [[2, 3]] * 9 + [[3, 2]] * 9)
    rows = pd.DataFrame(
        [
            {"participant": who, "level": level, "correct": k < right[who, level]}
            for who in range(20)
            for level in (0, 1)
            for k in range(20)
        ]
    )
    rates = hit_rates(rows, ("level",), 1 / 8, np.random.default_rng(1)).table
    assert set(rates["test"]) == {"score test over participants"}
    assert (rates["p_value"] > stats.binom.sf(rates["hits"] - 1, 400, 1 / 8) * 100).all()


def test_hit_rates_keep_the_level_of_their_test_where_everybody_guesses() -> None:
    # Theory: at most 5 % false alarms of 1,000, with 15 participants who answer 6 times each.
    right = np.random.default_rng(6).binomial(6, 1 / 8, size=(15, 1000)).astype(float)
    cells = pd.DataFrame({"cell": range(1000)})
    p_values, _ = rates_above(Sums(cells, right, np.full(right.shape, 6.0)), 1 / 8)
    assert np.mean(np.array(p_values) < 0.05) < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 1000)


def test_controls_are_in_no_hit_rate(table: pd.DataFrame) -> None:
    rates = hit_rates(table, ("level",), 1 / 8, np.random.default_rng(1))
    assert 0 not in set(rates.table["level"])
    assert rates.n == PARTICIPANTS * 54


def test_salience_recovers_the_weights(biased: pd.DataFrame, drawn_set: StimulusSet) -> None:
    # Recovery: weights 4 and 7 times 1, so shares 4/11 and 1/11.
    salience = object_salience(biased, drawn_set.objects, (), np.random.default_rng(1))
    shares = salience.choices.set_index("object")["share"]
    error = np.sqrt(4 / 11 * 7 / 11 / salience.n)
    assert salience.most_salient == "e"
    assert salience.n == PARTICIPANTS * 6
    assert shares["e"] == pytest.approx(4 / 11, abs=4 * error)
    assert shares.drop("e").mean() == pytest.approx(1 / 11, abs=4 * error)
    assert shares.sum() == pytest.approx(1)


def test_salient_choices_fall_as_the_target_shows(
    biased: pd.DataFrame, drawn_set: StimulusSet
) -> None:
    # Theory: among all answers the salient object keeps (1 - d) 4/11, d the rate of noticing.
    fall = object_salience(biased, drawn_set.objects, (), np.random.default_rng(1)).fall
    answers = fall[(fall["measure"] == "share of answers") & (fall["level"] > 0)]
    best = 1 - OBSERVER.lapse_rate / (1 - 1 / 8)
    noticed = best * (psychometric_function(answers["level"], 25, 30, 0, 0))
    expected = (1 - noticed) * 4 / 11
    error = np.sqrt(expected * (1 - expected) / answers["answers"])
    assert (np.abs(answers["share"] - expected) < 4 * error + 1e-3).all()


def test_salience_trend_tells_noticing_from_guessing(
    biased: pd.DataFrame, drawn_set: StimulusSet
) -> None:
    # Theory: the observer names what is noticed, else guesses by salience. So the salient object's
    # share of answers falls with the level, and its share of misses does not.
    trend = object_salience(biased, drawn_set.objects, (), np.random.default_rng(1)).trend
    answers, misses = (
        trend[trend["measure"] == f"share of {kind}"] for kind in ("answers", "misses")
    )
    assert answers["ratio_high"].item() < 1
    assert answers["p_holm"].item() < 0.001
    assert misses["ratio_low"].item() < 1 < misses["ratio_high"].item()


def test_only_the_salient_object_is_chosen_above_chance(
    biased: pd.DataFrame, drawn_set: StimulusSet
) -> None:
    choices = object_salience(biased, drawn_set.objects, (), np.random.default_rng(1)).choices
    above = choices[choices["p_holm"] < 0.05]
    assert above["object"].tolist() == ["e"]


def test_salience_without_enough_answers_for_a_trend_says_so(
    biased: pd.DataFrame, drawn_set: StimulusSet
) -> None:
    one = biased[biased["participant"] == biased["participant"].iloc[0]]
    trend = object_salience(one, drawn_set.objects, (), np.random.default_rng(1)).trend
    assert trend["p_value"].isna().all()
    assert trend["note"].str.len().min() > 0


def test_salience_splits_by_condition(biased: pd.DataFrame, drawn_set: StimulusSet) -> None:
    choices = object_salience(
        biased, drawn_set.objects, ("placement",), np.random.default_rng(1)
    ).choices
    split = choices[choices["placement"].notna()]
    whole = choices[choices["placement"].isna()].set_index("object")["chosen"]
    assert split.groupby("object")["chosen"].sum().to_dict() == whole.to_dict()


def test_times_recover_the_medians(table: pd.DataFrame) -> None:
    # Recovery: log-normal times have their median as geometric mean; controls are all guessed.
    times = answer_times(table, ("level", "placement"), np.random.default_rng(1)).table
    controls = times[times["level"] == 0]
    assert ((controls["low_s"] < 12.5) & (controls["high_s"] > 11.5)).all()
    largest = times[times["level"] == 90]
    best = 1 - OBSERVER.lapse_rate / (1 - 1 / 8)
    expected = np.exp(best * np.log(5) + (1 - best) * np.log(12))
    np.testing.assert_allclose(largest["mean_s"], expected, rtol=0.1)


def test_time_intervals_follow_theory(table: pd.DataFrame) -> None:
    # Theory: the logarithms scatter by 0.5, so the interval is exp(+-1.96 * 0.5 / sqrt(n)).
    times = answer_times(table, ("level",), np.random.default_rng(1)).table
    controls = times[times["level"] == 0]
    reach = stats.norm.ppf(0.975) * OBSERVER.time_spread / np.sqrt(controls["answers"].item())
    ratio = (controls["high_s"] / controls["low_s"]).item()
    assert np.log(ratio) == pytest.approx(2 * reach, rel=0.2)


def test_one_seed_one_result(table: pd.DataFrame) -> None:
    first, second = (
        hit_rates(table, ("level",), 1 / 8, np.random.default_rng(9)) for _ in range(2)
    )
    pd.testing.assert_frame_equal(first.table, second.table)
    assert first.seed == 9


def test_refuses_what_it_cannot_count(table: pd.DataFrame, drawn_set: StimulusSet) -> None:
    generator = np.random.default_rng(1)
    with pytest.raises(InputError, match="no answered trial that has a right answer"):
        hit_rates(table[table["control"]], ("level",), 1 / 8, generator)
    with pytest.raises(InputError, match="guess_rate: 1 given, 0 or more and below 1"):
        hit_rates(table, ("level",), 1, generator)
    with pytest.raises(InputError, match="no answered control trial"):
        object_salience(table[~table["control"]], drawn_set.objects, (), generator)
    with pytest.raises(InputError, match="no answer with a time"):
        answer_times(table.assign(reaction_time_s=np.nan), ("level",), generator)
