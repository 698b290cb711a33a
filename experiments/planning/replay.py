"""Replaying a session: whether what was shown follows from its answers, as it was logged."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from algorithms.errors import InputError
from experiments.planning.course import Course, course_of
from experiments.responses import DECISION, ESTIMATES, Event, Response, Session
from experiments.storage.pool import assignment_of
from experiments.study import Study
from stimuli.manifest import StimulusSet


@dataclass(frozen=True)
class Replay:
    """What came of replaying a session.

    Attributes
    ----------
    session
        Which.
    trials
        How many of its trials came out as they are stored, from the first on.
    difference
        What did not, or None.
    """

    session: str
    trials: int
    difference: str | None


def replay_session(
    study: Study,
    stimuli: StimulusSet,
    session: Session,
    responses: Iterable[Response],
    events: Sequence[Event],
) -> Replay:
    """Decide every trial of a session anew, and compare.

    Compared are the phase and the images of each stored trial, of adaptive designs why it was
    chosen, and of a complete session that nothing is missing and what the answers told in the end.

    Parameters
    ----------
    study, stimuli
        What was run.
    session
        Which session, begun with just these.
    responses, events
        What is stored of the study; those of other sessions are passed over.
    """
    own = sorted(
        (each for each in responses if each.session == session.id), key=lambda r: r.trial_index
    )
    logged = [event for event in events if event.session == session.id]
    decisions = {e.detail.get("trial_index"): e.detail for e in logged if e.kind == DECISION}
    course = course_of(study, stimuli, assignment_of(session, logged))
    for number, response in enumerate(own):
        difference = _difference(course, response, decisions.pop(response.trial_index, None))
        if difference is not None:
            return Replay(session.id, number, difference)
    estimates = [event.detail for event in logged if event.kind == ESTIMATES]
    return Replay(session.id, len(own), _difference_at_end(course, session, decisions, estimates))


def _difference(course: Course, response: Response, logged: object) -> str | None:
    """Compare a stored trial with the one that is decided, and lead the course on."""
    index = response.trial_index
    if index >= len(course.trials):
        return f"trial {index}: stored, but nothing that was answered before leads to it"
    trial = course.trials[index]
    if (trial.phase, trial.stimuli) != (response.phase, tuple(response.stimuli)):
        return (
            f"trial {index}: {', '.join(response.stimuli)} stored, {', '.join(trial.stimuli)}"
            " follows from the answers before it"
        )
    if _as_stored(course.decision(index)) != logged:
        return f"trial {index}: chosen for another reason than the one that is logged"
    try:
        course.take(index, response.answer)
    except InputError as error:
        return str(error)
    return None


def _difference_at_end(
    course: Course, session: Session, left: object, estimates: Sequence[object]
) -> str | None:
    if left:
        return "a decision is logged whose trial is not stored"
    if session.completed_at is None:
        return None
    if course.next is not None:
        return f"trial {course.next.index}: not stored, though the session is complete"
    if [_as_stored(each) for each in (course.estimates(),) if each is not None] != estimates:
        return "the answers tell other estimates than those that are logged"
    return None


def _as_stored(detail: object) -> Any:  # noqa: ANN401  # any JSON
    return json.loads(json.dumps(detail))
