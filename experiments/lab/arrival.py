"""Who takes part: said on the command line, filled into the form, or known from before."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from algorithms.errors import InputError
from experiments.demographics import check_demographics
from experiments.lab.form import PARTICIPANT, fields_for, fill_in
from experiments.lab.window import LabWindow
from experiments.responses import Session
from experiments.storage.store import Store, check_participant
from experiments.study import Study
from stimuli.manifest import StimulusSet


@dataclass(frozen=True)
class Entrant:
    """Who takes part.

    Attributes
    ----------
    participant
        Their name; None for one that the store gives.
    demographics
        What they said of themself, checked; nothing where an earlier session goes on.
    earlier
        Their unfinished session, or None.
    """

    participant: str | None
    demographics: Mapping[str, Any]
    earlier: Session | None


def known_entrant(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    participant: str | None,
    demographics: Mapping[str, Any] | None,
) -> Entrant | None:
    """Return who takes part, or None where the form must ask.

    Raises
    ------
    InputError
        If the participant has finished, or name or demographics are not accepted.
    """
    asks = demographics is None and (participant is None or study.demographics)
    if asks and unfinished_session(study, stimuli, store, participant) is None:
        return None
    return _entrant(study, stimuli, store, participant, demographics or {})


def ask_entrant(
    window: LabWindow, study: Study, stimuli: StimulusSet, store: Store, participant: str | None
) -> Entrant | None:
    """Ask in the window who takes part; return None if that is cancelled."""

    def accept(filled: dict[str, Any]) -> Entrant:
        name = filled.pop(PARTICIPANT, None)
        return _entrant(study, stimuli, store, name, filled)

    return fill_in(window, study, fields_for(study, participant), accept)


def _entrant(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    participant: str | None,
    said: Mapping[str, Any],
) -> Entrant:
    earlier = unfinished_session(study, stimuli, store, participant)
    return Entrant(participant, {} if earlier else check_demographics(study, said), earlier)


def unfinished_session(
    study: Study, stimuli: StimulusSet, store: Store, participant: str | None
) -> Session | None:
    """Return the session that a participant can take up again, or None for a new participant.

    Raises
    ------
    InputError
        If the participant has finished, or began with another runner, study version or stimuli,
        or is not a name that is accepted.
    """
    if participant is None:
        return None
    check_participant(participant)
    sessions = store.sessions(study=study.name)
    session = next((each for each in sessions if each.participant == participant), None)
    if session is None:
        return None
    if session.completed_at is not None:
        raise InputError(f"participant: {participant} has already finished {study.name}")
    if session.runner != "lab":
        raise InputError(f"participant: {participant} has begun {study.name} with another runner")
    if (session.study_digest, session.stimuli_digest) != (study.digest, stimuli.digest):
        raise InputError(
            f"participant: {participant} has begun {study.name} with another version of the study"
            " or its stimuli"
        )
    return session


def check_number(study: Study, store: Store, number: int | None) -> None:
    """Check that a new participant can have a number; None for the next one.

    Raises
    ------
    InputError
        If it is below 1 or another participant has it.
    """
    taken = {session.participant_number for session in store.sessions(study=study.name)}
    if number is not None and (number < 1 or number in taken):
        raise InputError(
            f"participant_number: {number} given; 1 or more and not taken by another participant"
            " accepted"
        )
