from collections import Counter
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.errors import InputError
from experiments.planning.course import next_trial
from experiments.planning.trials import Answer, Assignment, planned_trials
from experiments.study import Study
from stimuli.manifest import StimulusSet

numbers = st.integers(1, 10_000)
repeat_counts = st.integers(1, 5)


def repeated(study: Study, repeats: int, seed: int = 1) -> Study:
    design = study.design.model_copy(update={"repeats": repeats, "seed": seed})
    return study.model_copy(update={"design": design})


@given(number=numbers, repeats=repeat_counts, seed=st.integers(0, 2**40))
def test_the_same_inputs_give_the_same_trials(
    study: Study, drawn_set: StimulusSet, number: int, repeats: int, seed: int
) -> None:
    designed = repeated(study, repeats, seed)
    first = planned_trials(designed, drawn_set, Assignment(number))
    assert first == planned_trials(designed, drawn_set, Assignment(number))
    assert [trial.index for trial in first] == list(range(len(first)))


@given(number=numbers, repeats=repeat_counts)
def test_each_stimulus_is_shown_as_often_as_the_design_says(
    study: Study, drawn_set: StimulusSet, number: int, repeats: int
) -> None:
    trials = planned_trials(repeated(study, repeats), drawn_set, Assignment(number))
    shown = Counter(trial.stimuli[0] for trial in trials if trial.phase == "main")
    assert shown == {stimulus.id: repeats for stimulus in drawn_set.with_role("main")}


@given(number=numbers, repeats=repeat_counts)
def test_no_image_follows_itself(
    study: Study, drawn_set: StimulusSet, number: int, repeats: int
) -> None:
    # With two stimuli nearly every border of two rounds would repeat one.
    two = drawn_set.with_role("main")[:2]
    small = drawn_set.model_copy(update={"stimuli": (*two, *drawn_set.with_role("practice"))})
    for stimuli in (drawn_set, small):
        trials = planned_trials(repeated(study, repeats), stimuli, Assignment(number))
        main = [trial.stimuli for trial in trials if trial.phase == "main"]
        assert all(left != right for left, right in pairwise(main))


def test_practice_comes_first_and_alike_for_everybody(study: Study, drawn_set: StimulusSet) -> None:
    practice = [stimulus.id for stimulus in drawn_set.with_role("practice")]
    for number in (1, 2, 77):
        trials = planned_trials(study, drawn_set, Assignment(number))
        first = trials[: study.practice.trials]
        assert [trial.stimuli[0] for trial in first] == practice[: study.practice.trials]
        assert all(trial.phase == "practice" and trial.feedback for trial in first)
        assert all(t.phase == "main" and not t.feedback for t in trials[study.practice.trials :])


def test_participants_and_seeds_have_orders_of_their_own(
    study: Study, drawn_set: StimulusSet
) -> None:
    orders = {
        tuple(trial.stimuli[0] for trial in planned_trials(designed, drawn_set, Assignment(number)))
        for designed in (repeated(study, 1, seed=1), repeated(study, 1, seed=2))
        for number in range(1, 51)
    }
    assert len(orders) == 100


def test_every_place_is_as_likely_for_every_stimulus(study: Study, drawn_set: StimulusSet) -> None:
    # Theory: the mean place of a stimulus over many participants is the middle of the list.
    participants, count = 2000, len(drawn_set.with_role("main"))
    places: Counter[str] = Counter()
    for number in range(1, participants + 1):
        for trial in planned_trials(study, drawn_set, Assignment(number)):
            if trial.phase == "main":
                places[trial.stimuli[0]] += trial.index - study.practice.trials
    deviation = ((count**2 - 1) / 12 / participants) ** 0.5  # of a mean of uniform places
    for total in places.values():
        assert abs(total / participants - (count - 1) / 2) < 5 * deviation


@given(number=numbers, data=st.data())
def test_a_session_is_replayed_from_its_answers(
    study: Study, drawn_set: StimulusSet, number: int, data: st.DataObject
) -> None:
    planned = planned_trials(study, drawn_set, Assignment(number))
    done = data.draw(st.sets(st.sampled_from(range(len(planned)))))
    answers: dict[int, Answer] = dict.fromkeys(done, 3)
    rest = [trial for trial in planned if trial.index not in done]
    for expected in rest[:3]:
        trial = next_trial(study, drawn_set, Assignment(number), answers)
        assert trial == expected
        answers[trial.index] = None  # a trial without an answer in time is done, too
    if len(rest) <= 3:
        assert next_trial(study, drawn_set, Assignment(number), answers) is None


def test_participants_are_numbered_from_one() -> None:
    with pytest.raises(InputError, match="participant_number: 0 given"):
        Assignment(0)
