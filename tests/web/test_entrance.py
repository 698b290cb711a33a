"""Who may begin, who comes back to their own session, and which page has it."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from datetime import timedelta

import httpx
import pytest
from typer.testing import CliRunner

from experiments.cli import app
from experiments.exports.export import table_bytes, table_rows
from experiments.responses import response_id
from experiments.storage.leases import LEASE_S, RELOAD_S, end_lease, renew_lease
from experiments.storage.participation import withdraw_session
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, create_site, researcher_token, running_server
from stimuli.manifest import StimulusSet
from tests.comparison_studies import comparison_study
from tests.drawn_set import draw_set
from tests.web.browser import changed
from tests.web.visitor import STUDY, Visitor, consent

LINK = {"PROLIFIC_PID": "5f1e", "SESSION_ID": "=s/1"}


@contextmanager
def client_of(
    study: Study, stimuli: StimulusSet, store: Store, *, pilot: bool = False
) -> Iterator[httpx.Client]:
    with (
        running_server(create_app(study, stimuli, store, pilot=pilot)) as url,
        httpx.Client(base_url=url) as client,
    ):
        yield client


def begin(client: httpx.Client, **message: object) -> httpx.Response:
    return client.post(f"/api/studies/{STUDY}/sessions", json=consent(**message))


def refusal(reply: httpx.Response) -> tuple[int, str]:
    return reply.status_code, str(reply.json()["error"]["code"])


def finish(visitor: Visitor) -> httpx.Response:
    for trial in visitor.get().json()["trials"]:
        assert visitor.answer(trial["index"]).status_code == 200
    return visitor.post("/complete", None)


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Three practice and two main images."""
    return draw_set(tmp_path_factory.mktemp("tiny"), levels_deg=(0,), placements=("front",))


@pytest.fixture
def recruited(study: Study) -> Study:
    address = "https://example.org/done?who={PROLIFIC_PID}&s={SESSION_ID}&cc={completion_code}"
    declared = {"parameters": list(LINK), "completion_url": address}
    return changed(study, recruitment=declared)


