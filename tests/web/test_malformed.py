"""Whatever is posted, the server answers with one line, and never fails."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.guard import MAX_BODY_BYTES
from stimuli.manifest import StimulusSet
from tests.web.visitor import STUDY, Visitor, consent

MANY = settings(max_examples=150, suppress_health_check=[HealthCheck.too_slow])

# JSON as the most hostile client may send it: lone surrogates, huge numbers, NaN.
scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.sampled_from([2**63, -(2**63) - 1, 10**400, 0, -1])
    | st.floats()
    | st.text(st.characters(codec=None), max_size=20)
)
values = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.text(st.characters(codec=None), max_size=8), inner, max_size=3)
    ),
    max_leaves=8,
)


@pytest.fixture(scope="module")
def opened(
    study: Study, drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[Visitor, Store]]:
    """A participant and the store, shared: refused posts leave nothing behind."""
    path: Path = tmp_path_factory.mktemp("malformed") / "responses.sqlite"
    with (
        Store.open(path) as store,
        running_server(create_app(study, drawn_set, store)) as url,
        httpx.Client(base_url=url) as client,
    ):
        yield Visitor(client).begin(), store


def mutated(message: dict[str, Any], key: str, value: object, drop: bool) -> dict[str, Any]:
    """Return a message with one key changed, added or left out."""
    changed = {**message, key: value}
    if drop:
        del changed[key]
    return changed


def assert_refused_or_stored(reply: httpx.Response, *accepted: int) -> None:
    if reply.status_code in accepted:
        return
    assert 400 <= reply.status_code < 500, reply.text
    error = reply.json()["error"]
    assert sorted(error) == ["code", "message"]
    assert "\n" not in error["message"]


def post(visitor: Visitor, path: str, message: object) -> httpx.Response:
    headers = {**visitor.headers, "Content-Type": "application/json"}
    return visitor.client.post(path, content=json.dumps(message), headers=headers)


ANSWER_KEYS = (
    "id",
    "trial_index",
    "answer",
    "reaction_time_s",
    "onset_requested_s",
    "onset_measured_s",
    "frame_interval_s",
    "dropped_frames",
    "input",
)


@MANY
@given(key=st.sampled_from(ANSWER_KEYS) | st.text(max_size=5), value=values, drop=st.booleans())
def test_a_mutated_answer_is_refused_or_stored_whole(
    opened: tuple[Visitor, Store], key: str, value: object, drop: bool
) -> None:
    visitor, store = opened
    message = mutated(visitor.message(1), key, value, drop)
    before = len(store.responses())
    reply = post(visitor, f"/api/sessions/{visitor.session}/answers", message)
    assert_refused_or_stored(reply, 200)
    stored = {row.trial_index: row for row in store.responses()}
    assert len(stored) - before in ((0, 1) if reply.status_code == 200 else (0,))
    if reply.status_code == 200:
        assert stored[message["trial_index"]].answer == message["answer"]


@MANY
@given(
    key=st.sampled_from(["consent_version", "demographics", "screen", "device", "simulated"])
    | st.text(max_size=5),
    value=values,
    drop=st.booleans(),
)
def test_a_mutated_consent_opens_no_session_or_a_whole_one(
    opened: tuple[Visitor, Store], key: str, value: object, drop: bool
) -> None:
    visitor, store = opened
    before = len(store.sessions())
    message = mutated(consent(simulated=True), key, value, drop)
    reply = post(visitor, f"/api/studies/{STUDY}/sessions", message)
    assert_refused_or_stored(reply, 201)
    assert len(store.sessions()) - before == (reply.status_code == 201)


@MANY
@given(kind=st.text(max_size=50) | values, detail=values)
def test_an_event_is_refused_or_stored(
    opened: tuple[Visitor, Store], kind: object, detail: object
) -> None:
    visitor, store = opened
    before = len(store.events())
    path = f"/api/sessions/{visitor.session}/events"
    reply = post(visitor, path, {"kind": kind, "detail": detail})
    assert_refused_or_stored(reply, 204)
    assert len(store.events()) - before == (reply.status_code == 204)


@MANY
@given(body=st.binary(max_size=200))
def test_bytes_that_are_no_answer_are_refused(opened: tuple[Visitor, Store], body: bytes) -> None:
    visitor, _ = opened
    headers = {**visitor.headers, "Content-Type": "application/json"}
    path = f"/api/sessions/{visitor.session}/answers"
    assert_refused_or_stored(visitor.client.post(path, content=body, headers=headers))


@pytest.mark.parametrize(
    "body",
    [
        b"[" * 60_000,
        b"9" * 60_000,
        b'{"id": ' * 8_000,
        b"\xff\xfe\x00",
        b'"' + b"\\ud800" * 9 + b'"',
    ],
    ids=["deep", "long number", "deep object", "no text", "surrogates"],
)
def test_json_that_parsers_choke_on_is_refused(opened: tuple[Visitor, Store], body: bytes) -> None:
    visitor, _ = opened
    headers = {**visitor.headers, "Content-Type": "application/json"}
    path = f"/api/sessions/{visitor.session}/answers"
    assert_refused_or_stored(visitor.client.post(path, content=body, headers=headers))


@pytest.mark.parametrize("announced", [True, False])
def test_an_oversized_post_is_refused_whatever_it_announces(
    opened: tuple[Visitor, Store], announced: bool
) -> None:
    visitor, store = opened
    before = store.responses()
    message = visitor.message(5, input="x" * MAX_BODY_BYTES)
    content = json.dumps(message).encode()
    chunks: Callable[[], Iterator[bytes]] = lambda: iter([content[:30_000], content[30_000:]])  # noqa: E731
    reply = visitor.client.post(
        f"/api/sessions/{visitor.session}/answers",
        content=content if announced else chunks(),
        headers={**visitor.headers, "Content-Type": "application/json"},
    )
    assert (reply.status_code, reply.json()["error"]["code"]) == (413, "too-large")
    assert store.responses() == before


@pytest.mark.parametrize(
    "path",
    [
        "/api/sessions/%00",
        "/api/sessions/%ED%A0%80/images/x",
        "/api/nothing",
        "/../../etc/passwd",
        "/assets/..%2f..%2fapp.py",
        "/openapi.json",
        "/docs",
    ],
)
def test_paths_that_lead_nowhere_have_the_one_error_shape(
    opened: tuple[Visitor, Store], path: str
) -> None:
    visitor, _ = opened
    reply = visitor.client.get(path, headers=visitor.headers)
    assert reply.status_code in (401, 404)
    assert_refused_or_stored(reply)


def test_a_method_that_is_not_offered_has_the_one_error_shape(
    opened: tuple[Visitor, Store],
) -> None:
    visitor, _ = opened
    reply = visitor.client.delete(f"/api/sessions/{visitor.session}", headers=visitor.headers)
    assert (reply.status_code, reply.json()["error"]["code"]) == (405, "method-not-allowed")
