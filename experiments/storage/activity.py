"""How a study goes on: answers over time and timing quality, counted by the database."""

import sqlalchemy as sa

from experiments.storage import tables
from experiments.storage.database import reading
from experiments.storage.store import Store

_HOUR = len("2026-01-01T00")


def answers_by_hour(store: Store, study: str) -> list[tuple[str, int]]:
    """Return how many answers came in each hour in which one came, oldest first.

    Simulated answers and pilots' are not counted. An hour is its beginning in UTC, ISO 8601.
    """
    columns = tables.responses.c
    hour = sa.func.substr(columns.recorded_at, 1, _HOUR)
    query = (
        sa.select(hour, sa.func.count())
        .where(columns.study == study, columns.simulated.is_(False), columns.pilot.is_(False))
        .group_by(hour)
        .order_by(hour)
    )
    with reading(store.engine).begin() as connection:
        return [(f"{start}:00:00+00:00", int(count)) for start, count in connection.execute(query)]


def late_shares(store: Store, study: str) -> dict[str, float]:
    """Return by session the share of answers whose trial dropped a frame, where it is known."""
    columns = tables.responses.c
    late = sa.case((columns.dropped_frames > 0, 1.0), else_=0.0)
    query = (
        sa.select(columns.session, sa.func.avg(late))
        .where(columns.study == study, columns.dropped_frames.is_not(None))
        .group_by(columns.session)
    )
    with reading(store.engine).begin() as connection:
        return {session: float(share) for session, share in connection.execute(query)}
