import csv
import io

import httpx
import pytest

from experiments.exports.export import safe_cell
from experiments.storage.store import NewSession, Store
from experiments.study import Study
from experiments.web import links, researcher_token
from stimuli.manifest import StimulusSet
from tests.web.visitor import STUDY, Visitor

PATHS = (f"/api/researcher/{STUDY}", f"/api/researcher/{STUDY}/responses.csv")


@pytest.fixture
def headers(store: Store) -> dict[str, str]:
    return {"Authorization": f"Bearer {researcher_token(store)}"}


@pytest.mark.parametrize("path", PATHS)
def test_only_the_researchers_token_opens(
    client: httpx.Client, visitor: Visitor, path: str
) -> None:
    for headers in ({}, {"Authorization": "Bearer wrong"}, visitor.headers):
        reply = client.get(path, headers=headers)
        assert (reply.status_code, reply.json()["error"]["code"]) == (401, "unauthorized")


def test_the_token_stays_and_stands_in_the_fragment_of_the_link(study: Study, store: Store) -> None:
    told = links("http://localhost:8000", study, store)
    address, _, fragment = told["researcher"].partition("#")
    assert fragment == researcher_token(store)
    assert fragment not in address
    assert researcher_token(store) not in told["participants"]


def test_counts_keep_people_simulations_and_pilots_apart(
    client: httpx.Client,
    headers: dict[str, str],
    study: Study,
    drawn_set: StimulusSet,
    store: Store,
) -> None:
    person, machine = Visitor(client).begin(), Visitor(client).begin(simulated=True)
    pilot = NewSession(runner="web", device="", demographics={}, screen={}, pilot=True)
    store.begin_session(study, drawn_set, pilot)
    for index in range(4):
        machine.answer(index)
    person.answer(0)
    store.complete(machine.session)
    told = client.get(PATHS[0], headers=headers).json()
    assert {key: told[key] for key in told if key.endswith(("started", "completed"))} == {
        "started": 1,
        "completed": 0,
        "simulated_started": 1,
        "simulated_completed": 1,
        "pilot_started": 1,
        "pilot_completed": 0,
    }
    assert told["target"] == study.stopping.participants
    assert told["answers"] == len(store.responses())
    assert told["last_answer_at"] == max(row.recorded_at for row in store.responses())
    rows = {row["participant"]: row for row in told["sessions"]}
    assert (rows["P0002"]["answers"], rows["P0002"]["simulated"]) == (4, True)
    assert rows["P0001"]["of"] == len(person.get().json()["trials"])


def test_drop_outs_exclusions_withdrawals_and_timing_are_told_and_no_answer(
    client: httpx.Client, headers: dict[str, str], store: Store
) -> None:
    visitors = [Visitor(client).begin() for _ in range(3)]
    for index in range(4):
        visitors[0].answer(index, dropped_frames=index % 2)
    visitors[1].answer(0)
    base = f"{PATHS[0]}/sessions"
    reason = {"reason": "spoke on the phone"}
    client.post(f"{base}/{visitors[0].session}/exclusion", json=reason, headers=headers)
    client.post(f"{base}/{visitors[1].session}/withdrawal", headers=headers)
    with store.engine.begin() as connection:
        connection.exec_driver_sql(
            "UPDATE sessions SET started_at = '2026-01-01T00:00:00.000+00:00'"
            " WHERE participant_number = 3"
        )
    told = client.get(PATHS[0], headers=headers).json()
    counts = {key: told[key] for key in ("started", "dropped_out", "excluded", "withdrawn")}
    assert counts == {"started": 3, "dropped_out": 1, "excluded": 1, "withdrawn": 1}
    rows = {row["participant"]: row for row in told["sessions"]}
    assert (rows["P0001"]["exclusion"], rows["P0001"]["late_share"]) == ("spoke on the phone", 0.5)
    assert rows["P0002"]["withdrawn_at"] is not None
    assert (rows["P0003"]["late_share"], rows["P0003"]["answers"]) == (None, 0)
    assert sum(count for _, count in told["answers_by_hour"]) == 4
    assert "answer" not in {key for row in told["sessions"] for key in row}


def test_the_table_holds_every_response_and_no_formula(
    client: httpx.Client, headers: dict[str, str], store: Store
) -> None:
    visitor = Visitor(client).begin(device='=HYPERLINK("http://example.org")')
    for index in range(3):
        visitor.answer(index)
    reply = client.get(PATHS[1], headers=headers)
    assert reply.headers["content-disposition"].startswith("attachment")
    rows = list(csv.DictReader(io.StringIO(reply.text)))
    stored = store.responses()
    assert [row["id"] for row in rows] == [row.id for row in stored]
    assert [float(row["reaction_time_s"]) for row in rows] == [
        row.reaction_time_s for row in stored
    ]
    assert [row["stimuli"] for row in rows] == [row.stimuli[0] for row in stored]
    assert all(row["device"].startswith("'=") for row in rows)


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t", "\r"])
def test_texts_that_look_like_formulas_are_defused_and_numbers_are_not(start: str) -> None:
    assert safe_cell(f"{start}1") == f"'{start}1"
    assert safe_cell((f"{start}1", "b")) == f"'{start}1;b"
    assert safe_cell(-1.5) == -1.5
    assert safe_cell("a=1") == "a=1"
    assert safe_cell(None) is None
