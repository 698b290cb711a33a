"""What others have answered so far, as a session of active pairs is told when it begins."""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import Any, Final

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from experiments.planning.presentations import Assignment, Pool
from experiments.responses import EXCLUSION, POOL, Event, Response, Session
from experiments.storage import tables
from experiments.study import Study

_FIRST: Final = 1  # the answer that says the first of two images


def collect_pool(connection: Connection, session: Session) -> Pool:
    """Return the comparisons that were answered before a session begins.

    Only main trials of the same version of study and set, from sessions of the same kind (people,
    pilots or simulated) that nobody has excluded.
    """
    columns, sessions = tables.responses.c, tables.sessions.c
    excluded = sa.select(tables.events.c.session).where(tables.events.c.kind == EXCLUSION)
    shown, answer = sa.cast(columns.stimuli, sa.String), sa.cast(columns.answer, sa.String)
    query = (
        sa.select(shown, answer, sa.func.count())
        .join(tables.sessions, sessions.id == columns.session)
        .where(
            columns.study_digest == session.study_digest,
            columns.stimuli_digest == session.stimuli_digest,
            columns.simulated == session.simulated,
            columns.pilot == session.pilot,
            columns.phase == "main",
            columns.answer.is_not(None),
            columns.session.not_in(excluded),
        )
        .group_by(shown, answer)
    )
    return _pool(
        (json.loads(images), json.loads(chosen), count)
        for images, chosen, count in connection.execute(query)
    )


def pool_of(rows: Iterable[Response]) -> Pool:
    """Return the comparisons that these rows hold, as `collect_pool` does those of a store."""
    main = (row for row in rows if row.phase == "main" and row.answer is not None)
    return _pool((row.stimuli, row.answer, 1) for row in main)


def _pool(answers: Iterable[tuple[Sequence[str], object, int]]) -> Pool:
    wins: Counter[tuple[str, str]] = Counter()
    for (first, second), chosen, count in answers:
        wins[(first, second) if chosen == _FIRST else (second, first)] += count
    return tuple((better, worse, count) for (better, worse), count in sorted(wins.items()))


def needs_pool(study: Study) -> bool:
    """Return whether a study's sessions are told what others have answered."""
    return study.design.kind == "active-pairs"


def pool_detail(pool: Pool) -> dict[str, Any]:
    """Return a pool as its event keeps it."""
    return {"wins": [list(each) for each in pool]}


def assignment_of(session: Session, events: list[Event]) -> Assignment:
    """Return what a session was told when it began.

    Parameters
    ----------
    session
        Which.
    events
        Those of its study, or at least its own of kind `pool`.
    """
    pools = [e.detail["wins"] for e in events if e.session == session.id and e.kind == POOL]
    pool = tuple((str(one), str(other), int(n)) for one, other, n in (pools[0] if pools else ()))
    return Assignment(session.participant_number, pool)