def test_no_more_begin_at_once_than_are_needed_and_who_gives_up_makes_room(
    study: Study, tiny: StimulusSet, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = changed(study, stopping={"participants": 3})
    with client_of(wanted, tiny, store) as client:
        with ThreadPoolExecutor(8) as pool:
            replies = list(pool.map(lambda _: begin(client), range(12)))
        assert sorted(reply.status_code for reply in replies) == [201] * 3 + [409] * 9
        assert {refusal(each) for each in replies if each.is_error} == {(409, "busy")}
        assert client.get(f"/api/studies/{STUDY}").json()["closed"] == "busy"
        first, second, _ = (
            Visitor(client, reply.json()) for reply in replies if not reply.is_error
        )
        assert finish(first).status_code == 200
        withdraw_session(store, second.session)
        assert begin(client).status_code == 201  # in the place of who withdrew
        assert refusal(begin(client)) == (409, "busy")
        Visitor(client).begin(simulated=True)
    # Nobody is heard of for as long as the study allows: their places are free, not their answers.
    with monkeypatch.context() as patched:
        patched.setattr("experiments.storage.admission.timedelta", lambda **_: timedelta(hours=-1))
        with client_of(wanted, tiny, store) as client:
            late = [Visitor(client).begin() for _ in range(2)]
    with client_of(wanted, tiny, store) as client:
        for visitor in late:
            visitor.client = client
            assert finish(visitor).status_code == 200
        assert refusal(begin(client)) == (409, "full")
    with client_of(wanted, tiny, store, pilot=True) as client:
        assert begin(client).status_code == 201


def test_a_paused_study_lets_nobody_begin_and_everybody_finish(
    study: Study, tiny: StimulusSet, store: Store
) -> None:
    headers = {"Authorization": f"Bearer {researcher_token(store)}"}
    with client_of(study, tiny, store) as client:
        visitor = Visitor(client).begin()
        path = f"/api/researcher/{STUDY}"
        assert client.post(f"{path}/pause").status_code == 401
        for _ in range(2):
            assert client.post(f"{path}/pause", headers=headers).status_code == 204
        assert client.get(path, headers=headers).json()["paused_since"] is not None
        assert client.get(f"/api/studies/{STUDY}").json()["closed"] == "paused"
        assert refusal(begin(client)) == (409, "paused")
        assert finish(visitor).status_code == 200
        data = str(store.engine.url.database)
        assert CliRunner().invoke(app, ["resume", data]).exit_code == 0
        assert begin(client).status_code == 201
        said = CliRunner().invoke(app, ["pause", data, "--study", STUDY])
        assert said.output == f"{STUDY}: paused; those who have begun can finish\n"
        assert refusal(begin(client)) == (409, "paused")
        assert client.post(f"{path}/resume", headers=headers).status_code == 204
        assert begin(client).status_code == 201


def test_a_recruited_participant_comes_back_to_their_own_session_and_leaves_by_the_address(
    recruited: Study, tiny: StimulusSet, store: Store
) -> None:
    with client_of(recruited, tiny, store) as client:
        assert refusal(begin(client)) == (422, "recruitment")
        assert refusal(begin(client, recruitment={**LINK, "OTHER": "1"})) == (422, "invalid")
        back = f"/api/studies/{STUDY}/return"
        assert client.post(back, json={"recruitment": LINK}).status_code == 404
        visitor = Visitor(client).begin(recruitment=LINK)
        assert Visitor(client).begin(recruitment=LINK).begun == visitor.begun
        again = client.post(back, json={"recruitment": {"PROLIFIC_PID": "5f1e"}})
        assert again.json() == visitor.begun
        assert client.post(back, json={"recruitment": {}}).status_code == 404
        # Nothing tells where to go before everything is there.
        assert visitor.get().json()["completion_url"] is None
        assert visitor.post("/complete", None).status_code == 409
        told = finish(visitor).json()
        code = told["completion_code"]
        address = f"https://example.org/done?who=5f1e&s=%3Ds%2F1&cc={code}"
        assert told["completion_url"] == visitor.get().json()["completion_url"] == address
        assert Visitor(client).begin(simulated=True).number == 2
    # What the study does not declare for export stays in the store.
    assert b"5f1e" not in table_bytes(store, "sessions", form="csv")
    assert "recruitment" not in table_rows(store, "sessions")[0]
    withdraw_session(store, visitor.session)
    with client_of(recruited, tiny, store) as client:
        assert client.post(back, json={"recruitment": LINK}).status_code == 404


def test_declared_parameters_are_exported_harmless(
    recruited: Study, tiny: StimulusSet, store: Store
) -> None:
    declared = changed(
        recruited, recruitment={**recruited.recruitment.model_dump(), "export": True}
    )
    with client_of(declared, tiny, store) as client:
        Visitor(client).begin(recruitment=LINK)
    table = table_bytes(store, "sessions", form="csv").decode().splitlines()
    row = dict(zip(table[0].split(","), table[1].split(","), strict=True))
    assert row["recruitment_PROLIFIC_PID"] == "5f1e"
    assert row["recruitment_SESSION_ID"] == "'=s/1"


def test_a_beginning_whose_reply_was_lost_is_posted_again(
    study: Study, tiny: StimulusSet, store: Store
) -> None:
    drawn = "0123456789abcdef0123456789abcdef"
    with client_of(study, tiny, store) as client:
        first, again = (Visitor(client).begin(arrival=drawn) for _ in range(2))
        assert first.begun == again.begun
        assert first.answer(0).status_code == 200
        assert refusal(begin(client, arrival="short")) == (422, "invalid")
    assert len(store.sessions()) == 1


def test_one_page_at_a_time_has_a_session(study: Study, tiny: StimulusSet, store: Store) -> None:
    pages = [{"page": letter * 32} for letter in "ab"]
    with client_of(study, tiny, store) as client:
        visitor = Visitor(client).begin()
        said = [visitor.post("/lease", page).status_code for page in (*pages, pages[0])]
        assert said == [204, 409, 204]
        assert refusal(visitor.post("/lease", pages[1])) == (409, "open-elsewhere")
        assert visitor.post("/lease/end", pages[1]).status_code == 204  # not its own to end
        assert visitor.post("/lease", pages[1]).status_code == 409
        assert visitor.post("/lease/end", pages[0]).status_code == 204
        # It may have been reloaded: it has some seconds to come back.
        said = [visitor.post("/lease", page).status_code for page in (pages[1], pages[0])]
        assert said == [409, 204]
    now = [0.0]
    session = Visitor(client, visitor.begun).session
    with Store.open(str(store.engine.url.database)) as other:
        now[0] = 1e12  # long after
        assert renew_lease(other, session, "c", lambda: now[0])
        now[0] += LEASE_S - 1
        assert not renew_lease(other, session, "d", lambda: now[0])
        now[0] += 2
        assert renew_lease(other, session, "d", lambda: now[0])
        end_lease(other, session, "d", lambda: now[0])
        now[0] += RELOAD_S + 1
        assert renew_lease(other, session, "e", lambda: now[0])


@pytest.mark.parametrize("rule", ["refuse", "flag"])
def test_a_screen_that_falls_short_is_refused_or_flagged(
    study: Study, tiny: StimulusSet, store: Store, rule: str
) -> None:
    wanted = {"minimum_width_px": 800, "color_gamut": "p3", "allow_zoom": False, "rule": rule}
    poor = {"window_width_px": 640, "color_gamut": "srgb", "zoom": 1.25}
    rich = {"window_width_px": 800, "color_gamut": "rec2020", "zoom": 1.02}
    with client_of(changed(study, screen=wanted), tiny, store) as client:
        reply = begin(client, screen=poor)
        assert (reply.status_code == 201) == (rule == "flag")
        for screen in (rich, {}):  # what a browser hides is not held against it
            assert begin(client, screen=screen).status_code == 201
    faults = [session.screen.get("faults") for session in store.sessions()]
    assert faults == [*(["window, gamut, zoom"] if rule == "flag" else []), None, None]


def test_studies_on_one_server_know_nothing_of_each_other(
    study: Study, tiny: StimulusSet, drawn_set: StimulusSet, store: Store
) -> None:
    pairs = changed(comparison_study(study, "two-alternative"), name="pairs")
    site = create_site([(study, tiny), (pairs, drawn_set)], store)
    with running_server(site) as url, httpx.Client(base_url=url) as client:
        mine = Visitor(client).begin()
        begun = client.post("/api/studies/pairs/sessions", json=consent()).json()
        other = Visitor(client, begun)
        assert (mine.number, other.number) == (1, 1)
        picture = other.get().json()["trials"][0]["pictures"][0]["image"]
        opaque = picture.rsplit("/", 1)[1]
        assert other.get(picture).status_code == 200
        assert mine.get(f"/images/{opaque}").status_code == 404
        assert client.get(picture, headers=mine.headers).status_code == 401
        mixed = {**other.message(0, 1), "id": response_id(mine.session, 0)}
        assert other.post("/answers", mixed).status_code == 403
        assert other.answer(0, 1).status_code == 200
        headers = {"Authorization": f"Bearer {researcher_token(store)}"}
        counts = {
            name: client.get(f"/api/researcher/{name}", headers=headers).json()["answers"]
            for name in (STUDY, "pairs")
        }
        assert counts == {STUDY: 0, "pairs": 1}
        path = f"/api/researcher/{STUDY}/sessions/{other.session}/withdrawal"
        assert client.post(path, headers=headers).status_code == 404
        assert client.get("/").status_code == 404
        assert client.get("/s/pairs/").status_code in (200, 503)
        assert client.get("/s/nothing/").status_code == 404
    sets = ["--stimuli", str(tiny.folder)] * 3
    with pytest.raises(ValueError, match="stimuli: given 3 times for 2 studies"):
        CliRunner().invoke(
            app, ["serve", STUDY, STUDY, *sets, "--data", "none"], catch_exceptions=False
        )
    with pytest.raises(ValueError, match=f"study: {STUDY} is given twice"):
        create_site([(study, tiny), (study, tiny)], store)
