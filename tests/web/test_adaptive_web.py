"""Adaptive designs through the web: one trial after the other, nothing lost, nothing told twice."""

import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import httpx
import numpy as np
import pytest
from playwright.sync_api import Route

from experiments.exports.collection import load_collection
from experiments.planning.course import course_of
from experiments.planning.presentations import Assignment
from experiments.planning.replay import replay_session
from experiments.responses import DECISION, DEVICE_COLUMNS, TIMING_COLUMNS, responses_frame
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.simulate import simulate_over_http
from stimuli.manifest import StimulusSet
from tests.adaptive_studies import adaptive_study
from tests.web.browser import OpenPage, changed
from tests.web.visitor import Visitor


@pytest.fixture
def asked(study: Study) -> Study:
    """QUEST+ under the name that visitors know."""
    return changed(adaptive_study(study, "quest-plus"), name=study.name, practice={"trials": 1})


@pytest.fixture
def url(asked: Study, drawn_set: StimulusSet, store: Store) -> Iterator[str]:
    with running_server(create_app(asked, drawn_set, store)) as served:
        yield served


def test_each_reply_tells_the_next_trial_and_a_repeated_post_the_same(
    url: str, asked: Study, drawn_set: StimulusSet, store: Store
) -> None:
    with httpx.Client(base_url=url) as client:
        visitor = Visitor(client).begin()
        told = visitor.get().json()
        assert [trial["index"] for trial in told["trials"]] == [0]
        assert told["adaptive"]["limit"] == 1 + 3 * 12
        addresses = [picture["image"] for picture in told["adaptive"]["pictures"]]
        assert addresses == sorted(addresses)
        assert len(addresses) == len(set(addresses)) == 1 + 3 * 2 * 9
        assert visitor.answer(2).status_code == 422
        course = course_of(asked, drawn_set, Assignment(1))
        for index in range(8):
            first = visitor.answer(index, 1 + index % 3)
            again = visitor.answer(index, 1 + index % 3)
            assert first.status_code == 200, first.text
            assert again.json() == first.json()
            assert visitor.answer(index, 7).status_code == 409
            course.take(index, 1 + index % 3)
            assert first.json()["next"]["index"] == index + 1
            assert {*(p["image"] for p in first.json()["next"]["pictures"])} <= {*addresses}
        assert [tuple(row.stimuli) for row in store.responses()] == [
            trial.stimuli for trial in course.trials[:8]
        ]
        resumed = visitor.get().json()
        assert resumed["trials"][-1] == first.json()["next"]
        assert resumed["answered"] == list(range(8))
        assert visitor.post("/complete", {}).json()["missing"] == [8]
        event = {"kind": DECISION, "detail": {}}
        assert visitor.post("/events", event).status_code == 422
    logged = [event.detail["trial_index"] for event in store.events(kind=DECISION)]
    assert logged == list(range(1, 8))


def test_the_same_post_from_several_connections_is_one_answer(url: str, store: Store) -> None:
    """Also where the server has begun anew: what it knows of a session is what is stored."""
    with httpx.Client(base_url=url) as client:
        visitor = Visitor(client).begin()
        for index in range(3):
            with ThreadPoolExecutor(8) as pool:
                replies = list(pool.map(lambda _, i=index: visitor.answer(i), range(8)))
            assert len({json.dumps(reply.json()) for reply in replies}) == 1
    assert [row.trial_index for row in store.responses()] == [0, 1, 2]
    assert len(store.events(kind=DECISION)) == 2


def test_two_servers_lead_one_session(
    url: str, asked: Study, drawn_set: StimulusSet, store: Store
) -> None:
    """Answers go to one and the other by turns, as to several processes behind one address."""
    with (
        running_server(create_app(asked, drawn_set, store)) as other,
        httpx.Client(base_url=url) as client,
        httpx.Client(base_url=other) as another,
    ):
        visitor = Visitor(client).begin()
        beside = Visitor(another, visitor.begun)
        for index in range(6):
            here, there = (visitor, beside) if index % 2 else (beside, visitor)
            reply = here.answer(index)
            assert reply.status_code == 200, reply.text
            assert there.answer(index).json() == reply.json()
            assert there.answer(index, 7).status_code == 409
    assert [row.answer for row in store.responses()] == [3] * 6
    assert len(store.events(kind=DECISION)) == 5


@pytest.mark.parametrize("kind", ["staircase", "active-pairs"])
def test_observers_answer_alike_through_http_and_in_process(
    study: Study, drawn_set: StimulusSet, store: Store, kind: str
) -> None:
    adaptive, rows = adaptive_study(study, kind), []
    qualities = {str(level): level / 30 for level in range(0, 91, 10)}
    observer = ItemObserver(qualities, 0.3) if kind == "active-pairs" else Observer(40, 30)
    with running_server(create_app(adaptive, drawn_set, store)) as served:
        generator = np.random.default_rng(1)
        simulate_over_http(served, 2, observer, adaptive, drawn_set, generator, concurrency=1)
    rows.append(store.responses())
    with Store.open(f"{store.engine.url.database}.other") as other:
        simulate_in_process(adaptive, drawn_set, other, observer, 2, np.random.default_rng(1))
        rows.append(other.responses())
    one, another = (
        responses_frame(each).drop(columns=[*TIMING_COLUMNS, *DEVICE_COLUMNS]) for each in rows
    )
    assert one.equals(another)
    assert len(one) > 20


@pytest.mark.browser
def test_a_browser_waits_for_the_connection_and_goes_on_after_a_reload(
    open_page: OpenPage, study: Study, small_set: StimulusSet, store: Store
) -> None:
    """An answer without a connection is kept; the page waits, is reloaded, and nothing is lost."""
    brief = changed(
        adaptive_study(study, "staircase", staircase={"trials": 4}),
        timing={"blank_s": 0.05},
        screen={},
        demographics=[],
    )
    with open_page(brief, small_set) as participant:
        page = participant.page
        participant.arrive()
        participant.consent()
        participant.press("Begin")
        participant.wait_for_picture()
        assert participant.position == "Practice 1 of 1"
        page.keyboard.press("2")
        participant.press("Continue")
        page.get_by_text("Image 1, at most 4").wait_for()
        participant.wait_for_picture()
        cut_off = True

        def block(route: Route) -> None:
            if cut_off:
                route.abort()
            else:
                route.continue_()

        page.route("**/answers", block)
        page.keyboard.press("3")
        page.get_by_text("Waiting for the connection").wait_for()
        page.get_by_text("the study goes on as soon as it has been sent").wait_for()
        page.reload()
        page.get_by_text("Connecting").wait_for()
        cut_off = False
        page.get_by_text("You have answered 2 images, of at most 5").wait_for()
        participant.press("Go on")
        for number in (2, 3, 4):
            page.get_by_text(f"Image {number}, at most 4").wait_for()
            participant.wait_for_picture()
            page.keyboard.press(str(number))
        participant.code()
    assert [row.answer for row in store.responses()] == [2, 3, 2, 3, 4]
    held = load_collection(str(store.engine.url.database))
    replayed = replay_session(
        held.study, held.stimuli, held.sessions[0], held.responses, held.events
    )
    assert (replayed.trials, replayed.difference) == (5, None)
