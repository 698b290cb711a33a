"""How far a study has come."""

from typing import Any

from experiments.responses import Session
from experiments.store import Store
from experiments.study import Study
from experiments.trials import Assignment, planned_trials
from stimuli.manifest import StimulusSet


def study_progress(store: Store, study: Study, stimuli: StimulusSet) -> dict[str, Any]:
    """Return counts of sessions and answers, people apart from simulated ones and pilots.

    `started` and `completed` count people's sessions that are no pilots; `answers` counts all.
    """
    sessions = store.sessions(study=study.name)
    answered = store.answer_counts(study.name)
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
        **{f"{kind}started": len(members) for kind, members in kinds.items()},
        **{f"{kind}completed": _completed(members) for kind, members in kinds.items()},
        "answers": sum(count for count, _ in answered.values()),
        "last_answer_at": max((last for _, last in answered.values()), default=None),
        "sessions": _rows(sessions, answered, _trial_count(study, stimuli)),
    }


def _completed(sessions: list[Session]) -> int:
    return sum(session.completed_at is not None for session in sessions)


def _trial_count(study: Study, stimuli: StimulusSet) -> int:
    return len(planned_trials(study, stimuli, Assignment(participant_number=1)))


def _rows(
    sessions: list[Session], answered: dict[str, tuple[int, str]], trial_count: int
) -> list[dict[str, Any]]:
    return [
        {
            "participant": session.participant,
            "started_at": session.started_at,
            "answers": answered.get(session.id, (0, ""))[0],
            "of": trial_count,
            "completed_at": session.completed_at,
            "simulated": session.simulated,
            "pilot": session.pilot,
        }
        for session in sessions
    ]
