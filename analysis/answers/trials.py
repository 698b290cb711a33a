"""Responses joined with what was shown: the table that every analysis starts from."""

import pandas as pd

from algorithms.errors import InputError
from experiments.study import Study, chosen
from stimuli.manifest import StimulusSet

_NEEDED = (
    "study",
    "participant",
    "session",
    "trial_index",
    "phase",
    "stimuli",
    "answer",
    "reaction_time_s",
    "dropped_frames",
    "simulated",
    "pilot",
)
KEPT = (
    "participant",
    "session",
    "trial_index",
    "reaction_time_s",
    "dropped_frames",
    "simulated",
    "pilot",
)


def trial_table(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Join the answers to a study's main trials with the factors and the right answers.

    Parameters
    ----------
    responses
        Rows with the columns of `experiments.responses.Response`.
    study
        The study; rows of practice trials are dropped.
    stimuli
        The set that was shown.

    Returns
    -------
    pandas.DataFrame
        One row a main trial: `participant`, `session`, `trial_index`, `stimulus`, `level` (float,
        in the study's unit), each factor under its own name, `control` (True where there is no
        right answer), `target` and `answer` (labels, missing where there is none), `correct`
        (missing for controls and where no answer was given), `reaction_time_s`, `dropped_frames`,
        `simulated`, `pilot`.

    Raises
    ------
    InputError
        If a column is missing, there are no rows, the study has no level, or a row belongs to
        another study, names an unknown stimulus, or has an impossible answer or time.
    """
    check_responses(responses, study)
    main = responses[responses["phase"] == "main"]
    if main.empty:
        raise InputError(f"responses: nothing to analyse yet, no main trial of {study.name}")
    table = main.loc[:, list(KEPT)].reset_index(drop=True)
    table["stimulus"] = [shown[0] for shown in main["stimuli"]]
    table["answer"] = _answers(main["answer"], study)
    table = table.merge(_factors(stimuli, study), on="stimulus", how="left", indicator="known")
    unknown = table.loc[table["known"] != "both", "stimulus"]
    if not unknown.empty:
        raise InputError(
            f"stimuli: {unknown.iloc[0]!r} was shown but is not in the set {stimuli.name}"
        )
    table["control"] = table["target"].isna()
    table["correct"] = table["answer"] == table["target"]
    return table.drop(columns="known")


def check_responses(responses: pd.DataFrame, study: Study) -> None:
    """Check that a table has the columns of responses, and rows of the study alone.

    Raises
    ------
    InputError
        If it has not, or a time is impossible.
    """
    missing = [name for name in _NEEDED if name not in responses.columns]
    if missing:
        raise InputError(f"responses: the column {missing[0]} is missing")
    if responses.empty:
        raise InputError("responses: nothing to analyse yet, there is no answer")
    others = set(responses["study"]) - {study.name}
    if others:
        raise InputError(f"study: rows of {sorted(others)[0]!r} given, {study.name!r} accepted")
    times_s = pd.to_numeric(responses["reaction_time_s"], errors="coerce")
    wrong = times_s.isna() & responses["reaction_time_s"].notna() | (times_s <= 0)
    if wrong.any():
        raise InputError(
            f"reaction_time_s: {responses.loc[wrong, 'reaction_time_s'].iloc[0]!r} given,"
            " more than 0 or none accepted"
        )


def _answers(answers: pd.Series, study: Study) -> pd.Series:
    numbers = pd.to_numeric(answers, errors="coerce")
    choices = study.choices
    possible = answers.isna() | numbers.between(1, choices) & (numbers % 1 == 0)
    if not possible.all():
        raise InputError(
            f"answer: {answers[~possible].iloc[0]!r} given, 1 to {choices} or none accepted"
        )
    return numbers.astype("Int64").reset_index(drop=True)


def _factors(stimuli: StimulusSet, study: Study) -> pd.DataFrame:
    level = study.stimuli.level
    if level is None:
        raise InputError(f"stimuli.level: the study {study.name} names no level to analyse by")
    frame = stimuli.to_frame()
    for name in (level, *study.stimuli.conditions):
        if name not in frame.columns:
            raise InputError(f"stimuli: the set {stimuli.name} has no factor {name!r}")
    shown = {stimulus.id for stimulus in chosen(study, stimuli, "main")}
    frame = frame[frame["stimulus"].isin(shown)].drop(columns=["role", "file"])
    for name in study.stimuli.conditions:  # in the order of the set, not of the alphabet
        values = frame[name].astype(str)
        frame[name] = pd.Categorical(values, categories=values.unique())
    frame["level"] = pd.to_numeric(frame[level]).astype(float)
    frame["target"] = frame.pop("answer").astype("Int64")
    return frame
