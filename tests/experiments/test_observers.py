from collections.abc import Callable
from dataclasses import fields
from itertools import combinations

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from algorithms.errors import InputError
from experiments.planning.trials import Assignment, planned_trials
from experiments.responses import Response
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer, psychometric_function, simulate_responses
from experiments.study import Study
from stimuli.manifest import Stimulus, StimulusSet
from tests.comparison_studies import pick_study

PARTICIPANTS = 300
CHOICES = 8
# A right observer's count leaves this range of its binomial once in 500000 counts.
TAIL = 1e-6


def table(study: Study, stimuli: StimulusSet, observer: Observer, seed: int = 7) -> pd.DataFrame:
    """Return simulated main answers with what the set says of their stimuli."""
    generator = np.random.default_rng(seed)
    responses = simulate_responses(study, stimuli, observer, PARTICIPANTS, generator)
    known = stimuli.to_frame().rename(columns={"answer": "odd"})
    responses["stimulus"] = [shown[0] for shown in responses["stimuli"]]
    merged = responses.merge(known, on="stimulus", validate="many_to_one")
    return merged[merged["phase"] == "main"]


def assert_binomial(successes: int, total: int, probability: float) -> None:
    low = float(stats.binom.ppf(TAIL, total, probability))
    high = float(stats.binom.ppf(1 - TAIL, total, probability))
    assert low <= successes <= high, (successes, total, probability)


def test_the_psychometric_function_is_psignifits() -> None:
    # Another implementation: psignifit 4, same definition of threshold and width.
    from psignifit.sigmoids import sigmoid_by_name

    levels = np.linspace(0, 90, 31)
    theirs = sigmoid_by_name("norm", PC=0.5, alpha=0.05)(
        levels, threshold=25.0, width=30.0, gamma=0.125, lambd=0.02
    )
    np.testing.assert_allclose(
        psychometric_function(levels, 25.0, 30.0, 0.125, 0.02), theirs, rtol=0, atol=1e-12
    )


def test_threshold_and_width_are_what_their_names_say() -> None:
    # Theory: F is 1/2 at the threshold, and 5 % and 95 % half a width away.
    shares = psychometric_function([10.0, 25.0, 40.0], 25.0, 30.0, 0.0, 0.0)
    np.testing.assert_allclose(shares, [0.05, 0.5, 0.95], rtol=0, atol=1e-12)
    ends = psychometric_function([-1e3, 1e3], 25.0, 30.0, 0.125, 0.02)
    np.testing.assert_allclose(ends, [0.125, 0.98], rtol=0, atol=1e-12)


def test_hits_follow_the_psychometric_function_at_every_level(
    study: Study, drawn_set: StimulusSet
) -> None:
    # Theory: guesses among all objects make P(right) = g + (1 - g - l) F exactly.
    observer = Observer(threshold=25.0, width=30.0, lapse_rate=0.1)
    answers = table(study, drawn_set, observer)
    for level, group in answers[answers["odd"].notna()].groupby("divergence_deg"):
        expected = psychometric_function(float(str(level)), 25.0, 30.0, 1 / CHOICES, 0.1)
        assert_binomial(int((group["answer"] == group["odd"]).sum()), len(group), float(expected))


def test_each_condition_has_its_threshold(study: Study, drawn_set: StimulusSet) -> None:
    thresholds = {"front": 20.0, "back": 40.0, "front-back": 60.0}
    observer = Observer(threshold=thresholds, width=20.0, condition="placement")
    answers = table(study, drawn_set, observer)
    answers = answers[answers["odd"].notna()]
    for (placement, level), group in answers.groupby(["placement", "divergence_deg"]):
        expected = psychometric_function(
            float(str(level)), thresholds[str(placement)], 20.0, 1 / CHOICES, 0.02
        )
        assert_binomial(int((group["answer"] == group["odd"]).sum()), len(group), float(expected))


