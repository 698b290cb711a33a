"""Writing answers in groups: all that wait are made durable by one commit.

A commit waits for the disk, some milliseconds, whether it holds one answer or fifty. So one thread
takes every answer that came meanwhile, stores them in one transaction, and says so to those who
wait only after its commit.
"""

import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import Future
from queue import Empty, SimpleQueue
from typing import Any, Final, NamedTuple

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.engine import Connection, Engine

from algorithms.errors import InputError
from experiments.responses import DECISION, Response
from experiments.storage import tables

# A repeated post is the same answer if it agrees in these.
_IDENTITY: Final = ("participant", "session", "trial_index", "stimuli", "answer")
_LARGEST_GROUP: Final = 500

Detail = Mapping[str, Any]


class _Waiting(NamedTuple):
    """An answer that is to be stored, and why its trial was chosen."""

    response: Response
    decision: Detail | None
    future: "Future[bool]"


class ConflictError(InputError):
    """Another answer is already stored for this trial; the stored one stays."""


class WithdrawnError(InputError):
    """The participant has withdrawn: nothing more is stored of them."""


class AnswerWriter:
    """The one thread through which a store's answers go to its database.

    Parameters
    ----------
    engine
        The store's database.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._waiting: SimpleQueue[_Waiting | None] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._starting = threading.Lock()
        self._closed = False

    def submit(self, response: Response, decision: Detail | None = None) -> "Future[bool]":
        """Hand in an answer, and why its trial was chosen if answers before it decided that.

        Returns
        -------
        What is known once it is on the disk: True if the answer is new, False if it was there
        already. It ends in `ConflictError` if another answer is stored for this trial, and in
        `WithdrawnError` if the participant has withdrawn.
        """
        future: Future[bool] = Future()
        with self._starting:
            if self._closed:
                raise RuntimeError("the store is closed")
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="answers", daemon=True)
                self._thread.start()
            self._waiting.put(_Waiting(response, decision, future))
        return future

    def close(self) -> None:
        """Store what was handed in, and end the thread."""
        with self._starting:
            self._closed = True
            thread, self._thread = self._thread, None
        if thread is not None:
            self._waiting.put(None)
            thread.join()

    def _run(self) -> None:
        while (first := self._waiting.get()) is not None:
            group, last = self._with_others(first)
            self._store(group)
            if last:
                return

    def _with_others(self, first: _Waiting) -> tuple[list[_Waiting], bool]:
        """Return everything that waits, and whether nothing will come after it."""
        group = [first]
        while len(group) < _LARGEST_GROUP:
            try:
                another = self._waiting.get_nowait()
            except Empty:
                break
            if another is None:
                return group, True
            group.append(another)
        return group, False

    def _store(self, group: Sequence[_Waiting]) -> None:
        try:
            with self._engine.begin() as connection:
                outcomes = _insert(connection, [each.response for each in group])
                new = [
                    each for each, outcome in zip(group, outcomes, strict=True) if outcome is True
                ]
                _log_decisions(connection, new)
        except sa.exc.IntegrityError as error:
            # One answer that the database refuses must not take the others with it.
            if len(group) == 1:
                group[0].future.set_exception(_explained(error))
                return
            for each in group:
                self._store([each])
        except BaseException as error:  # whoever waits must hear of it
            for each in group:
                each.future.set_exception(error)
        else:
            for each, outcome in zip(group, outcomes, strict=True):
                if isinstance(outcome, ConflictError):
                    each.future.set_exception(outcome)
                else:
                    each.future.set_result(outcome)


def _insert(connection: Connection, group: Sequence[Response]) -> list[bool | ConflictError]:
    """Insert the answers that are new; say of each whether it was, or what it conflicts with."""
    first: dict[str, int] = {}
    for place, response in enumerate(group):
        first.setdefault(response.id, place)
    dialect = postgresql if connection.dialect.name == "postgresql" else sqlite
    # Whatever is unique: of two servers that insert one answer at once, PostgreSQL may find its
    # session and trial taken before its id.
    statement = (
        dialect.insert(tables.responses).on_conflict_do_nothing().returning(tables.responses.c.id)
    )
    rows = [_row(group[place]) for place in first.values()]
    new = {first[inserted] for inserted in connection.execute(statement, rows).scalars()}
    repeated = {response.id for place, response in enumerate(group) if place not in new}
    stored = _stored(connection, repeated) if repeated else {}
    return [
        True if place in new else _compared(response, stored.get(response.id))
        for place, response in enumerate(group)
    ]


def _log_decisions(connection: Connection, new: Sequence[_Waiting]) -> None:
    rows = [
        {
            "session": each.response.session,
            "kind": DECISION,
            "detail": dict(each.decision),
            "recorded_at": each.response.recorded_at,
        }
        for each in new
        if each.decision is not None
    ]
    if rows:
        connection.execute(tables.events.insert(), rows)


def _stored(connection: Connection, identifiers: set[str]) -> dict[str, Mapping[str, Any]]:
    query = sa.select(tables.responses).where(tables.responses.c.id.in_(identifiers))
    return {row["id"]: dict(row) for row in connection.execute(query).mappings()}


def _compared(response: Response, stored: Mapping[str, Any] | None) -> bool | ConflictError:
    given = _row(response)
    if stored is not None and all(
        _as_json(stored[key]) == _as_json(given[key]) for key in _IDENTITY
    ):
        return False
    return ConflictError(f"answer: trial {response.trial_index} already has another answer")


def _row(response: Response) -> dict[str, Any]:
    return vars(response) | {"stimuli": list(response.stimuli)}


def _as_json(value: object) -> object:
    """Return a value as JSON gives it back: without tuples."""
    return list(value) if isinstance(value, tuple) else value


def _explained(error: sa.exc.IntegrityError) -> Exception:
    if "the session was withdrawn" in str(error.orig):
        return WithdrawnError("session: withdrawn; nothing more is stored of it")
    return error
