"""Simulated answers for the analysis's tests: as rows, as sessions, and in a store."""

from typing import Any

import numpy as np
import pandas as pd

from experiments.responses import Response, Session
from experiments.simulated.observers import Observer, simulate_responses
from experiments.storage.store import NewSession, Store
from experiments.study import Study
from stimuli.manifest import StimulusSet

OBSERVER = Observer(threshold=25, width=30)


def rows_of(
    study: Study,
    stimuli: StimulusSet,
    participants: int,
    seed: int,
    observer: Observer = OBSERVER,
) -> pd.DataFrame:
    """Simulated rows."""
    generator = np.random.default_rng(seed)
    return simulate_responses(study, stimuli, observer, participants, generator)


def responses_of(rows: pd.DataFrame) -> list[Response]:
    """The rows as they come out of a store."""
    records = rows.astype(object).to_dict("records")
    return [Response(**{str(key): value for key, value in row.items()}) for row in records]


def sessions_of(rows: pd.DataFrame, **changes: object) -> list[Session]:
    """A finished session for each participant of some rows."""
    firsts = {response.session: response for response in reversed(responses_of(rows))}
    return [session_of(firsts[name], **changes) for name in sorted(firsts)]


def session_of(response: Response, **changes: object) -> Session:
    """The finished session that a response belongs to."""
    values: dict[str, Any] = {
        "participant_number": int(response.participant[1:]),
        "consent_version": "1",
        "demographics": {},
        "screen": {},
        "started_at": "2026-01-01T00:00:00.000+00:00",
        "completed_at": "2026-01-01T01:00:00.000+00:00",
    }
    shared = (
        "study",
        "study_digest",
        "stimuli_digest",
        "participant",
        "device",
        "runner",
        "simulated",
        "pilot",
    )
    values |= {"id": response.session} | {name: getattr(response, name) for name in shared}
    values.update(changes)
    return Session(**values)


def fill_store(
    store: Store, study: Study, stimuli: StimulusSet, rows: pd.DataFrame, *, finish: bool = True
) -> None:
    """Put rows into a store through its own doors."""
    store.register(study, stimuli)
    for _, own in rows.groupby("participant"):
        responses = responses_of(own)
        first = responses[0]
        session, _ = store.begin_session(
            study,
            stimuli,
            NewSession(
                runner=first.runner,
                device=first.device,
                demographics={"age": 30, "gender": "female", "artistic_background": True},
                screen={},
                simulated=first.simulated,
                pilot=first.pilot,
                participant=first.participant,
            ),
        )
        assert session.id == first.session
        for response in responses:
            store.record(response)
        if finish:
            store.complete(session.id)
