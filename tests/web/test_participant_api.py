from pathlib import Path

import httpx
import pytest
from PIL import Image

from experiments.planning.trials import Assignment, planned_trials
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from stimuli.manifest import StimulusSet
from tests.comparison_studies import comparison_study
from tests.drawn_set import draw_set
from tests.web.visitor import SAID, STUDY, Visitor, consent


def error_code(reply: httpx.Response) -> str:
    return str(reply.json()["error"]["code"])


def changed(study: Study, **changes: object) -> Study:
    """Return another study; a `model_copy` would keep the digest of the first."""
    return Study.model_validate({**study.model_dump(), **changes})


def test_a_study_is_described_with_what_a_participant_needs(
    client: httpx.Client, study: Study
) -> None:
    told = client.get(f"/api/studies/{STUDY}").json()
    assert told["question"] == study.question
    assert told["consent"] == {"version": "1", "text": study.consent.text}
    assert told["demographics"] == list(study.demographics)
    assert told["choices"] == study.stimuli.choices
    assert told["timing"]["blank_s"] == study.timing.blank_s
    assert told["timing"]["time_limit_s"] is None
    assert told["answers"] == {"labels": None, "ties": False, "picks": None}
    assert told["closed"] is None
    assert told["recruitment"] == {"parameters": [], "required": False}


def test_the_example_is_shown_with_its_answer_and_is_no_trial(
    client: httpx.Client, drawn_set: StimulusSet, visitor: Visitor
) -> None:
    example = drawn_set.with_role("example")[0]
    told = client.get(f"/api/studies/{STUDY}").json()["example"]
    assert told["answer"] == example.answer
    with Image.open(drawn_set.path(example.file)) as picture:
        assert (told["width_px"], told["height_px"]) == picture.size
    image = client.get(told["image"])
    assert image.headers["content-type"] == "image/png"
    trials = visitor.get().json()["trials"]
    assert image.content not in [
        visitor.get(trial["pictures"][0]["image"]).content for trial in trials
    ]
    regions = client.get(told["regions"]).json()
    assert (
        sum(length for _, length in regions["runs"]) == regions["width_px"] * regions["height_px"]
    )


