"""The rows that a study leaves behind, identical in the lab, on the web and simulated."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

from experiments.planning.trials import Answer, Phase

if TYPE_CHECKING:
    import pandas as pd

# pandas takes a second to import: the functions that make a table do it.

Input = Literal["mouse", "touch", "keyboard", "none"]
Runner = Literal["web", "lab", "simulation"]

EXCLUSION: Final = "exclusion"
WITHDRAWAL: Final = "withdrawal"
POOL: Final = "pool"
DECISION: Final = "decision"
ESTIMATES: Final = "estimates"
RESERVED_KINDS: Final = (EXCLUSION, WITHDRAWAL, POOL, DECISION, ESTIMATES)
"""Kinds of event that no participant's browser may send: what the researcher or the participant did
to a session, and of adaptive designs what it was told when it began (`pool`), why each trial was
chosen (`decision`) and what the answers told in the end (`estimates`)."""

# What differs between two runs of the same trials with the same answers.
TIMING_COLUMNS = (
    "reaction_time_s",
    "onset_requested_s",
    "onset_measured_s",
    "frame_interval_s",
    "dropped_frames",
    "recorded_at",
)
DEVICE_COLUMNS = ("input", "device", "runner")


@dataclass(frozen=True)
class Response:
    """One answered trial; written once, never changed.

    Attributes
    ----------
    id
        Made by the client from session and trial (`response_id`), so that a repeated post is
        known for what it is.
    study, study_digest, stimuli_digest
        What was run, exactly.
    participant, session
        Who, and in which sitting.
    trial_index, phase
        Which trial.
    stimuli
        The ids of the stimuli in the order shown.
    answer
        As the task has it (`experiments.planning.trials.Answer`); None when the time limit passed.
    reaction_time_s
        From the measured onset to the answer.
    onset_requested_s, onset_measured_s
        When the stimulus was asked for and when its first frame was shown, on the runner's clock.
    frame_interval_s, dropped_frames
        The median interval between frames during the trial, and how many came late.
    input, device, runner
        How the answer was given, on what, and through which runner.
    simulated, pilot
        Whether a program answered, and whether the run is for trying the study out.
    recorded_at
        When the store took the row, ISO 8601 in UTC.
    """

    id: str
    study: str
    study_digest: str
    stimuli_digest: str
    participant: str
    session: str
    trial_index: int
    phase: Phase
    stimuli: tuple[str, ...]
    answer: Answer
    reaction_time_s: float | None
    onset_requested_s: float | None
    onset_measured_s: float | None
    frame_interval_s: float | None
    dropped_frames: int | None
    input: Input
    device: str
    runner: Runner
    simulated: bool
    pilot: bool
    recorded_at: str


@dataclass(frozen=True)
class Session:
    """One participant's run of a study.

    Attributes
    ----------
    id
        `study.participant.number`.
    study, study_digest, stimuli_digest
        What is run, exactly.
    participant, participant_number
        Who, and the number that fixes the order of the trials.
    consent_version
        The version of the text agreed to.
    demographics
        What the participant said of themself.
    screen
        Window and screen sizes, pixel ratio, refresh rate: what the runner can know.
    device, runner, simulated, pilot
        As in `Response`.
    started_at, completed_at
        ISO 8601 in UTC; `completed_at` is None until every trial has its answer.
    completion_code
        What the participant is given at the end.
    withdrawn_at
        When the participant withdrew, or None; of such a session nothing else is kept.
    """

    id: str
    study: str
    study_digest: str
    stimuli_digest: str
    participant: str
    participant_number: int
    consent_version: str
    demographics: Mapping[str, Any]
    screen: Mapping[str, Any]
    device: str
    runner: Runner
    simulated: bool
    pilot: bool
    started_at: str
    completed_at: str | None = None
    completion_code: str | None = None
    withdrawn_at: str | None = None


@dataclass(frozen=True)
class Event:
    """Something that happened to a session besides answers (focus lost, resize, resume, ...)."""

    session: str
    kind: str
    detail: Mapping[str, Any]
    recorded_at: str


def response_id(session: str, trial_index: int) -> str:
    """Return the id of a session's answer to a trial.

    >>> response_id("lights-synthetic.P0001.1", 7)
    'lights-synthetic.P0001.1.0007'
    """
    return f"{session}.{trial_index:04d}"


def now() -> str:
    """Return the time as the rows keep it."""
    return iso(datetime.now(UTC))


def iso(moment: datetime) -> str:
    """Return a moment in UTC as the rows keep it: ISO 8601, to the millisecond."""
    return moment.isoformat(timespec="milliseconds")


def responses_frame(responses: list[Response]) -> "pd.DataFrame":
    """Return one row a response, the columns in the order of `Response`."""
    import pandas as pd

    columns = [field.name for field in fields(Response)]
    return pd.DataFrame([vars(response) for response in responses], columns=columns)


def load_responses(path_or_url: str | Path, study: str | None = None) -> "pd.DataFrame":
    """Load all responses of a store, one row each.

    Parameters
    ----------
    path_or_url
        A SQLite file, or the SQLAlchemy URL of a database.
    study
        The name of the study whose responses are wanted, or None for all.

    Raises
    ------
    InputError
        If there is no such store.
    """
    from experiments.storage.store import Store  # the store imports the rows that it keeps

    with Store.open(path_or_url, must_exist=True) as store:
        return responses_frame(store.responses(study=study))
