"""The store in SQLite and in PostgreSQL alike, and stores of other schemas."""

import sqlite3
import subprocess
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sqlalchemy as sa
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory

from algorithms.errors import InputError
from experiments.answers import Measurement, make_response
from experiments.responses import POOL, Response, Session
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.database import SCHEMA, open_database
from experiments.storage.participation import exclude_session
from experiments.storage.pool import assignment_of, pool_of
from experiments.storage.store import ConflictError, NewSession, Store
from experiments.storage.tables import metadata
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.adaptive_studies import adaptive_study
from tests.postgres import Cluster, programs

SOMEBODY = NewSession(runner="web", device="a browser", demographics={"age": 30}, screen={})
MEASURED = Measurement(2.31, 10.01, 10.02, 0.0167, 0, "mouse")

# As the first Trompe made it, before there were revisions.
SCHEMA_1 = """
CREATE TABLE studies (study_digest VARCHAR NOT NULL, stimuli_digest VARCHAR NOT NULL,
    name VARCHAR NOT NULL, study JSON NOT NULL, manifest JSON NOT NULL,
    registered_at VARCHAR NOT NULL, PRIMARY KEY (study_digest, stimuli_digest));
CREATE TABLE sessions (id VARCHAR NOT NULL, study VARCHAR NOT NULL, study_digest VARCHAR NOT NULL,
    stimuli_digest VARCHAR NOT NULL, participant VARCHAR NOT NULL,
    participant_number INTEGER NOT NULL, consent_version VARCHAR NOT NULL,
    demographics JSON NOT NULL, screen JSON NOT NULL, device VARCHAR NOT NULL,
    runner VARCHAR NOT NULL, simulated BOOLEAN NOT NULL, pilot BOOLEAN NOT NULL,
    started_at VARCHAR NOT NULL, completed_at VARCHAR, completion_code VARCHAR,
    token_sha256 VARCHAR NOT NULL, PRIMARY KEY (id), UNIQUE (study, participant_number));
CREATE INDEX ix_sessions_study ON sessions (study);
CREATE TABLE responses (id VARCHAR NOT NULL, study VARCHAR NOT NULL, study_digest VARCHAR NOT NULL,
    stimuli_digest VARCHAR NOT NULL, participant VARCHAR NOT NULL, session VARCHAR NOT NULL,
    trial_index INTEGER NOT NULL, phase VARCHAR NOT NULL, stimuli JSON NOT NULL, answer JSON,
    reaction_time_s FLOAT, onset_requested_s FLOAT, onset_measured_s FLOAT, frame_interval_s FLOAT,
    dropped_frames INTEGER, input VARCHAR NOT NULL, device VARCHAR NOT NULL,
    runner VARCHAR NOT NULL, simulated BOOLEAN NOT NULL, pilot BOOLEAN NOT NULL,
    recorded_at VARCHAR NOT NULL, PRIMARY KEY (id), UNIQUE (session, trial_index),
    FOREIGN KEY(session) REFERENCES sessions (id));
CREATE INDEX ix_responses_study ON responses (study);
CREATE TABLE events (number INTEGER NOT NULL, session VARCHAR NOT NULL, kind VARCHAR NOT NULL,
    detail JSON NOT NULL, recorded_at VARCHAR NOT NULL, PRIMARY KEY (number),
    FOREIGN KEY(session) REFERENCES sessions (id));
CREATE TABLE settings ("key" VARCHAR NOT NULL, value VARCHAR NOT NULL, PRIMARY KEY ("key"));
CREATE TRIGGER responses_refuse_UPDATE BEFORE UPDATE ON responses
    BEGIN SELECT RAISE(ABORT, 'responses are never changed'); END;
CREATE TRIGGER responses_refuse_DELETE BEFORE DELETE ON responses
    BEGIN SELECT RAISE(ABORT, 'responses are never changed'); END;
INSERT INTO settings VALUES ('schema', '1'), ('researcher_token', 'kept');
INSERT INTO sessions VALUES ('a.P0001.1', 'a', 'd', 'd', 'P0001', 1, '1', '{"age": 30}', '{}',
    'a browser', 'web', 0, 0, '2026-01-01T00:00:00.000+00:00', NULL, NULL, 'hash');
INSERT INTO responses VALUES ('a.P0001.1.0000', 'a', 'd', 'd', 'P0001', 'a.P0001.1', 0, 'main',
    '["x"]', '3', 1.5, NULL, NULL, NULL, NULL, 'mouse', 'a browser', 'web', 0, 0,
    '2026-01-01T00:00:01.000+00:00');
"""


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """The file or URL of a store that is not there yet."""
    if request.param == "sqlite":
        return str(tmp_path / "responses.sqlite")
    return str(request.getfixturevalue("postgres_url"))


