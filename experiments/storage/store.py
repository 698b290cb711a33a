"""The response store: append-only rows in SQLite or PostgreSQL, durable before acknowledged."""

import hashlib
import hmac
import re
import secrets
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Self

import sqlalchemy as sa
from sqlalchemy.engine import Connection, Engine

from algorithms.errors import InputError
from experiments.planning.designs import next_number, order_rows
from experiments.planning.trials import Answer
from experiments.responses import ESTIMATES, POOL, Event, Response, Runner, Session, now
from experiments.storage import tables
from experiments.storage.answer_writer import AnswerWriter, ConflictError, WithdrawnError
from experiments.storage.database import open_database, reading, take_turns
from experiments.storage.pool import collect_pool, needs_pool, pool_detail
from experiments.study import Study
from stimuli.manifest import StimulusSet

__all__ = ["ConflictError", "NewSession", "Store", "WithdrawnError", "check_participant"]

_PARTICIPANT = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")


@dataclass(frozen=True)
class NewSession:
    """What a runner knows of a participant when a session begins.

    `participant` and `participant_number` are given by the store where they are None.
    """

    runner: Runner
    device: str
    demographics: Mapping[str, Any]
    screen: Mapping[str, Any]
    simulated: bool = False
    pilot: bool = False
    participant: str | None = None
    participant_number: int | None = None