def test_nothing_tells_which_trials_test_attention(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    compared = comparison_study(study, "two-alternative")
    catch = {"better": "front", "worse": "back", "trials": 5}
    caught = changed(compared, catch=catch, exclusion={"least_catch_share": 0.8})
    with (
        running_server(create_app(caught, drawn_set, store)) as url,
        httpx.Client(base_url=url) as client,
    ):
        begun = client.post("/api/studies/two-alternative/sessions", json=consent()).json()
        headers = {"Authorization": f"Bearer {begun['token']}"}
        told = client.get(f"/api/sessions/{begun['session']}", headers=headers).json()["trials"]
    assert {trial["phase"] for trial in told} == {"main"}
    assert len(told) == 65
    assert all(set(trial) == set(told[0]) for trial in told)


def test_another_study_is_not_found(client: httpx.Client) -> None:
    for path in ("/api/studies/other", "/api/studies/other/example/image", "/s/other/"):
        reply = client.get(path)
        assert (reply.status_code, error_code(reply)) == (404, "not-found")


def test_sessions_are_numbered_and_stored_with_what_was_said(
    client: httpx.Client, store: Store
) -> None:
    first, second = Visitor(client).begin(), Visitor(client).begin(device="=2+2")
    assert (first.number, second.number) == (1, 2)
    stored = store.session(first.session)
    assert stored is not None
    assert stored.demographics == SAID
    assert stored.consent_version == "1"
    assert stored.screen["pixel_ratio"] == 1.5
    assert (stored.runner, stored.simulated, stored.pilot) == ("web", False, False)


def test_consent_to_another_text_is_refused(client: httpx.Client, store: Store) -> None:
    reply = client.post(f"/api/studies/{STUDY}/sessions", json=consent(consent_version="0"))
    assert (reply.status_code, error_code(reply)) == (409, "consent")
    assert store.sessions() == []


@pytest.mark.parametrize(
    ("said", "key"),
    [
        ({"age": 30, "gender": "female"}, "artistic_background"),
        ({**SAID, "height": 3}, "height"),
        ({**SAID, "age": "30"}, "age"),
        ({**SAID, "age": True}, "age"),
        ({**SAID, "age": 0}, "age"),
        ({**SAID, "gender": "f"}, "gender"),
        ({**SAID, "artistic_background": "yes"}, "artistic_background"),
    ],
)
def test_demographics_are_checked_by_key(
    client: httpx.Client, store: Store, said: dict[str, object], key: str
) -> None:
    reply = client.post(f"/api/studies/{STUDY}/sessions", json=consent(demographics=said))
    assert reply.status_code == 422
    assert f"demographics.{key}" in reply.json()["error"]["message"]
    assert store.sessions() == []


def test_trials_are_those_of_the_participants_number(
    visitor: Visitor, study: Study, drawn_set: StimulusSet
) -> None:
    planned = planned_trials(study, drawn_set, Assignment(visitor.number))
    told = visitor.get().json()["trials"]
    assert [trial["index"] for trial in told] == [trial.index for trial in planned]
    assert [trial["phase"] for trial in told] == [trial.phase for trial in planned]
    for trial, seen in zip(planned[:5], told[:5], strict=True):
        file = drawn_set.path(drawn_set[trial.stimuli[0]].file)
        assert visitor.get(seen["pictures"][0]["image"]).content == file.read_bytes()


def test_an_answer_is_stored_as_it_was_given(visitor: Visitor, store: Store) -> None:
    assert visitor.answer(7, 5, input="keyboard").json() == {"stored": True, "feedback": None}
    (row,) = store.responses()
    assert (row.trial_index, row.phase, row.answer, row.input) == (7, "main", 5, "keyboard")
    assert (row.reaction_time_s, row.onset_requested_s, row.onset_measured_s) == (
        2.31,
        10.01,
        10.02,
    )
    assert (row.frame_interval_s, row.dropped_frames) == (0.01667, 0)
    assert (row.session, row.id) == (visitor.session, f"{visitor.session}.0007")


def test_posting_twice_changes_nothing(visitor: Visitor, store: Store) -> None:
    first = visitor.answer(0, 3)
    before = store.responses()
    again = visitor.answer(0, 3, reaction_time_s=99.0)
    assert (again.status_code, again.json()) == (200, first.json())
    assert store.responses() == before


def test_a_second_answer_is_refused_and_the_first_stays(visitor: Visitor, store: Store) -> None:
    visitor.answer(0, 3)
    reply = visitor.answer(0, 4)
    assert (reply.status_code, error_code(reply)) == (409, "conflict")
    assert [row.answer for row in store.responses()] == [3]


def test_answers_for_another_participant_are_refused(client: httpx.Client, store: Store) -> None:
    mine, other = Visitor(client).begin(), Visitor(client).begin()
    with_others_id = mine.post("/answers", other.message(0))
    assert (with_others_id.status_code, error_code(with_others_id)) == (403, "forbidden")
    path = f"/api/sessions/{other.session}/answers"
    with_own_token = client.post(path, json=other.message(0), headers=mine.headers)
    assert (with_own_token.status_code, error_code(with_own_token)) == (401, "unauthorized")
    assert store.responses() == []


def test_an_id_of_another_trial_is_refused(visitor: Visitor, store: Store) -> None:
    assert visitor.answer(0, id=f"{visitor.session}.0001").status_code == 403
    assert store.responses() == []


@pytest.mark.parametrize(
    "authorization",
    [
        b"",
        b"Bearer",
        b"Bearer a b",
        b"Bearer wrong",
        b"Basic dXNlcjpwYXNz",
        b"Bearer \xff\xfe",
        b"\xe9",
    ],
)
def test_every_session_route_wants_the_sessions_token(
    visitor: Visitor, authorization: bytes
) -> None:
    (picture,) = visitor.get().json()["trials"][0]["pictures"]
    base, headers = f"/api/sessions/{visitor.session}", {b"Authorization": authorization}
    paths = (base, picture["image"], picture["regions"])
    replies = [
        *(visitor.client.get(path, headers=headers) for path in paths),
        *(
            visitor.client.post(f"{base}/{route}", json=message, headers=headers)
            for route, message in (
                ("answers", visitor.message(0)),
                ("events", {"kind": "blur"}),
                ("complete", None),
            )
        ),
    ]
    assert {(reply.status_code, error_code(reply)) for reply in replies} == {(401, "unauthorized")}


def test_images_of_another_session_are_not_found(client: httpx.Client) -> None:
    mine, other = Visitor(client).begin(), Visitor(client).begin()
    for kind in ("image", "regions"):
        opaque = other.get().json()["trials"][0]["pictures"][0][kind].rsplit("/", 1)[1]
        folder = {"image": "images", "regions": "regions"}[kind]
        assert mine.get(f"/{folder}/{opaque}").status_code == 404


def test_practice_feedback_comes_with_the_stored_answer(
    visitor: Visitor, study: Study, drawn_set: StimulusSet
) -> None:
    trial = planned_trials(study, drawn_set, Assignment(visitor.number))[0]
    truth = drawn_set[trial.stimuli[0]].answer
    assert isinstance(truth, int)
    wrong = truth % study.choices + 1
    assert visitor.answer(0, wrong).json()["feedback"] == {"correct": False, "answer": truth}
    assert visitor.answer(1).json()["feedback"] is not None
    resumed = visitor.get().json()
    assert resumed["feedback"]["0"] == {"correct": False, "answer": truth}
    assert sorted(resumed["feedback"]) == ["0", "1"]


def test_answers_arrive_in_any_order_and_the_session_resumes(visitor: Visitor) -> None:
    for index in (9, 2, 5):
        assert visitor.answer(index).status_code == 200
    told = visitor.get().json()
    assert told["answered"] == [2, 5, 9]
    assert (told["complete"], told["completion_code"]) == (False, None)


def test_completing_early_names_what_is_missing(visitor: Visitor) -> None:
    count = len(visitor.get().json()["trials"])
    for index in range(2, count):
        visitor.answer(index)
    reply = visitor.post("/complete", None)
    assert (reply.status_code, error_code(reply)) == (409, "incomplete")
    assert reply.json()["missing"] == [0, 1]


def test_completing_gives_the_same_code_ever_after(visitor: Visitor, store: Store) -> None:
    for trial in visitor.get().json()["trials"]:
        visitor.answer(trial["index"])
    codes = {visitor.post("/complete", None).json()["completion_code"] for _ in range(2)}
    told = visitor.get().json()
    assert codes == {told["completion_code"]}
    assert told["complete"] is True
    (session,) = store.sessions()
    assert session.completed_at is not None


def test_events_are_kept_in_order(visitor: Visitor, store: Store) -> None:
    for kind in ("blur", "focus", "resize"):
        detail = {"width_px": 800, "visible": True}
        assert visitor.post("/events", {"kind": kind, "detail": detail}).status_code == 204
    assert [(event.kind, event.detail) for event in store.events()] == [
        (kind, {"width_px": 800, "visible": True}) for kind in ("blur", "focus", "resize")
    ]


def test_no_answer_is_accepted_only_under_a_time_limit(
    study: Study, drawn_set: StimulusSet, store: Store, visitor: Visitor, tmp_path: Path
) -> None:
    assert visitor.answer(0, None, input="none").status_code == 422
    limited = changed(study, timing={"time_limit_s": 5.0})
    with (
        Store.open(tmp_path / "limited.sqlite") as other,
        running_server(create_app(limited, drawn_set, other)) as url,
        httpx.Client(base_url=url) as client,
    ):
        hurried = Visitor(client).begin()
        assert hurried.answer(0, None, input="none", reaction_time_s=None).status_code == 200
        assert [row.answer for row in other.responses()] == [None]
    assert store.responses() == []


def test_a_session_of_another_version_of_the_study_is_refused(
    visitor: Visitor, study: Study, store: Store, tmp_path: Path
) -> None:
    second = changed(study, version=2)
    with (
        running_server(create_app(second, draw_set(tmp_path), store)) as url,
        httpx.Client(base_url=url) as client,
    ):
        reply = client.get(f"/api/sessions/{visitor.session}", headers=visitor.headers)
    assert (reply.status_code, error_code(reply)) == (409, "study-changed")
