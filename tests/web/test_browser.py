"""Real participants in a real Chromium, from the consent page to the completion code."""

import pandas as pd
import pytest
from playwright.sync_api import Route

from experiments.planning.trials import Assignment, planned_trials
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.web.browser import OpenPage, changed, stored

pytestmark = pytest.mark.browser


def test_every_answer_is_stored_once_through_a_reload_and_a_lost_network(
    open_page: OpenPage, store: Store, small_set: StimulusSet
) -> None:
    with open_page() as participant:
        page = participant.page
        participant.begin()
        for index in range(3):
            participant.wait_for_picture()
            assert participant.position == f"Practice {index + 1} of 3"
            participant.answer_by_mouse(index, 4, participant.point_of(small_set, 4))
            participant.read_feedback()
        participant.wait_for_picture()
        participant.answer_by_key(3, 5, "Numpad5")

        page.reload()
        participant.press("Go on")
        participant.wait_for_picture()
        assert participant.position == "Image 2 of 6"
        participant.answer_by_mouse(4, 7, participant.point_of(small_set, 7))
        participant.wait_for_picture()

        participant.context.set_offline(True)
        participant.answer_by_key(5, 1)
        participant.wait_for_picture()
        participant.answer_by_mouse(6, 8, participant.point_of(small_set, 8))
        participant.wait_for_picture()
        page.get_by_text("No connection").wait_for()
        assert sorted(stored(store)) == [0, 1, 2, 3, 4]

        # The network is back for pages but answers are still lost: the reload finds them kept.
        page.route("**/answers", lambda route: route.abort())
        participant.context.set_offline(False)
        page.reload()
        participant.press("Go on")
        participant.wait_for_picture()
        assert participant.position == "Image 5 of 6"
        participant.answer_by_key(7, 2)
        participant.wait_for_picture()
        participant.answer_by_key(8, 3)
        page.get_by_text("Sending your last answers").wait_for()
        assert sorted(stored(store)) == [0, 1, 2, 3, 4]
        page.unroute("**/answers")
        code = participant.code()

        assert stored(store) == participant.given
        assert len(store.responses()) == 9
        (session,) = store.sessions()
        assert session.completion_code == code
        assert session.demographics == {
            "age": 33,
            "gender": "undisclosed",
            "artistic_background": True,
        }
        kinds = [event.kind for event in store.events()]
        assert kinds.count("resume") == 2
        assert {"offline", "online"} <= set(kinds)

        page.reload()
        assert participant.code() == code


def test_measured_times_are_plausible(open_page: OpenPage, store: Store) -> None:
    with open_page() as participant:
        participant.begin()
        participant.pass_practice()
        for index in range(3, 9):
            participant.wait_for_picture()
            participant.answer_by_key(index, 1)
        participant.code()
    table = pd.DataFrame([vars(row) for row in store.responses()])
    assert (table["onset_measured_s"] >= table["onset_requested_s"]).all()
    assert table["onset_measured_s"].is_monotonic_increasing
    assert (table["reaction_time_s"] > 0).all()
    # Each answer was given before the next picture was asked for.
    answered_s = table["onset_measured_s"] + table["reaction_time_s"]
    assert (answered_s[:-1].to_numpy() < table["onset_requested_s"][1:].to_numpy()).all()
    assert table["frame_interval_s"].between(0.001, 0.1).all()
    assert (table["device"].str.match(r"Chrome \d+, Linux")).all()


def test_the_feedback_tells_the_truth(
    open_page: OpenPage, brief: Study, small_set: StimulusSet
) -> None:
    trials = planned_trials(brief, small_set, Assignment(1))
    answers = [small_set[trial.stimuli[0]].answer for trial in trials[:3]]
    with open_page() as participant:
        participant.begin()
        for index, answer in enumerate(answers):
            assert isinstance(answer, int)
            participant.wait_for_picture()
            given = answer if index != 1 else answer % 8 + 1
            participant.answer_by_key(index, given)
            told = participant.read_feedback()
            assert told.startswith("Right" if given == answer else "Not quite")
            assert str(answer) in told


def test_the_number_buttons_answer_too(open_page: OpenPage, store: Store) -> None:
    with open_page() as participant:
        participant.begin()
        participant.page.get_by_role("button", name="Object 6").click()
        participant.read_feedback()
        participant.wait_for_picture()
        participant.page.get_by_role("button", name="Object 2").focus()
        participant.page.keyboard.press("Enter")
        participant.read_feedback()
    assert stored(store) == {0: (6, "mouse"), 1: (2, "keyboard")}


def test_a_refused_answer_stops_nobody(open_page: OpenPage, store: Store) -> None:
    def refuse(route: Route) -> None:
        if (route.request.post_data_json or {}).get("trial_index") == 4:
            error = {"code": "conflict", "message": "another answer is stored"}
            route.fulfill(status=409, json={"error": error})
        else:
            route.continue_()

    with open_page() as participant:
        participant.page.route("**/answers", refuse)
        participant.begin()
        participant.pass_practice()
        for index in range(3, 9):
            participant.wait_for_picture()
            participant.answer_by_key(index, 1)
        participant.page.get_by_text("1 answers could not be stored").wait_for()
        participant.page.get_by_text("The server refused an answer").wait_for()
    assert sorted(stored(store)) == [0, 1, 2, 3, 5, 6, 7, 8]
    (refused,) = [event for event in store.events() if event.kind == "answer-refused"]
    assert refused.detail["status"] == 409


def test_the_time_limit_is_stored_as_no_answer(
    open_page: OpenPage, store: Store, brief: Study
) -> None:
    limited = changed(brief, timing={"blank_s": 0, "time_limit_s": 0.2}, practice={"trials": 0})
    with open_page(study=limited) as participant:
        participant.arrive()
        participant.consent()
        participant.describe_themself()
        participant.press("Begin")
        participant.code()
    assert [(row.answer, row.input, row.reaction_time_s) for row in store.responses()] == [
        (None, "none", None)
    ] * 6


def test_plain_http_on_another_machine_is_enough(open_page: OpenPage, store: Store) -> None:
    with open_page() as participant:
        participant.address = participant.address.replace("127.0.0.1", "study.example")
        participant.begin()
        assert participant.page.evaluate("window.isSecureContext") is False
        participant.answer_by_key(0, 2)
        participant.read_feedback()
        participant.wait_for_picture()
        # The browser says once that it ignores a header that needs a secure page.
        participant.complaints = [
            text for text in participant.complaints if "Cross-Origin-Opener-Policy" not in text
        ]
    assert stored(store) == {0: (2, "keyboard")}


def test_answers_survive_without_the_browsers_storage(open_page: OpenPage, store: Store) -> None:
    with open_page() as participant:
        participant.page.add_init_script(
            "delete window.localStorage; indexedDB.open = () => { throw new Error('refused'); };"
            "Object.defineProperty(window, 'localStorage',"
            " { get() { throw new DOMException('refused', 'SecurityError'); } });"
        )
        participant.begin()
        participant.pass_practice()
        for index in range(3, 9):
            participant.wait_for_picture()
            participant.answer_by_key(index, 8)
        participant.code()
    assert stored(store) == participant.given
    assert "not-kept" in [event.kind for event in store.events()]


def test_the_next_participant_begins_at_the_same_computer(
    open_page: OpenPage, store: Store
) -> None:
    with open_page() as participant:
        participant.begin()
        participant.address += "?new"
        participant.begin()
        participant.page.reload()
        participant.page.get_by_text("Welcome back").wait_for()
    assert [session.participant for session in store.sessions()] == ["P0001", "P0002"]
