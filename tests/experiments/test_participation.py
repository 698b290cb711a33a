"""Exclusion, withdrawal and backup: what stays, what goes, and that the analysis knows."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import sqlalchemy as sa
from typer.testing import CliRunner

from algorithms.errors import InputError
from analysis.answers.exclusions import apply_rule
from analysis.answers.trials import trial_table
from experiments.answers import Measurement, make_response
from experiments.cli import app
from experiments.exports.collection import load_collection, write_bundle
from experiments.responses import Response, Session, responses_frame
from experiments.storage.participation import exclude_session, exclusion_reasons, withdraw_session
from experiments.storage.store import NewSession, Store, WithdrawnError
from experiments.study import Study
from stimuli.manifest import StimulusSet

MEASURED = Measurement(2.31, 10.01, 10.02, 0.0167, 0, "mouse")
TELLTALE = "a browser nobody else has"
ANSWERS = 6


@pytest.fixture(params=["sqlite", "postgresql"])
def database(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    if request.param == "sqlite":
        return str(tmp_path / "responses.sqlite")
    return str(request.getfixturevalue("postgres_url"))


@pytest.fixture
def opened(database: str, study: Study, drawn_set: StimulusSet) -> Iterator[Store]:
    with Store.open(database) as store:
        store.register(study, drawn_set)
        yield store


def took_part(store: Store, study: Study, stimuli: StimulusSet) -> tuple[Session, list[Response]]:
    new = NewSession("web", TELLTALE, {"age": 47}, {"width_px": 1717})
    session, _ = store.begin_session(study, stimuli, new)
    made = [make_response(study, stimuli, session, n, 3, MEASURED) for n in range(ANSWERS)]
    for response in made:
        store.record(response)
    store.add_event(session.id, "resize", {"width_px": 1717})
    return session, made


def test_withdrawal_erases_the_answers_and_leaves_a_tombstone(
    opened: Store, study: Study, drawn_set: StimulusSet
) -> None:
    gone, answers = took_part(opened, study, drawn_set)
    stays, kept = took_part(opened, study, drawn_set)
    for _ in range(2):  # twice changes nothing
        withdraw_session(opened, gone.id)
    assert opened.responses() == kept
    assert [(e.session, e.kind) for e in opened.events()] == [
        (stays.id, "resize"),
        (gone.id, "withdrawal"),
    ]
    tombstone = opened.session(gone.id)
    assert tombstone is not None
    assert tombstone.withdrawn_at is not None
    assert (tombstone.demographics, tombstone.screen, tombstone.device) == ({}, {}, "")
    assert tombstone.participant_number == gone.participant_number
    with pytest.raises(WithdrawnError, match="withdrawn"):
        opened.record(answers[0])
    # The next participant gets a number of their own, not that of who withdrew.
    assert took_part(opened, study, drawn_set)[0].participant_number == 3


def test_no_byte_of_who_withdrew_is_left_in_the_file(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    with Store.open(tmp_path / "responses.sqlite") as store:
        session, _ = took_part(store, study, drawn_set)

        def content() -> bytes:
            return b"".join(path.read_bytes() for path in tmp_path.glob("responses.sqlite*"))

        assert TELLTALE.encode() in content()
        withdraw_session(store, session.id)
        assert TELLTALE.encode() not in content()
        assert b"1717" not in content()


def test_nobody_answers_in_the_moment_of_a_withdrawal(
    opened: Store, database: str, study: Study, drawn_set: StimulusSet
) -> None:
    # Property: whatever comes first, no answer of the session is there afterwards.
    session, _ = opened.begin_session(study, drawn_set, NewSession("web", "", {}, {}))
    answers = [make_response(study, drawn_set, session, n, 3, MEASURED) for n in range(60)]
    refused = threading.Event()

    def post() -> None:
        for response in answers:
            try:
                opened.record(response)
            except WithdrawnError:
                refused.set()

    poster = threading.Thread(target=post)
    poster.start()
    with Store.open(database) as other:
        withdraw_session(other, session.id)
    poster.join()
    assert opened.answers(session.id) == {}
    with pytest.raises(WithdrawnError):
        opened.record(answers[0])


def test_an_excluded_session_keeps_every_row_and_leaves_the_analysis(
    opened: Store, database: str, study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    (out, answers), (stays, kept) = (took_part(opened, study, drawn_set) for _ in range(2))
    told = CliRunner().invoke(app, ["exclude", database, out.id, "--reason", "spoke on the phone"])
    assert told.output == f"session {out.id}: excluded\n"
    assert opened.responses() == [*answers, *kept]
    assert exclusion_reasons(opened.events()) == {out.id: "spoke on the phone"}
    write_bundle(load_collection(database), tmp_path / "bundle")
    for source in (database, tmp_path / "bundle"):
        collected = load_collection(source)
        table = trial_table(responses_frame(list(collected.responses)), study, drawn_set)
        rule = study.exclusion.model_copy(update={"incomplete": False})
        left_out = apply_rule(rule, collected.sessions, table, collected.events)
        assert [(one.participant, one.reason) for one in left_out] == [
            (out.participant, "excluded by the researcher")
        ]
    assert stays.participant != out.participant


def test_what_cannot_be_done_is_refused_in_one_line(
    opened: Store, study: Study, drawn_set: StimulusSet
) -> None:
    session, _ = took_part(opened, study, drawn_set)
    with pytest.raises(InputError, match="session: 'nobody' is not in this store"):
        withdraw_session(opened, "nobody")
    with pytest.raises(InputError, match="session: 'nobody' is not in this store"):
        exclude_session(opened, "nobody", "why")
    for reason in ("", " ", "x" * 501):
        with pytest.raises(InputError, match="reason: 1 to 500 characters accepted"):
            exclude_session(opened, session.id, reason)
    withdraw_session(opened, session.id)
    with pytest.raises(InputError, match="was withdrawn"):
        exclude_session(opened, session.id, "late")


def test_the_database_lets_nobody_else_erase_or_change_events(
    opened: Store, study: Study, drawn_set: StimulusSet
) -> None:
    took_part(opened, study, drawn_set)
    for change in ("DELETE FROM events", "UPDATE events SET kind = 'x'"):
        with (
            pytest.raises(sa.exc.DBAPIError, match="events are never changed"),
            opened.engine.begin() as connection,
        ):
            connection.exec_driver_sql(change)


def test_a_backup_taken_while_answers_come_in_is_a_store_and_can_be_gone_on_with(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    path, copy = tmp_path / "responses.sqlite", tmp_path / "backups" / "copy.sqlite"
    with Store.open(path) as store:
        store.register(study, drawn_set)
        session, _ = store.begin_session(study, drawn_set, NewSession("web", "", {}, {}))
        answers = [make_response(study, drawn_set, session, n, 3, MEASURED) for n in range(60)]
        for response in answers[:20]:
            store.record(response)
        poster = threading.Thread(target=lambda: [store.record(each) for each in answers[20:]])
        poster.start()
        told = CliRunner().invoke(app, ["backup", str(path), str(copy)])
        poster.join()
        assert told.output == f"wrote {copy}\n"
        assert store.responses() == answers
    assert [file.name for file in copy.parent.iterdir()] == [copy.name]
    with Store.open(copy, must_exist=True) as restored:
        # Everything acknowledged before it began, and of what came meanwhile a whole beginning.
        found = restored.responses()
        assert found == answers[: len(found)]
        assert len(found) >= 20
        with restored.engine.connect() as connection:
            assert connection.exec_driver_sql("PRAGMA integrity_check").scalar() == "ok"
        for response in answers:
            restored.record(response)
        assert restored.responses() == answers
    with pytest.raises(InputError, match="is already there"):
        CliRunner().invoke(app, ["backup", str(path), str(copy)], catch_exceptions=False)
