"""Who no longer takes part: exclusion by the researcher, and withdrawal by the participant."""

from collections.abc import Iterable
from typing import Final

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from algorithms.errors import InputError
from experiments.responses import EXCLUSION, WITHDRAWAL, Event, now
from experiments.storage import tables
from experiments.storage.store import Store

_LONGEST_REASON: Final = 500


def exclude_session(store: Store, session: str, reason: str) -> None:
    """Leave a session out of the analysis, from now on; nothing of it is deleted.

    Parameters
    ----------
    store
        Where the session is.
    session
        Its id.
    reason
        Why, in words that may be published; a later reason stands beside the earlier one.

    Raises
    ------
    InputError
        If there is no such session, the reason is empty or too long, or the participant has
        withdrawn.
    """
    reason = reason.strip()
    if not 0 < len(reason) <= _LONGEST_REASON:
        raise InputError(f"reason: 1 to {_LONGEST_REASON} characters accepted")
    with store.engine.begin() as connection:
        if _lock(connection, session) is not None:
            raise InputError(f"session: {session} was withdrawn, there is nothing to exclude")
        _add_event(connection, session, EXCLUSION, reason=reason)


def withdraw_session(store: Store, session: str) -> None:
    """Erase a participant's answers, events and all that is known of them; a tombstone stays.

    What stays: that there was a session, its number, when it was begun, completed and withdrawn,
    and why it was excluded, if it was. Withdrawing twice changes nothing. Files that the lab
    runner wrote beside the store are not touched.

    Raises
    ------
    InputError
        If there is no such session.
    """
    with store.engine.begin() as connection:
        if _lock(connection, session) is not None:
            return
        # First the tombstone: only of someone who withdrew does the database let rows be erased.
        connection.execute(
            tables.sessions.update()
            .where(tables.sessions.c.id == session)
            .values(withdrawn_at=now(), demographics={}, screen={}, device="", token_sha256="")
        )
        connection.execute(tables.responses.delete().where(tables.responses.c.session == session))
        columns = tables.events.c
        connection.execute(
            tables.events.delete().where(columns.session == session, columns.kind != EXCLUSION)
        )
        for table in (tables.arrivals, tables.leases):
            connection.execute(table.delete().where(table.c.session == session))
        _add_event(connection, session, WITHDRAWAL)
    if store.engine.dialect.name == "sqlite":
        # The write-ahead log still holds the pages as they were.
        with store.engine.connect() as connection:
            driver = connection.connection.driver_connection
            assert driver is not None
            driver.execute("PRAGMA wal_checkpoint(TRUNCATE)")


def exclusion_reasons(events: Iterable[Event]) -> dict[str, str]:
    """Return why sessions were excluded by the researcher, by session; the last reason counts."""
    return {e.session: str(e.detail["reason"]) for e in events if e.kind == EXCLUSION}


def _lock(connection: Connection, session: str) -> str | None:
    """Let nobody answer in a session meanwhile; return when it was withdrawn, if it was."""
    query = sa.select(tables.sessions.c.withdrawn_at).where(tables.sessions.c.id == session)
    row = connection.execute(query.with_for_update()).one_or_none()
    if row is None:
        raise InputError(f"session: {session!r} is not in this store")
    return None if row.withdrawn_at is None else str(row.withdrawn_at)


def _add_event(connection: Connection, session: str, kind: str, **detail: str) -> None:
    row = {"session": session, "kind": kind, "detail": detail, "recorded_at": now()}
    connection.execute(tables.events.insert().values(row))