class Store:
    """The responses, sessions and events of one or more studies in one database.

    Open it with `Store.open`; it is a context manager and safe to use from several threads.
    """

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self._reading = reading(engine)
        self._writer = AnswerWriter(engine)

    @classmethod
    def open(cls, path_or_url: str | Path, *, must_exist: bool = False) -> Self:
        """Open a store, making it where it does not exist and bringing an older one up to date.

        Parameters
        ----------
        path_or_url
            A SQLite file, or the SQLAlchemy URL of a SQLite or PostgreSQL database.
        must_exist
            Refuse to make a new one.

        Raises
        ------
        InputError
            If it does not exist, cannot be opened, or is of a newer version.
        """
        return cls(open_database(path_or_url, must_exist=must_exist))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Store what is under way, and close every connection."""
        self._writer.close()
        self.engine.dispose()

    def setting(self, key: str, make: Callable[[], str]) -> str:
        """Return a stored setting, making it with `make()` the first time."""
        query = sa.select(tables.settings.c.value).where(tables.settings.c.key == key)
        with self._reading.begin() as connection:
            value = connection.execute(query).scalar_one_or_none()
        if value is not None:
            return str(value)
        with self.engine.begin() as connection:
            take_turns(connection)
            value = connection.execute(query).scalar_one_or_none()
            if value is None:
                value = make()
                connection.execute(tables.settings.insert().values(key=key, value=value))
            return str(value)

    def register(self, study: Study, stimuli: StimulusSet) -> None:
        """Keep the study and the manifest beside the answers, so that the store explains itself.

        Raises
        ------
        InputError
            If the store holds answers to another study of the same name and version.
        """
        row = {
            "study_digest": study.digest,
            "stimuli_digest": stimuli.digest,
            "name": study.name,
            "study": study.model_dump(mode="json"),
            "manifest": stimuli.model_dump(mode="json"),
            "registered_at": now(),
        }
        with self.engine.begin() as connection:
            take_turns(connection)
            known = connection.execute(
                sa.select(
                    tables.studies.c.study_digest,
                    tables.studies.c.stimuli_digest,
                    tables.studies.c.study,
                ).where(tables.studies.c.name == study.name)
            ).all()
            if (study.digest, stimuli.digest) in {
                (k.study_digest, k.stimuli_digest) for k in known
            }:
                return
            if any(k.study["version"] == study.version for k in known):
                raise InputError(
                    f"version: {study.name} version {study.version} is already in this store with"
                    " other contents; give the changed study a new version"
                )
            connection.execute(tables.studies.insert().values(row))

    def registered(self, name: str | None = None) -> list[tuple[Study, StimulusSet]]:
        """Return the registered studies with their sets (without folders), oldest first."""
        query = sa.select(tables.studies.c.study, tables.studies.c.manifest).order_by(
            tables.studies.c.registered_at
        )
        if name is not None:
            query = query.where(tables.studies.c.name == name)
        with self._reading.begin() as connection:
            return [
                (Study.model_validate(row.study), StimulusSet.model_validate(row.manifest))
                for row in connection.execute(query)
            ]

    def begin_session(
        self,
        study: Study,
        stimuli: StimulusSet,
        new: NewSession,
        *,
        token: str | None = None,
        admit: Callable[[Connection], None] = lambda _: None,
        on_begun: Callable[[Connection, Session], None] = lambda *_: None,
    ) -> tuple[Session, str]:
        """Open a session and return it with its secret token, which is kept only as a hash.

        Parameters
        ----------
        study, stimuli, new
            What is run, and who comes.
        token
            The token, where it is not drawn at random.
        admit
            Called first, while no other session can begin; what it raises is raised.
        on_begun
            Called with the new session, in the same transaction.

        Raises
        ------
        InputError
            If the participant or the number is taken.
        """
        token = token or secrets.token_urlsafe(24)
        with self.engine.begin() as connection:
            take_turns(connection)
            admit(connection)
            number = new.participant_number or _next_number(connection, study, stimuli)
            participant = check_participant(new.participant or f"P{number:04d}")
            session = Session(
                id=f"{study.name}.{participant}.1",
                study=study.name,
                study_digest=study.digest,
                stimuli_digest=stimuli.digest,
                participant=participant,
                participant_number=number,
                consent_version=study.consent.version,
                demographics=new.demographics,
                screen=new.screen,
                device=new.device,
                runner=new.runner,
                simulated=new.simulated,
                pilot=new.pilot,
                started_at=now(),
            )
            try:
                connection.execute(
                    tables.sessions.insert().values(**vars(session), token_sha256=_hash(token))
                )
            except sa.exc.IntegrityError:
                raise InputError(
                    f"participant: {participant} (number {number}) already has a session"
                ) from None
            if needs_pool(study):
                pool = pool_detail(collect_pool(connection, session))
                _add_event(connection, session.id, POOL, pool)
            on_begun(connection, session)
        return session, token

    def session(self, identifier: str) -> Session | None:
        """Return a session by its id, or None."""
        with self._reading.begin() as connection:
            row = connection.execute(
                sa.select(tables.sessions).where(tables.sessions.c.id == identifier)
            ).one_or_none()
        return None if row is None else _session_of(row)

    def authenticate(self, identifier: str, token: str) -> Session | None:
        """Return the session if the token is its own, else None."""
        query = sa.select(tables.sessions).where(tables.sessions.c.id == identifier)
        with self._reading.begin() as connection:
            row = connection.execute(query).one_or_none()
        if row is None or not hmac.compare_digest(row.token_sha256, _hash(token)):
            return None
        return _session_of(row)

    def record(self, response: Response, decision: Mapping[str, Any] | None = None) -> bool:
        """Store an answer for good; True if it is new, False if it was there already.

        With it is stored why its trial was chosen, where the design is adaptive.

        Raises
        ------
        ConflictError
            If another answer is stored for this trial.
        WithdrawnError
            If the participant has withdrawn.
        """
        return self._writer.submit(response, decision).result()

    def submit(
        self, response: Response, decision: Mapping[str, Any] | None = None
    ) -> "Future[bool]":
        """Begin to `record` an answer; the result comes once the answer is on the disk.

        Answers that wait at the same time share a commit, so that many can be stored a second.
        """
        return self._writer.submit(response, decision)

    def answers(self, session: str) -> dict[int, Answer]:
        """Return a session's stored answers by trial index."""
        query = sa.select(tables.responses.c.trial_index, tables.responses.c.answer).where(
            tables.responses.c.session == session
        )
        with self._reading.begin() as connection:
            return {row.trial_index: _plain(row.answer) for row in connection.execute(query)}

    def answer_counts(self, study: str) -> dict[str, tuple[int, str]]:
        """Return how many answers each session of a study has, and when the last one came."""
        columns = tables.responses.c
        query = (
            sa.select(columns.session, sa.func.count(), sa.func.max(columns.recorded_at))
            .where(columns.study == study)
            .group_by(columns.session)
        )
        with self._reading.begin() as connection:
            return {session: (n, last) for session, n, last in connection.execute(query)}

    def complete(self, session: str, estimates: Mapping[str, Any] | None = None) -> str:
        """Mark a session as complete and return its completion code; the same one ever after.

        With it is stored what the answers told in the end, where the design is adaptive.
        """
        with self.engine.begin() as connection:
            take_turns(connection)
            code = connection.execute(
                sa.select(tables.sessions.c.completion_code).where(tables.sessions.c.id == session)
            ).scalar_one()
            if code is None:
                code = secrets.token_hex(4).upper()
                connection.execute(
                    tables.sessions.update()
                    .where(tables.sessions.c.id == session)
                    .values(completed_at=now(), completion_code=code)
                )
                if estimates is not None:
                    _add_event(connection, session, ESTIMATES, estimates)
            return str(code)

    def add_event(self, session: str, kind: str, detail: Mapping[str, Any]) -> None:
        """Keep something that happened to a session."""
        with self.engine.begin() as connection:
            _add_event(connection, session, kind, detail)

    def responses(self, *, study: str | None = None) -> list[Response]:
        """Return all responses (of a study), in the order of session and trial."""
        query = sa.select(tables.responses).order_by(
            tables.responses.c.session, tables.responses.c.trial_index
        )
        if study is not None:
            query = query.where(tables.responses.c.study == study)
        with self._reading.begin() as connection:
            return [
                Response(**{name: _plain(value) for name, value in row._mapping.items()})
                for row in connection.execute(query)
            ]

    def sessions(self, *, study: str | None = None) -> list[Session]:
        """Return all sessions (of a study), in the order of their beginning."""
        query = sa.select(tables.sessions).order_by(
            tables.sessions.c.started_at, tables.sessions.c.id
        )
        if study is not None:
            query = query.where(tables.sessions.c.study == study)
        with self._reading.begin() as connection:
            return [_session_of(row) for row in connection.execute(query)]

    def events(
        self, *, study: str | None = None, session: str | None = None, kind: str | None = None
    ) -> list[Event]:
        """Return all events (of a study's sessions, a session, a kind), as they were recorded."""
        columns = tables.events.c
        query = sa.select(tables.events).order_by(columns.number)
        for column, wanted in ((columns.session, session), (columns.kind, kind)):
            if wanted is not None:
                query = query.where(column == wanted)
        if study is not None:
            query = query.join(tables.sessions).where(tables.sessions.c.study == study)
        with self._reading.begin() as connection:
            return [
                Event(row.session, row.kind, row.detail, row.recorded_at)
                for row in connection.execute(query)
            ]


