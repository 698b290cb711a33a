"""What somebody who means harm can ask for, and does not get."""

from pathlib import Path
from typing import Any

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from hypothesis.errors import Unsatisfiable
from schemathesis.core.result import Ok
from schemathesis.generation import GenerationMode

from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, researcher_token, running_server
from experiments.web.known_sessions import MOST_WRONG, WrongTokens
from experiments.web.pages import BUNDLE
from stimuli.manifest import StimulusSet
from tests.drawn_set import draw_set
from tests.web.visitor import STUDY, Visitor

OTHER_KINDS = ("withdrawal", "exclusion")
FEW = settings(
    max_examples=5,
    deadline=None,
    derandomize=True,
    database=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)


@pytest.fixture
def researcher(store: Store) -> dict[str, str]:
    return {"Authorization": f"Bearer {researcher_token(store)}"}


@pytest.mark.parametrize(
    ("method", "path", "message"),
    [
        ("GET", "", None),
        ("GET", "/images/{image}", None),
        ("GET", "/regions/{image}", None),
        ("POST", "/answers", "answer"),
        ("POST", "/events", {"kind": "blur"}),
        ("POST", "/complete", None),
        ("POST", "/withdrawal", None),
        ("POST", "/lease", {"page": "0" * 32}),
        ("POST", "/lease/end", {"page": "0" * 32}),
    ],
)
def test_nothing_of_another_participant_opens_or_changes(
    client: httpx.Client, store: Store, method: str, path: str, message: object
) -> None:
    mine, other = Visitor(client).begin(), Visitor(client).begin()
    other.answer(0)
    image = other.get().json()["trials"][0]["pictures"][0]["image"].rsplit("/", 1)[1]
    body: object = other.message(1) if message == "answer" else message
    address = f"/api/sessions/{other.session}{path.format(image=image)}"
    reply = client.request(method, address, json=body, headers=mine.headers)
    assert (reply.status_code, reply.json()["error"]["code"]) == (401, "unauthorized")
    assert store.answers(other.session) == {0: 3}
    assert store.events() == []
    # Nor under one's own name: neither the image, nor the trial.
    assert mine.get(f"/images/{image}").status_code == 404
    assert mine.post("/answers", other.message(1)).status_code == 403


@pytest.mark.parametrize("action", ["exclusion", "withdrawal"])
def test_only_the_researcher_excludes_and_withdraws_others(
    client: httpx.Client, store: Store, researcher: dict[str, str], action: str
) -> None:
    visitor = Visitor(client).begin()
    visitor.answer(0)
    base = f"/api/researcher/{STUDY}/sessions"
    body = {"reason": "why"} if action == "exclusion" else None
    for headers in ({}, visitor.headers):
        reply = client.post(f"{base}/{visitor.session}/{action}", json=body, headers=headers)
        assert reply.status_code == 401
    assert store.answers(visitor.session) == {0: 3}
    assert client.post(f"{base}/nobody/{action}", json=body, headers=researcher).status_code == 404
    reply = client.post(f"{base}/{visitor.session}/{action}", json=body, headers=researcher)
    assert reply.status_code == 204
    assert [event.kind for event in store.events()] == [action]
    if action == "withdrawal":
        assert store.responses() == []
        assert visitor.answer(1).status_code == 410
        assert visitor.get().status_code in (401, 410)


def test_who_withdraws_is_told_so_and_leaves_nothing(client: httpx.Client, store: Store) -> None:
    visitor = Visitor(client).begin()
    visitor.answer(0)
    assert visitor.post("/withdrawal", None).status_code == 204
    assert store.responses() == []
    for reply in (visitor.answer(1), visitor.get(), visitor.post("/events", {"kind": "blur"})):
        assert (reply.status_code, reply.json()["error"]["code"]) == (410, "withdrawn")
    assert [event.kind for event in store.events()] == ["withdrawal"]


@pytest.mark.parametrize("kind", OTHER_KINDS)
def test_no_browser_says_what_is_for_the_researcher_to_say(
    client: httpx.Client, store: Store, kind: str
) -> None:
    reply = Visitor(client).begin().post("/events", {"kind": kind, "detail": {"reason": "x"}})
    assert reply.status_code == 422
    assert store.events() == []


@pytest.mark.parametrize(
    "path",
    [
        "/assets/../../../pyproject.toml",
        "/assets/..%2f..%2f..%2f..%2fpyproject.toml",
        "/assets/%2e%2e/%2e%2e/store.py",
        "/assets//etc/passwd",
        "/assets/..%5c..%5cstore.py",
        f"/s/{STUDY}/../../etc/passwd",
        f"/api/researcher/{STUDY}/..%2f..%2fsettings.csv",
        f"/api/researcher/{STUDY}/settings.csv",
        f"/api/researcher/{STUDY}/sessions.sqlite",
    ],
)
def test_no_path_leads_out_of_what_is_served(
    client: httpx.Client, researcher: dict[str, str], path: str
) -> None:
    # Raw, since clients tidy paths up before they send them.
    url = httpx.URL(str(client.base_url)).copy_with(raw_path=path.encode())
    reply = client.get(url, headers=researcher, follow_redirects=True)
    assert reply.status_code in (404, 422)
    assert b"root:" not in reply.content
    assert b"[project]" not in reply.content


def test_images_named_by_path_are_not_found(client: httpx.Client) -> None:
    visitor = Visitor(client).begin()
    for name in ("0000.png", "..%2f0000.png", "%2e%2e%2fmanifest.json", "regions.png"):
        assert visitor.get(f"/images/{name}").status_code == 404


