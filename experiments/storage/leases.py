"""Which page has a session open: one at a time, so that no session runs twice."""

import time
from collections.abc import Callable
from typing import Final

import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from experiments.storage import tables
from experiments.storage.store import Store

LEASE_S: Final = 45.0
"""How long a page that is not heard of keeps its session; pages renew it far more often."""

RELOAD_S: Final = 4.0
"""How long a page that has said goodbye still keeps it: it may have been reloaded."""


def renew_lease(
    store: Store, session: str, page: str, clock: Callable[[], float] = time.time
) -> bool:
    """Let a page have a session, from now on or still.

    Parameters
    ----------
    store, session
        The session.
    page
        The page's own name for itself.
    clock
        Seconds; the same for all processes that serve the store.

    Returns
    -------
    False if another page has it and was heard of within `LEASE_S`.
    """
    at_s, columns = clock(), tables.leases.c
    dialect = postgresql if store.engine.dialect.name == "postgresql" else sqlite
    insert = dialect.insert(tables.leases).values(session=session, page=page, renewed_s=at_s)
    statement = insert.on_conflict_do_update(
        index_elements=["session"],
        set_={"page": page, "renewed_s": at_s},
        where=sa.or_(columns.page == page, columns.renewed_s < at_s - LEASE_S),
    ).returning(columns.page)
    with store.engine.begin() as connection:
        return connection.execute(statement).first() is not None


def end_lease(
    store: Store, session: str, page: str, clock: Callable[[], float] = time.time
) -> None:
    """Let the next page have a session in `RELOAD_S`, if this one has it and does not come back."""
    columns = tables.leases.c
    soon = (
        tables.leases.update()
        .where(columns.session == session, columns.page == page)
        .values(renewed_s=clock() - LEASE_S + RELOAD_S)
    )
    with store.engine.begin() as connection:
        connection.execute(soon)