@pytest.fixture
def opened(database: str) -> Iterator[Store]:
    with Store.open(database) as store:
        yield store


@pytest.fixture
def session(opened: Store, study: Study, drawn_set: StimulusSet) -> Session:
    return opened.begin_session(study, drawn_set, SOMEBODY)[0]


@pytest.fixture
def responses(session: Session, study: Study, drawn_set: StimulusSet) -> list[Response]:
    return [
        make_response(study, drawn_set, session, index, index % 8 + 1, MEASURED)
        for index in range(40)
    ]


def test_a_new_store_is_as_the_queries_see_it(database: str) -> None:
    # Another implementation: alembic compares the database with the declared tables.
    engine = open_database(database, must_exist=False)
    with engine.connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), metadata) == []
    engine.dispose()
    scripts = ScriptDirectory(
        str(Path(__file__).parents[2] / "experiments" / "storage" / "migrations")
    )
    assert scripts.get_heads() == [SCHEMA]


def test_what_is_stored_comes_back(
    opened: Store, database: str, responses: list[Response], study: Study, drawn_set: StimulusSet
) -> None:
    opened.register(study, drawn_set)
    ranked = replace(responses[0], answer=(2, 1, 3))
    none = replace(responses[1], answer=None, reaction_time_s=None)
    stored = [ranked, none, *responses[2:]]
    assert [opened.record(response) for response in stored] == [True] * len(stored)
    with Store.open(database, must_exist=True) as again:
        assert again.responses() == stored
        assert again.sessions()[0].demographics == {"age": 30}
        assert again.registered()[0][0].digest == study.digest


def test_answers_that_come_together_are_each_told_their_own(
    opened: Store, responses: list[Response]
) -> None:
    # A repeated answer, another answer to the same trial, and one of no session, among good ones.
    opened.record(responses[0])
    other = replace(responses[1], answer=8)
    stranger = replace(responses[2], session="nobody", id="nobody.0002")
    handed_in = [responses[0], responses[1], other, stranger, *responses[3:], responses[5]]
    futures = [opened.submit(response) for response in handed_in]
    said: list[object] = [future.exception() or future.result() for future in futures]
    assert said[:2] == [False, True]
    assert isinstance(said[2], ConflictError)
    assert isinstance(said[3], sa.exc.IntegrityError)
    assert said[4:] == [True] * (len(responses) - 3) + [False]
    assert opened.responses() == [*responses[:2], *responses[3:]]


def test_an_answer_is_there_for_others_when_it_is_acknowledged(
    opened: Store, database: str, responses: list[Response]
) -> None:
    with Store.open(database) as other, ThreadPoolExecutor(8) as pool:

        def is_seen(response: Response) -> bool:
            opened.record(response)
            return response.trial_index in other.answers(response.session)

        assert all(pool.map(is_seen, responses))


def test_two_servers_share_a_store_without_losing_or_doubling(
    opened: Store, database: str, responses: list[Response], study: Study, drawn_set: StimulusSet
) -> None:
    with Store.open(database) as other, ThreadPoolExecutor(8) as pool:
        stores = [opened, other] * len(responses)
        twice = [response for response in responses for _ in range(2)]
        new = list(pool.map(lambda store, response: store.record(response), stores, twice))
        assert sum(new) == len(responses)
        begun = list(
            pool.map(lambda store: store.begin_session(study, drawn_set, SOMEBODY), stores[:16])
        )
        secrets = {store.setting("secret", lambda: "x") for store in stores}
    assert opened.responses() == responses
    assert sorted(one.participant_number for one, _ in begun) == list(range(2, 18))
    assert secrets == {"x"}


@pytest.mark.parametrize("change", ["UPDATE responses SET phase = 'main'", "DELETE FROM responses"])
def test_the_database_itself_refuses_to_change_answers(
    opened: Store, responses: list[Response], change: str
) -> None:
    opened.record(responses[0])
    with (
        pytest.raises(sa.exc.DBAPIError, match="responses are never changed"),
        opened.engine.begin() as connection,
    ):
        connection.exec_driver_sql(change)
    assert opened.responses() == responses[:1]


