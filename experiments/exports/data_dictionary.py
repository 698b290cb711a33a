"""What every column of an exported table means: its type, its unit, its levels."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

from experiments.demographics import GENDERS

Kind = Literal["text", "number", "integer", "boolean", "time", "list", "answer"]


@dataclass(frozen=True)
class Column:
    """A column of an exported table.

    Attributes
    ----------
    name
        As in the table's head.
    kind
        Its type; `time` is ISO 8601 in UTC; `list` is several texts and `answer` one whole number
        or several, in CSV with semicolons between them.
    description
        What it says.
    unit
        Of numbers, or None.
    levels
        The values it can have, where they are few.
    """

    name: str
    kind: Kind
    description: str
    unit: str | None = None
    levels: tuple[str, ...] = ()


_WHO = (
    Column("study", "text", "the study's name"),
    Column("study_digest", "text", "SHA-256 of all that the study says"),
    Column("stimuli_digest", "text", "SHA-256 of the stimulus set's manifest"),
    Column("participant", "text", "who took part, by a code"),
)
_HOW = (
    Column("device", "text", "on what the answer was given, as far as it told"),
    Column("runner", "text", "through which runner", levels=("web", "lab", "simulation")),
    Column("simulated", "boolean", "whether a program answered in a person's place"),
    Column("pilot", "boolean", "whether the run only tried the study out"),
)
_RECORDED = Column("recorded_at", "time", "when the store took the row")
_SESSION = Column("session", "text", "in which sitting: the id of a row of the sessions")

_RESPONSES = (
    Column("id", "text", "session and trial; a repeated post has the same"),
    *_WHO,
    _SESSION,
    Column("trial_index", "integer", "which trial of the session, from 0"),
    Column(
        "phase",
        "text",
        "practice is never analysed; catch trials tell who pays attention",
        levels=("practice", "main", "catch"),
    ),
    Column("stimuli", "list", "the ids of the stimuli in the order shown"),
    Column(
        "answer",
        "answer",
        "by task: the label of the chosen object; the place of the chosen image from 1; 1 for yes"
        " and 0 for no; the rank of each image in the order shown, 1 = best; the labels of all"
        " chosen objects; empty: none in time",
    ),
    Column("reaction_time_s", "number", "from the measured onset to the answer", "s"),
    Column("onset_requested_s", "number", "when the image was asked for, runner's clock", "s"),
    Column("onset_measured_s", "number", "when its first frame was shown, runner's clock", "s"),
    Column("frame_interval_s", "number", "median interval between frames in the trial", "s"),
    Column("dropped_frames", "integer", "frames that came late in the trial"),
    Column("input", "text", "how it was given", levels=("mouse", "touch", "keyboard", "none")),
    *_HOW,
    _RECORDED,
)
_SESSIONS = (
    Column("id", "text", "study, participant and sitting"),
    *_WHO,
    Column("participant_number", "integer", "fixes the order of the trials"),
    Column("consent_version", "text", "the version of the text that was agreed to"),
    *_HOW,
    Column("started_at", "time", "when consent was given"),
    Column("completed_at", "time", "when every trial had its answer; empty: not yet"),
    Column("completion_code", "text", "what the participant was given at the end"),
    Column("withdrawn_at", "time", "when the participant withdrew and all answers were erased"),
    Column("exclusion_reason", "text", "why the researcher excluded the session; empty: did not"),
)
_EVENTS = (
    _SESSION,
    Column(
        "kind",
        "text",
        "what happened: blur, resize, resume, exclusion, withdrawal, gaze, pool, decision, ...",
    ),
    Column("detail", "text", "more of it, as JSON"),
    _RECORDED,
    Column("simulated", "boolean", "as in sessions"),
    Column("pilot", "boolean", "as in sessions"),
)

COLUMNS: Mapping[str, Mapping[str, Column]] = {
    table: {column.name: column for column in columns}
    for table, columns in (
        ("responses", _RESPONSES),
        ("sessions", _SESSIONS),
        ("events", _EVENTS),
    )
}

_SAID: Mapping[str, Column] = {
    "age": Column("demographics_age", "integer", "the participant's age, as said", "years"),
    "gender": Column("demographics_gender", "text", "as said", levels=GENDERS),
    "artistic_background": Column(
        "demographics_artistic_background", "boolean", "whether there is one, as said"
    ),
}

_SCREENS: Mapping[str, Column] = {
    column.name: column
    for column in (
        Column("screen_zoom", "number", "of the page, as far as the window's size tells"),
        Column("screen_color_gamut", "text", "the widest", levels=("srgb", "p3", "rec2020")),
        Column("screen_px_per_mm", "number", "CSS pixels, by a card held to the screen", "1/mm"),
        Column("screen_distance_mm", "number", "from the eye, by the blind spot", "mm"),
        Column("screen_faults", "text", "in what it falls short of what the study asks for"),
    )
}


def described(table: str, names: Iterable[str]) -> list[Column]:
    """Return the columns of a table as it was exported.

    Parameters
    ----------
    table
        `responses`, `sessions` or `events`.
    names
        The head of the table; `sessions` have columns `demographics_...`, `recruitment_...` and
        `screen_...` for what the study asked, what the participant's address told where the study
        declares that it is exported, and what the runner knew of the screen.
    """
    return [COLUMNS[table].get(name) or _of_session(name) for name in names]


def _of_session(name: str) -> Column:
    part, _, field = name.partition("_")
    if part == "demographics":
        return _SAID.get(field) or Column(name, "text", f"{field}, as said by the participant")
    if part == "recruitment":
        return Column(name, "text", f"{field} of the address that the participant came by")
    if name in _SCREENS:
        return _SCREENS[name]
    kind: Kind = "number" if field.endswith(("_px", "_hz", "_s", "ratio")) else "text"
    unit = {"px": "px", "hz": "Hz", "s": "s"}.get(field.rpartition("_")[2])
    return Column(name, kind, f"{field} of the screen or window, as the runner knew it", unit)
