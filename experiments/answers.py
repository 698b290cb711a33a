"""From what a participant did to the row that is stored."""

from dataclasses import dataclass

from algorithms.errors import InputError
from experiments.responses import Input, Response, Session, now, response_id
from experiments.study import Study
from experiments.trials import Answer, Assignment, planned_trials
from stimuli.manifest import StimulusSet


@dataclass(frozen=True)
class Measurement:
    """What a runner measures of one trial; the fields are those of `Response`."""

    reaction_time_s: float | None
    onset_requested_s: float | None
    onset_measured_s: float | None
    frame_interval_s: float | None
    dropped_frames: int | None
    input: Input


def make_response(
    study: Study,
    stimuli: StimulusSet,
    session: Session,
    trial_index: int,
    answer: Answer,
    measured: Measurement,
) -> Response:
    """Return the row of an answer, checked against the session's own list of trials.

    Parameters
    ----------
    study, stimuli, session
        What is run.
    trial_index, answer
        Which trial, and the label chosen (None: no answer in time).
    measured
        What the runner measured.

    Raises
    ------
    InputError
        If the session has no such trial, or the answer is not one of the choices.
    """
    trials = planned_trials(study, stimuli, Assignment(session.participant_number))
    if not 0 <= trial_index < len(trials):
        raise InputError(f"trial_index: {trial_index} given, 0 to {len(trials) - 1} accepted")
    choices = study.stimuli.choices
    if answer is None and study.timing.time_limit_s is None:
        raise InputError(f"answer: none given, 1 to {choices} accepted")
    if answer is not None and not 1 <= answer <= choices:
        raise InputError(f"answer: {answer} given, 1 to {choices} accepted")
    trial = trials[trial_index]
    return Response(
        id=response_id(session.id, trial_index),
        study=study.name,
        study_digest=session.study_digest,
        stimuli_digest=session.stimuli_digest,
        participant=session.participant,
        session=session.id,
        trial_index=trial_index,
        phase=trial.phase,
        stimuli=trial.stimuli,
        answer=answer,
        device=session.device,
        runner=session.runner,
        simulated=session.simulated,
        pilot=session.pilot,
        recorded_at=now(),
        **vars(measured),
    )
