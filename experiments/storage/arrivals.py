"""How participants came to the web runner: each arrival has one session, however often it is told.

An arrival has a key that nobody else knows: the identifier that a recruitment service gave, or a
number that the browser drew. Who tells it again is given the session that it began.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from experiments.responses import Session
from experiments.storage import tables
from experiments.storage.database import reading
from experiments.storage.store import Store
from experiments.study import Study


@dataclass(frozen=True)
class Arrival:
    """How somebody came.

    Attributes
    ----------
    key
        What tells them from all others, within a study.
    parameters
        What of the address they came by is kept.
    """

    key: str
    parameters: Mapping[str, str] = field(default_factory=dict)


def add_arrival(connection: Connection, session: Session, arrival: Arrival) -> None:
    """Keep how the participant of a session came, in the transaction that begins it."""
    connection.execute(
        tables.arrivals.insert().values(
            session=session.id,
            study=session.study,
            key=arrival.key,
            parameters=dict(arrival.parameters),
        )
    )


def arrived(store: Store, study: str, key: str) -> Session | None:
    """Return the session that an arrival began, or None."""
    columns = tables.arrivals.c
    query = sa.select(columns.session).where(columns.study == study, columns.key == key)
    with reading(store.engine).begin() as connection:
        session = connection.execute(query).scalar_one_or_none()
    return None if session is None else store.session(session)


def parameters_of(store: Store, session: str) -> dict[str, str]:
    """Return the parameters that a session's participant came with."""
    query = sa.select(tables.arrivals.c.parameters).where(tables.arrivals.c.session == session)
    with reading(store.engine).begin() as connection:
        return dict(connection.execute(query).scalar_one_or_none() or {})


def exported_parameters(store: Store, studies: list[Study]) -> dict[str, dict[str, str]]:
    """Return, by session, the parameters of the studies that declare that they are exported."""
    names = [study.name for study in studies if study.recruitment.export]
    columns = tables.arrivals.c
    query = sa.select(columns.session, columns.parameters).where(columns.study.in_(names))
    with reading(store.engine).begin() as connection:
        return {session: dict(given) for session, given in connection.execute(query)}