def check_participant(participant: str) -> str:
    """Return a participant's name if it can stand in ids and file names.

    Raises
    ------
    InputError
        If it has other characters than letters, digits, `_` and `-`, or more than 64.
    """
    if not _PARTICIPANT.fullmatch(participant):
        raise InputError(
            f"participant: {participant!r} given; up to 64 letters, digits, '_' and '-' accepted"
        )
    return participant


def _next_number(connection: Connection, study: Study, stimuli: StimulusSet) -> int:
    columns, rows = tables.sessions.c, order_rows(study, stimuli)
    if rows == 1:
        query = sa.select(sa.func.max(columns.participant_number)).where(
            columns.study == study.name
        )
        return int(connection.execute(query).scalar_one_or_none() or 0) + 1
    every = sa.select(columns.participant_number, columns.completed_at).where(
        columns.study == study.name
    )
    taken = {number: bool(completed) for number, completed in connection.execute(every)}
    return next_number(taken, rows)


def _add_event(connection: Connection, session: str, kind: str, detail: Mapping[str, Any]) -> None:
    row = {"session": session, "kind": kind, "detail": dict(detail), "recorded_at": now()}
    connection.execute(tables.events.insert().values(row))


def _session_of(row: sa.Row[tuple[Any, ...]]) -> Session:
    return Session(**{field.name: getattr(row, field.name) for field in fields(Session)})


def _plain(value: Any) -> Any:  # noqa: ANN401  # any column
    """Return a column's value as the rows have it: JSON knows no tuples."""
    return tuple(value) if isinstance(value, list) else value


def _hash(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()
