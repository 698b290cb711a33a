"""From what a participant did to the row that is stored."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from algorithms.errors import InputError
from experiments.ordering import is_ranking
from experiments.planning.trials import Answer, Assignment, Trial, planned_trials
from experiments.responses import Input, Response, Session, now, response_id
from experiments.study import Study
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
        Which trial, and the answer (`experiments.planning.trials.Answer`; None: no answer in time).
    measured
        What the runner measured.

    Raises
    ------
    InputError
        If the session has no such trial, or the answer is not one of the choices.
    """
    trials = planned_trials(study, stimuli, Assignment(session.participant_number))
    return response_in(trials, study, session, trial_index, answer, measured)


def response_in(
    trials: Sequence[Trial],
    study: Study,
    session: Session,
    trial_index: int,
    answer: Answer,
    measured: Measurement,
) -> Response:
    """Return the row of an answer as `make_response` does, of trials that are known already."""
    if not 0 <= trial_index < len(trials):
        raise InputError(f"trial_index: {trial_index} given, 0 to {len(trials) - 1} accepted")
    trial = trials[trial_index]
    asked = study.task != "free-viewing"
    if asked and answer is None and study.timing.time_limit_s is None:
        raise InputError(f"answer: none given, {accepted_answers(study, trial)} accepted")
    if answer is not None and not is_possible(study, trial, answer):
        raise InputError(f"answer: {answer} given, {accepted_answers(study, trial)} accepted")
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


def is_possible(study: Study, trial: Trial, answer: Answer) -> bool:
    """Return whether an answer is one that the trial's task allows."""
    if study.task == "ranking":
        if not isinstance(answer, tuple) or len(answer) != len(trial.stimuli):
            return False
        return is_ranking(answer, ties=study.answers.ties)
    if study.task == "free-viewing":
        return False
    if study.task == "pick":
        return isinstance(answer, tuple) and _is_picked(study, answer)
    lowest, highest = _bounds(study)
    return isinstance(answer, int) and lowest <= answer <= highest


def accepted_answers(study: Study, trial: Trial) -> str:
    """Say in words which answers a trial's task allows.

    The words fit the sentence `... given, 1 to 8 accepted`.
    """
    if study.task == "ranking":
        once = "ties by the best rank they share" if study.answers.ties else "each once"
        return f"the ranks 1 to {len(trial.stimuli)}, {once},"
    if study.task == "free-viewing":
        return "none"
    lowest, highest = _bounds(study)
    if study.task == "pick":
        return f"{' to '.join(map(str, _picks(study)))} labels from {lowest} to {highest}, rising,"
    return f"{lowest} to {highest}"


def _is_picked(study: Study, answer: tuple[int, ...]) -> bool:
    lowest, highest = _bounds(study)
    least, most = _picks(study)
    rising = all(before < after for before, after in pairwise(answer))
    within = all(lowest <= label <= highest for label in answer)
    return least <= len(answer) <= most and rising and within


def _picks(study: Study) -> tuple[int, int]:
    assert study.answers.picks is not None  # the study has seen to it
    return study.answers.picks


def _bounds(study: Study) -> tuple[int, int]:
    if study.task == "yes-no":
        return 0, 1
    return 1, study.stimuli.choices or 2