def test_controls_are_answered_by_salience_alone(study: Study, drawn_set: StimulusSet) -> None:
    # Theory: shares are proportional to the weights; labels not named have weight 1.
    salience = {5: 3.0, 2: 0.0}
    observer = Observer(threshold=25.0, width=30.0, salience=salience)
    controls = table(study, drawn_set, observer).query("divergence_deg == 0")
    weights = [salience.get(label, 1.0) for label in range(1, CHOICES + 1)]
    for label, weight in enumerate(weights, start=1):
        chosen = int((controls["answer"] == label).sum())
        assert_binomial(chosen, len(controls), weight / sum(weights))


def test_salience_draws_the_answers_that_would_be_guesses(
    study: Study, drawn_set: StimulusSet
) -> None:
    # Theory: P(right) = d + (1 - d) s with s the odd object's share of the salience.
    observer = Observer(threshold=25.0, width=30.0, lapse_rate=0.0, salience={5: 5.0})
    answers = table(study, drawn_set, observer)
    answers = answers[answers["odd"].notna()]
    for (odd, level), group in answers.groupby(["odd", "divergence_deg"]):
        noticed = float(psychometric_function(float(str(level)), 25.0, 30.0, 0.0, 0.0))
        share = (5 if odd == 5 else 1) / 12
        expected = noticed + (1 - noticed) * share
        assert_binomial(int((group["answer"] == group["odd"]).sum()), len(group), expected)


def test_times_are_lognormal_about_their_medians(study: Study, drawn_set: StimulusSet) -> None:
    observer = Observer(
        threshold=45.0, width=1e-3, lapse_rate=0.0, noticed_time_s=3.0, guessed_time_s=9.0
    )
    answers = table(study, drawn_set, observer)
    for noticed, median_s in ((True, 3.0), (False, 9.0)):
        times_s = answers.loc[(answers["divergence_deg"] > 45) == noticed, "reaction_time_s"]
        standardised = np.log(times_s / median_s) / observer.time_spread
        assert stats.kstest(standardised, "norm").pvalue > 1e-4


def test_one_answer_at_a_time_agrees_with_many(study: Study, drawn_set: StimulusSet) -> None:
    observer = Observer(threshold=45.0, width=1e-3, lapse_rate=0.0)
    generator = np.random.default_rng(3)
    for stimulus in drawn_set.with_role("main"):
        label, time_s = observer.answer(study, stimulus, generator)
        assert isinstance(label, int)
        assert 1 <= label <= CHOICES
        assert time_s > 0
        if float(stimulus.factors["divergence_deg"]) > 45:
            assert label == stimulus.answer


def test_simulated_rows_have_the_columns_and_trials_of_real_ones(
    study: Study, drawn_set: StimulusSet
) -> None:
    observer = Observer(threshold=25.0, width=30.0)
    responses = simulate_responses(study, drawn_set, observer, 3, np.random.default_rng(1))
    assert list(responses.columns) == [field.name for field in fields(Response)]
    assert responses["id"].is_unique
    assert responses["simulated"].all()
    assert set(responses["runner"]) == {"simulation"}
    for number, (_, rows) in enumerate(responses.groupby("participant"), start=1):
        planned = planned_trials(study, drawn_set, Assignment(number))
        assert rows["stimuli"].tolist() == [trial.stimuli for trial in planned]
        assert rows["phase"].tolist() == [trial.phase for trial in planned]


