"""How far a study has come."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from typing import Any

from experiments.planning.course import course_of
from experiments.planning.trials import Assignment
from experiments.responses import EXCLUSION, Session
from experiments.storage.activity import answers_by_hour, late_shares
from experiments.storage.admission import paused_since
from experiments.storage.participation import exclusion_reasons
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet


@dataclass(frozen=True)
class _Known:
    """What is known of a study's sessions besides themselves, by session."""

    answered: Mapping[str, tuple[int, str]]
    late_shares: Mapping[str, float]
    exclusions: Mapping[str, str]
    trials: int


def study_progress(store: Store, study: Study, stimuli: StimulusSet) -> dict[str, Any]:
    """Return counts of sessions and answers, people apart from simulated ones and pilots.

    `started`, `completed`, `dropped_out` (unfinished, and no answer for long), `excluded` and
    `withdrawn` count people's sessions that are no pilots; `answers` counts all,
    `answers_by_hour` those of people. Nothing tells what was answered.
    """
    sessions = store.sessions(study=study.name)
    answered = store.answer_counts(study.name)
    known = _Known(
        answered,
        late_shares(store, study.name),
        exclusion_reasons(store.events(study=study.name, kind=EXCLUSION)),
        _trial_count(study, stimuli),
    )
    people = [session for session in sessions if not session.simulated]
    kinds = {
        "": [session for session in people if not session.pilot],
        "simulated_": [session for session in sessions if session.simulated],
        "pilot_": [session for session in people if session.pilot],
    }
    return {
        "study": study.name,
        "title": study.title,
        "target": study.stopping.participants,
        "paused_since": paused_since(store, study.name),
        "abandoned_after_s": study.stopping.abandoned_after_s,
        **{f"{kind}started": len(members) for kind, members in kinds.items()},
        **{f"{kind}completed": _completed(members) for kind, members in kinds.items()},
        "dropped_out": sum(_dropped_out(study, session, answered) for session in kinds[""]),
        "excluded": sum(session.id in known.exclusions for session in kinds[""]),
        "withdrawn": sum(session.withdrawn_at is not None for session in kinds[""]),
        "answers_by_hour": answers_by_hour(store, study.name),
        "answers": sum(count for count, _ in answered.values()),
        "last_answer_at": max((last for _, last in answered.values()), default=None),
        "sessions": _rows(sessions, known),
    }


def _completed(sessions: list[Session]) -> int:
    return sum(one.completed_at is not None and one.withdrawn_at is None for one in sessions)


def _trial_count(study: Study, stimuli: StimulusSet) -> int:
    """Return how many trials a session has, or at most."""
    return course_of(study, stimuli, Assignment(participant_number=1)).limit


def _dropped_out(study: Study, session: Session, answered: Mapping[str, tuple[int, str]]) -> bool:
    if session.completed_at is not None or session.withdrawn_at is not None:
        return False
    _, last = answered.get(session.id, (0, session.started_at))
    silent = datetime.now(UTC) - datetime.fromisoformat(last)
    return silent > timedelta(seconds=study.stopping.abandoned_after_s)


def _rows(sessions: Iterable[Session], known: _Known) -> list[dict[str, Any]]:
    return [
        {
            "session": session.id,
            "participant": session.participant,
            "started_at": session.started_at,
            "answers": known.answered.get(session.id, (0, ""))[0],
            "of": known.trials,
            "late_share": known.late_shares.get(session.id),
            "completed_at": session.completed_at,
            "withdrawn_at": session.withdrawn_at,
            "exclusion": known.exclusions.get(session.id),
            "simulated": session.simulated,
            "pilot": session.pilot,
        }
        for session in sessions
    ]
