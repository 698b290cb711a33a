import sqlite3
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import fields, replace
from pathlib import Path

import pytest
import sqlalchemy as sa

from algorithms.errors import InputError
from experiments.answers import Measurement, make_response
from experiments.responses import Response, Session, load_responses
from experiments.storage.database import open_database
from experiments.storage.store import ConflictError, NewSession, Store
from experiments.study import Study
from stimuli.manifest import StimulusSet

SOMEBODY = NewSession(runner="lab", device="a window", demographics={"age": 30}, screen={})
MEASURED = Measurement(2.31, 10.01, 10.02, 0.0167, 0, "mouse")


@pytest.fixture
def session(study: Study, drawn_set: StimulusSet, store: Store) -> Session:
    return store.begin_session(study, drawn_set, SOMEBODY)[0]


@pytest.fixture
def make(study: Study, drawn_set: StimulusSet, session: Session) -> Callable[[int, int], Response]:
    """Make the response of a trial and an answer."""
    return lambda index, answer: make_response(study, drawn_set, session, index, answer, MEASURED)


def test_sqlite_is_durable_before_a_commit_returns(tmp_path: Path) -> None:
    # SQLite's documentation: in WAL mode only synchronous=FULL survives a power cut.
    engine = open_database(tmp_path / "a.sqlite", must_exist=False)
    with engine.connect() as connection:
        pragmas = {
            name: connection.exec_driver_sql(f"PRAGMA {name}").scalar_one()
            for name in ("journal_mode", "synchronous", "foreign_keys")
        }
    engine.dispose()
    assert pragmas == {"journal_mode": "wal", "synchronous": 2, "foreign_keys": 1}


def test_a_response_comes_back_as_it_was_stored(
    store: Store, make: Callable[[int, int], Response]
) -> None:
    response = make(5, 3)
    assert store.record(response) is True
    assert store.responses() == [response]


def test_another_connection_sees_an_answer_once_it_is_recorded(
    store: Store, make: Callable[[int, int], Response], tmp_path: Path
) -> None:
    store.record(make(0, 3))
    with closing(sqlite3.connect(tmp_path / "responses.sqlite")) as other:
        assert other.execute("SELECT answer FROM responses").fetchall() == [(3,)]


def test_rows_are_written_once_and_never_changed(
    store: Store, make: Callable[[int, int], Response]
) -> None:
    first = make(0, 3)
    store.record(first)
    assert store.record(replace(first, reaction_time_s=99.0)) is False
    with pytest.raises(ConflictError, match="trial 0 already has another answer"):
        store.record(make(0, 4))
    assert store.responses() == [first]


@pytest.mark.parametrize("change", ["UPDATE responses SET answer = 1", "DELETE FROM responses"])
def test_the_database_itself_refuses_to_change_answers(
    store: Store, make: Callable[[int, int], Response], tmp_path: Path, change: str
) -> None:
    store.record(make(0, 3))
    with (
        closing(sqlite3.connect(tmp_path / "responses.sqlite")) as other,
        pytest.raises(sqlite3.IntegrityError, match="responses are never changed"),
    ):
        other.execute(change)
    assert store.answers(make(0, 3).session) == {0: 3}


def test_an_answer_without_a_session_is_refused(
    store: Store, make: Callable[[int, int], Response]
) -> None:
    with pytest.raises(sa.exc.IntegrityError):
        store.record(replace(make(0, 3), session="nobody", id="nobody.0000"))


def test_one_trial_has_one_row_whatever_its_id(
    store: Store, make: Callable[[int, int], Response]
) -> None:
    store.record(make(0, 3))
    with pytest.raises(ConflictError, match="trial 0 already has another answer"):
        store.record(replace(make(0, 3), id="another"))


def test_of_concurrent_posts_of_one_answer_one_is_new(
    store: Store, make: Callable[[int, int], Response]
) -> None:
    response, start = make(0, 3), threading.Barrier(8)

    def post(_: int) -> bool:
        start.wait()
        return store.record(response)

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(post, range(8))) == 1
    assert store.responses() == [response]


def test_of_concurrent_different_answers_one_stays_and_seven_conflict(
    store: Store, make: Callable[[int, int], Response]
) -> None:
    responses, start = [make(0, answer) for answer in range(1, 9)], threading.Barrier(8)

    def post(response: Response) -> bool:
        start.wait()
        try:
            return store.record(response)
        except ConflictError:
            return False

    with ThreadPoolExecutor(8) as pool:
        won = [r for r, new in zip(responses, pool.map(post, responses), strict=True) if new]
    assert store.responses() == won
    assert len(won) == 1