def test_the_same_generator_gives_the_same_answers(study: Study, drawn_set: StimulusSet) -> None:
    observer = Observer(threshold=25.0, width=30.0)
    first, again, other = (
        simulate_responses(study, drawn_set, observer, 2, np.random.default_rng(seed))["answer"]
        for seed in (1, 1, 2)
    )
    assert first.tolist() == again.tolist()
    assert first.tolist() != other.tolist()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Observer(25, 0), "width: 0 given, more than 0 accepted"),
        (lambda: Observer(25, 30, lapse_rate=0.6), "lapse_rate: 0.6 given"),
        (lambda: Observer(25, 30, lapse_rate=-0.1), "lapse_rate: -0.1 given"),
        (lambda: Observer(25, 30, salience={1: -1.0}), "salience: .* 0 or more accepted"),
        (lambda: Observer(25, 30, noticed_time_s=0), "noticed_time_s"),
        (lambda: Observer(25, 30, time_spread=-1), "time_spread"),
        (lambda: Observer({"front": 25}, 30), "condition"),
        (lambda: Observer(25, 30, condition="placement"), "condition"),
    ],
)
def test_impossible_observers_are_refused(make: Callable[[], Observer], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("observer", "message"),
    [
        (Observer(25, 30, salience={9: 1.0}), "label 9 given, labels 1 to 8 accepted"),
        (Observer(25, 30, salience=dict.fromkeys(range(1, 9), 0.0)), "salience: 0 for every label"),
        (Observer({"front": 25}, 30, condition="placement"), "threshold: none is given for"),
        (Observer({"front": 25}, 30, condition="colour"), "threshold: none is given for colour"),
    ],
)
def test_observers_that_do_not_fit_the_study_are_refused(
    study: Study, drawn_set: StimulusSet, observer: Observer, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        simulate_responses(study, drawn_set, observer, 1, np.random.default_rng(1))


def test_studies_and_stimuli_without_a_level_or_label_are_refused(
    study: Study, drawn_set: StimulusSet
) -> None:
    observer, generator = Observer(25, 30), np.random.default_rng(1)
    stimulus = drawn_set.stimuli[0]
    nameless = study.model_copy(
        update={"stimuli": study.stimuli.model_copy(update={"level": None})}
    )
    with pytest.raises(InputError, match=r"stimuli\.level"):
        observer.answer(nameless, stimulus, generator)
    worded = Stimulus(**{**stimulus.model_dump(), "factors": {"divergence_deg": "much"}})
    with pytest.raises(InputError, match="'much', not a number"):
        observer.answer(study, worded, generator)
    named = Stimulus(**{**stimulus.model_dump(), "answer": "e"})
    with pytest.raises(InputError, match="a label is accepted"):
        observer.answer(study, named, generator)
    with pytest.raises(InputError, match="participants: 0 given"):
        simulate_responses(study, drawn_set, observer, 0, generator)


def test_picks_are_as_likely_as_their_model_says(study: Study, drawn_set: StimulusSet) -> None:
    # Theory: two inserted, each noticed with probability 1/2; one or two picks, evenly drawn.
    observer = Observer(threshold=90.0, width=30.0, lapse_rate=0.0)
    one = next(each for each in drawn_set.stimuli if each.factors["divergence_deg"] == 90)
    both = one.model_copy(update={"answer": (7, 3)})
    generator = np.random.default_rng(5)
    picking = pick_study(study, (1, 2))
    answers = [observer.answer(picking, both, generator)[0] for _ in range(2000)]
    possible = set(combinations(range(1, 9), 1)) | set(combinations(range(1, 9), 2))
    assert set(answers) <= possible
    exact = sum(answer == (3, 7) for answer in answers)
    # Both noticed; one noticed and the other guessed of seven; none noticed and both guessed.
    assert_binomial(exact, 2000, 0.25 + 0.5 * 0.5 / 7 + 0.25 * 0.5 / 28)
    assert_binomial(sum(answer in {(a,) for a in range(1, 9)} for answer in answers), 2000, 0.375)


def test_who_tires_lapses_more_often_towards_the_end(study: Study, drawn_set: StimulusSet) -> None:
    """Theory: at plain levels the share of wrong answers grows by the fatigue per 100 trials."""
    plain = study.model_copy(
        update={
            "design": study.design.model_copy(update={"repeats": 4}),
            "stimuli": study.stimuli.model_copy(update={"only": {"divergence_deg": (80, 90)}}),
        }
    )
    tired = Observer(threshold=10, width=1, lapse_rate=0.0, fatigue=0.6)
    rows = simulate_responses(plain, drawn_set, tired, 200, np.random.default_rng(1))
    main = rows[rows["phase"] == "main"]
    wrong = [
        answer != drawn_set[shown[0]].answer
        for answer, shown in zip(main["answer"], main["stimuli"], strict=True)
    ]
    slope, _ = np.polyfit(main["trial_index"].to_numpy(float), np.array(wrong, float), 1)
    assert slope == pytest.approx(0.006, abs=0.0008)
    assert tired.after(10_000).lapse_rate == 0.5
    assert ItemObserver({}, lapse_rate=0.1, fatigue=0.5).after(50).lapse_rate == pytest.approx(0.35)
