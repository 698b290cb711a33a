"""Who may begin a study on the web: not when it is paused, and no more than are still needed."""

from datetime import UTC, datetime, timedelta
from typing import Literal

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from experiments.responses import iso, now
from experiments.storage import tables
from experiments.storage.database import reading, take_turns
from experiments.storage.store import Store
from experiments.study import Study

Closed = Literal["paused", "full", "busy"]
"""Why nobody may begin: by the researcher's word, for good, or until someone gives up."""


def closed(store: Store, study: Study) -> Closed | None:
    """Return why nobody may begin a study now, or None where they may.

    `full`: as many as wanted have completed it. `busy`: as many as that have completed it or are
    under way. Pilots, simulated sessions and those withdrawn are not counted.
    """
    with reading(store.engine).begin() as connection:
        return closed_in(connection, study)


def closed_in(connection: Connection, study: Study) -> Closed | None:
    """Return what `closed` does, within a transaction: in one that takes turns nobody slips in."""
    if connection.execute(_pause_of(study.name)).first() is not None:
        return "paused"
    wanted, columns = study.stopping.participants, tables.sessions.c
    people = sa.select(sa.func.count()).where(
        columns.study == study.name,
        columns.withdrawn_at.is_(None),
        columns.simulated.is_(False),
        columns.pilot.is_(False),
    )
    completed = people.where(columns.completed_at.is_not(None))
    complete = int(connection.execute(completed).scalar_one())
    if complete >= wanted:
        return "full"
    under_way = people.where(columns.completed_at.is_(None), _heard_of(study))
    return "busy" if complete + int(connection.execute(under_way).scalar_one()) >= wanted else None


def pause(store: Store, study: str) -> None:
    """Let nobody begin a study; those who have begun go on."""
    row = {"key": _key(study), "value": now()}
    with store.engine.begin() as connection:
        take_turns(connection)
        if connection.execute(_pause_of(study)).first() is None:
            connection.execute(tables.settings.insert().values(row))


def resume(store: Store, study: str) -> None:
    """Let people begin a study again."""
    with store.engine.begin() as connection:
        connection.execute(tables.settings.delete().where(tables.settings.c.key == _key(study)))


def paused_since(store: Store, study: str) -> str | None:
    """Return when a study was paused, ISO 8601 in UTC, or None while it is not."""
    with reading(store.engine).begin() as connection:
        return connection.scalar(_pause_of(study))


def _heard_of(study: Study) -> sa.ColumnElement[bool]:
    """Say in SQL that a session was begun, or had an answer, not too long ago."""
    silent_since = iso(datetime.now(UTC) - timedelta(seconds=study.stopping.abandoned_after_s))
    answers = tables.responses.c
    answered = sa.exists().where(
        answers.session == tables.sessions.c.id, answers.recorded_at > silent_since
    )
    return sa.or_(tables.sessions.c.started_at > silent_since, answered)


def _pause_of(study: str) -> sa.Select[str]:
    return sa.select(tables.settings.c.value).where(tables.settings.c.key == _key(study))


def _key(study: str) -> str:
    return f"paused.{study}"