def test_concurrent_sessions_get_numbers_of_their_own(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    with ThreadPoolExecutor(8) as pool:
        begun = list(pool.map(lambda _: store.begin_session(study, drawn_set, SOMEBODY), range(16)))
    assert sorted(session.participant_number for session, _ in begun) == list(range(1, 17))
    assert len({token for _, token in begun}) == 16


def test_a_participant_or_number_is_taken_once(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    named = replace(SOMEBODY, participant="anna", participant_number=5)
    store.begin_session(study, drawn_set, named)
    for again in (named, replace(named, participant="berta"), replace(named, participant_number=6)):
        with pytest.raises(InputError, match="already has a session"):
            store.begin_session(study, drawn_set, again)
    assert store.begin_session(study, drawn_set, SOMEBODY)[0].participant_number == 6


def test_only_its_token_opens_a_session_and_is_not_kept(
    study: Study, drawn_set: StimulusSet, store: Store, tmp_path: Path
) -> None:
    (mine, token), (other, _) = (store.begin_session(study, drawn_set, SOMEBODY) for _ in range(2))
    assert store.authenticate(mine.id, token) == mine
    assert store.authenticate(other.id, token) is None
    assert store.authenticate(mine.id, "") is None
    assert store.authenticate("nobody", token) is None
    files = [path.read_bytes() for path in tmp_path.glob("responses.sqlite*")]
    assert not any(token.encode() in content for content in files)


def test_answers_counts_and_frames_tell_the_same(
    store: Store,
    session: Session,
    study: Study,
    make: Callable[[int, int], Response],
    tmp_path: Path,
) -> None:
    stored = [make(index, answer) for index, answer in ((4, 2), (0, 8), (2, 1))]
    for response in stored:
        store.record(response)
    assert store.answers(session.id) == {0: 8, 2: 1, 4: 2}
    last = max(response.recorded_at for response in stored)
    assert store.answer_counts(study.name) == {session.id: (3, last)}
    assert store.answer_counts("another") == {}
    frame = load_responses(tmp_path / "responses.sqlite", study.name)
    assert list(frame.columns) == [field.name for field in fields(Response)]
    assert frame["trial_index"].tolist() == [0, 2, 4]
    assert load_responses(tmp_path / "responses.sqlite", "another").empty


def test_completion_codes_stay(store: Store, session: Session) -> None:
    code = store.complete(session.id)
    assert store.complete(session.id) == code
    found = store.session(session.id)
    assert found is not None
    assert (found.completion_code, found.completed_at is not None) == (code, True)


def test_settings_are_made_once(store: Store, tmp_path: Path) -> None:
    assert store.setting("secret", lambda: "first") == "first"
    assert store.setting("secret", lambda: "second") == "first"
    with Store.open(tmp_path / "responses.sqlite") as again:
        assert again.setting("secret", lambda: "third") == "first"


def test_studies_are_kept_with_their_stimuli(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    for _ in range(2):
        store.register(study, drawn_set)
    ((kept, stimuli),) = store.registered(study.name)
    assert (kept.digest, stimuli.digest) == (study.digest, drawn_set.digest)
    assert store.registered("another") == []


def test_a_changed_study_needs_a_new_version(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    store.register(study, drawn_set)
    changed = Study.model_validate({**study.model_dump(), "question": "Which one?"})
    with pytest.raises(InputError, match=r"version: .* give the changed study a new version"):
        store.register(changed, drawn_set)
    store.register(Study.model_validate({**changed.model_dump(), "version": 2}), drawn_set)
    assert [kept.version for kept, _ in store.registered(study.name)] == [1, 2]


def test_stores_that_cannot_be_opened_are_refused_in_one_line(tmp_path: Path) -> None:
    text = tmp_path / "notes.txt"
    text.write_text("no database " * 100)
    for path, message in (
        (tmp_path / "none.sqlite", "there is no response store"),
        (text, "cannot be used as a response store"),
        (tmp_path, "there is no response store"),
        ("mysql://localhost/x", "'mysql' given, a SQLite file or a postgresql:// URL accepted"),
        ("postgresql://127.0.0.1:9/x", "x: cannot be used as a response store"),
        ("a://b c", "neither a file nor a database URL|accepted"),
    ):
        with pytest.raises(InputError, match=message):
            Store.open(path, must_exist=True)
    with pytest.raises(InputError, match="cannot be used as a response store"):
        Store.open(tmp_path / "missing" / "a.sqlite")


@pytest.mark.parametrize(
    ("index", "answer", "message"),
    [
        (-1, 3, "trial_index: -1 given, 0 to"),
        (10_000, 3, "trial_index: 10000 given"),
        (0, 0, "answer: 0 given, 1 to 8"),
        (0, 9, "answer: 9 given, 1 to 8"),
        (0, None, "answer: none given, 1 to 8"),
    ],
)
def test_answers_that_fit_no_trial_are_refused(
    study: Study,
    drawn_set: StimulusSet,
    session: Session,
    index: int,
    answer: int | None,
    message: str,
) -> None:
    with pytest.raises(InputError, match=message):
        make_response(study, drawn_set, session, index, answer, MEASURED)