def test_a_replayed_post_changes_nothing(client: httpx.Client, store: Store) -> None:
    visitor = Visitor(client).begin()
    first = visitor.answer(0, 3)
    assert visitor.answer(0, 3, reaction_time_s=0.1).content == first.content
    assert visitor.answer(0, 4).status_code == 409
    (stored,) = store.responses()
    assert (stored.answer, stored.reaction_time_s) == (3, 2.31)


@pytest.mark.parametrize(
    "path", [f"/s/{STUDY}/", f"/researcher/{STUDY}/", f"/api/studies/{STUDY}", "/nowhere"]
)
def test_every_reply_carries_the_headers_for_safety(client: httpx.Client, path: str) -> None:
    headers = client.get(path).headers
    parts = headers["content-security-policy"].split(";")
    policy = dict(part.strip().split(" ", 1) for part in parts)
    assert policy["default-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    assert "unsafe" not in headers["content-security-policy"]
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["referrer-policy"] == "no-referrer"
    # Sessions need no cookies, so that none can be sent along by another site.
    assert "set-cookie" not in headers
    assert "server" not in headers


def test_pages_hold_no_script_of_their_own() -> None:
    pages = sorted(BUNDLE.glob("*.html"))
    for page in pages:
        for script in page.read_text().split("<script")[1:]:
            attributes, _, body = script.partition(">")
            assert "src=" in attributes
            assert body.startswith("</script>")


def test_guessing_tokens_is_slowed_down_but_not_those_who_are_known(
    client: httpx.Client, researcher: dict[str, str]
) -> None:
    known = Visitor(client).begin()
    assert known.answer(0).status_code == 200
    wrong = {"Authorization": "Bearer wrong"}
    path = f"/api/sessions/{known.session}"
    said = [client.get(path, headers=wrong).status_code for _ in range(MOST_WRONG + 5)]
    assert said == [401] * MOST_WRONG + [429] * 5
    reply = client.get(f"/api/researcher/{STUDY}", headers=researcher)
    assert (reply.status_code, reply.json()["error"]["code"]) == (429, "too-many")
    assert 1 <= int(reply.headers["retry-after"]) <= 60
    assert known.answer(1).status_code == 200


def test_wrong_tokens_are_forgotten_after_a_while_and_by_address() -> None:
    now = [0.0]
    tokens = WrongTokens(most=2, within_s=10, clock=lambda: now[0])
    for now[0] in (0.0, 4.0):
        assert tokens.wait_s("a") == 0
        tokens.add("a")
    assert (tokens.wait_s("a"), tokens.wait_s("b")) == (6, 0)
    now[0] = 10.0
    assert tokens.wait_s("a") == 0
    tokens.add("a")
    assert tokens.wait_s("a") == 4


def test_images_that_change_while_they_are_served_are_not_shown(
    study: Study, tmp_path: Path, store: Store
) -> None:
    stimuli = draw_set(tmp_path, levels_deg=(0, 90), placements=("front",))
    with (
        running_server(create_app(study, stimuli, store)) as url,
        httpx.Client(base_url=url) as client,
    ):
        visitor = Visitor(client).begin()
        pictures = [trial["pictures"][0] for trial in visitor.get().json()["trials"]]
        assert visitor.get(pictures[0]["image"]).status_code == 200
        for path in tmp_path.glob("0*.png"):
            path.write_bytes(path.read_bytes() + b"\0")
        reply = visitor.get(pictures[1]["image"])
        assert (reply.status_code, reply.json()["error"]["code"]) == (503, "unavailable")


def statuses_of(url: str, messages: st.SearchStrategy[Any]) -> set[int]:
    """Send some of the messages and return what the server answered."""
    said = set()

    @FEW
    @given(case=messages)
    def send(case: Any) -> None:  # noqa: ANN401  # generic in types that nobody names
        reply = case.call(base_url=url)
        assert reply.status_code < 500, (reply.status_code, reply.text)
        said.add(reply.status_code)

    send()
    return said


@pytest.mark.parametrize(
    ("mode", "known", "operations"),
    [
        (GenerationMode.POSITIVE, True, 19),
        (GenerationMode.POSITIVE, False, 19),
        (GenerationMode.NEGATIVE, True, 7),  # those whose messages can be wrong
    ],
)
def test_no_message_that_the_schema_allows_or_forbids_makes_the_server_fail(
    study: Study,
    drawn_set: StimulusSet,
    store: Store,
    mode: GenerationMode,
    known: bool,
    operations: int,
) -> None:
    # Another implementation: schemathesis draws messages from the API's own schema.
    app = create_app(study, drawn_set, store, pilot=True)  # which no pause closes
    schema = schemathesis.openapi.from_dict(app.openapi())
    statuses: dict[str, set[int]] = {}
    with running_server(app) as url, httpx.Client(base_url=url) as client:
        for result in schema.get_all_operations():
            assert isinstance(result, Ok)
            operation = result.ok()
            visitor = Visitor(client).begin()  # the last one may have withdrawn
            if "/researcher/" in operation.path:
                headers = {"Authorization": f"Bearer {researcher_token(store)}"}
            else:
                headers = visitor.headers
            every = {"study": STUDY, "session": visitor.session, "table": "events", "form": "csv"}
            mine = {name: at for name, at in every.items() if f"{{{name}}}" in operation.path}
            places = mine if known and "{opaque}" not in operation.path else None
            messages = operation.as_strategy(mode, headers=headers, path_parameters=places)
            try:
                statuses[operation.label] = statuses_of(url, messages)
            except Unsatisfiable:
                assert mode is GenerationMode.NEGATIVE
    assert len(statuses) >= operations
    assert set().union(*statuses.values()) & {200, 204, 404, 422}