def test_postgresql_is_durable_before_a_commit_returns(postgres_url: str) -> None:
    engine = open_database(postgres_url, must_exist=False)
    with engine.connect() as connection:
        said = [
            connection.exec_driver_sql(f"SHOW {name}").scalar_one()
            for name in ("synchronous_commit", "fsync", "full_page_writes")
        ]
    engine.dispose()
    assert said == ["on", "on", "on"]


def test_a_postgresql_database_without_a_store_is_named_without_its_password(
    postgres_url: str,
) -> None:
    with pytest.raises(InputError, match="there is no response store"):
        Store.open(postgres_url, must_exist=True)
    with pytest.raises(InputError) as caught:
        Store.open("postgresql://someone:secret@127.0.0.1:9/none")
    assert "secret" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_postgresql_store_is_restored_from_a_dump_as_the_guide_says(
    cluster: Cluster, study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    url, restored = cluster.new_database(), cluster.new_database()
    folder, dump = programs(), tmp_path / "store.dump"
    assert folder is not None
    with Store.open(url) as store:
        session, _ = store.begin_session(study, drawn_set, SOMEBODY)
        answers = [make_response(study, drawn_set, session, n, 3, MEASURED) for n in range(10)]
        for response in answers:
            store.record(response)
        options = ["--format=custom", f"--file={dump}", url]
        subprocess.run([folder / "pg_dump", *options], check=True)
    subprocess.run([folder / "pg_restore", f"--dbname={restored}", dump], check=True)
    with Store.open(restored, must_exist=True) as again:
        assert again.responses() == answers
        with (
            pytest.raises(sa.exc.DBAPIError, match="responses are never changed"),
            again.engine.begin() as connection,
        ):
            connection.exec_driver_sql("DELETE FROM responses")


def test_a_store_of_the_first_schema_is_brought_up_to_date_with_all_it_holds(
    tmp_path: Path,
) -> None:
    path = tmp_path / "old.sqlite"
    with closing(sqlite3.connect(path)) as old:
        old.executescript(SCHEMA_1)
    with Store.open(path, must_exist=True) as store:
        (response,), (session,) = store.responses(), store.sessions()
        assert (response.answer, response.stimuli) == (3, ("x",))
        assert (session.participant, session.withdrawn_at) == ("P0001", None)
        assert store.setting("researcher_token", lambda: "lost") == "kept"
        with store.engine.connect() as connection:
            assert compare_metadata(MigrationContext.configure(connection), metadata) == []
    with closing(sqlite3.connect(path)) as now:
        # What the first Trompe looks at, and refuses in one line.
        found = now.execute("SELECT value FROM settings WHERE key = 'schema'").fetchall()
    assert found == [("2",)]


def test_a_store_of_a_newer_schema_is_refused_in_one_line(database: str) -> None:
    with Store.open(database) as store, store.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '99'")
    with pytest.raises(InputError, match="a store of schema 99, this Trompe reads up to 3"):
        Store.open(database)


def test_a_store_that_two_processes_make_at_once_is_made_once(database: str) -> None:
    with ThreadPoolExecutor(4) as pool:
        stores = list(pool.map(lambda _: Store.open(database), range(4)))
    for store in stores:
        assert store.sessions() == []
        store.close()


def test_a_session_is_told_what_others_of_its_kind_answered_before(
    opened: Store, study: Study, drawn_set: StimulusSet
) -> None:
    """On both databases: without excluded sessions, people apart from simulated ones."""
    asked = adaptive_study(study, "active-pairs")
    observer = ItemObserver({str(level): level / 30 for level in range(0, 91, 10)})
    generator = np.random.default_rng(1)
    first, _ = simulate_in_process(asked, drawn_set, opened, observer, 2, generator)
    rows = opened.responses(study=asked.name)
    exclude_session(opened, first.id, "asleep")
    simulate_in_process(asked, drawn_set, opened, observer, 1, generator)
    opened.begin_session(asked, drawn_set, SOMEBODY)
    pools = [
        assignment_of(session, opened.events(session=session.id, kind=POOL)).pool
        for session in sorted(opened.sessions(), key=lambda each: each.participant_number)
    ]
    of_first = pool_of(row for row in rows if row.session == first.id)
    assert pools == [(), of_first, pool_of(row for row in rows if row.session != first.id), ()]
    assert sum(count for _, _, count in pools[2]) == 12
