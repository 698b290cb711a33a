"""Answers about pairs, rankings and single images, joined with what was shown."""

import math
from collections.abc import Container

import pandas as pd

from algorithms.errors import InputError
from analysis.answers.trials import KEPT, check_responses
from experiments.answers import accepted_answers, is_possible
from experiments.planning.trials import Answer, Trial
from experiments.study import Study, Task, chosen
from stimuli.manifest import StimulusSet


def pair_table(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return the answers of a `two-alternative` study, one row a pair.

    Parameters
    ----------
    responses
        Rows with the columns of `experiments.responses.Response`.
    study, stimuli
        What was run; rows of practice trials are dropped.

    Returns
    -------
    pandas.DataFrame
        `participant`, `session`, `trial_index`, each factor of `stimuli.within`, `item_a`
        and `item_b` (the items in the first and the second place), `chosen` (one of them; missing
        where no answer was given), `answer` (1 or 2), `reaction_time_s`, `dropped_frames`,
        `simulated`, `pilot`.

    Raises
    ------
    InputError
        If a column is missing, nothing was answered, or a row does not fit study and stimuli.
    """
    table, items = _answered(responses, study, stimuli, "two-alternative")
    table["item_a"], table["item_b"] = ([pair[place] for pair in items] for place in (0, 1))
    table["chosen"] = [
        None if pd.isna(answer) else pair[int(answer) - 1]
        for pair, answer in zip(items, table["answer"], strict=True)
    ]
    return table


def rank_table(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return the answers of a `ranking` study, one row a ranking and one column an item.

    Parameters and errors as of `pair_table`.

    Returns
    -------
    pandas.DataFrame
        `participant`, `session`, `trial_index`, each factor of `stimuli.within`, the rank of each
        item under the item's name (1 is best; missing for items that were not shown), `answer` (1;
        missing where no answer was given), `reaction_time_s`, `dropped_frames`,
        `simulated`, `pilot`.
    """
    table, items = _answered(responses, study, stimuli, "ranking")
    ranks = [
        dict(zip(shown, answer, strict=True)) if isinstance(answer, tuple) else {}
        for shown, answer in zip(items, table["answer"], strict=True)
    ]
    for name in item_names(study, stimuli):
        table[name] = pd.array([each.get(name) for each in ranks], dtype="Int64")
    table["answer"] = pd.array([1 if each else None for each in ranks], dtype="Int64")
    return table


def judgement_table(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Return the answers of a `yes-no` study, one row an image.

    Parameters and errors as of `pair_table`.

    Returns
    -------
    pandas.DataFrame
        `participant`, `session`, `trial_index`, `stimulus`, the factors of `stimuli.conditions`,
        `item`, `answer` (1 for yes, 0 for no; missing where no answer was given), `truth` (the
        stimulus' right answer in the manifest, 1 or 0; missing where there is none, or where the
        set's right answers are others than these), `reaction_time_s`, `dropped_frames`,
        `simulated`, `pilot`.
    """
    table, items = _answered(responses, study, stimuli, "yes-no")
    table["item"] = [shown[0] for shown in items]
    table["stimulus"] = [shown[0] for shown in _main(responses)["stimuli"]]
    truth = {stimulus.id: stimulus.answer for stimulus in stimuli.stimuli}
    told = pd.Series([truth[name] for name in table["stimulus"]], dtype=object)
    # Other right answers than yes and no, such as labels of regions, belong to another task.
    judged = told.dropna().isin([0, 1]).all()
    table["truth"] = (told if judged else told.where(told.isna())).astype("Int64")
    table["answer"] = table["answer"].astype("Int64")
    return table


def item_names(study: Study, stimuli: StimulusSet) -> list[str]:
    """Return the items of a study of comparisons, in the order of the set."""
    item = study.stimuli.item
    if item is None:
        raise InputError(f"stimuli.item: the study {study.name} names no items to compare")
    return list(dict.fromkeys(str(s.factors[item]) for s in chosen(study, stimuli, "main")))


def _main(responses: pd.DataFrame) -> pd.DataFrame:
    return responses[responses["phase"] == "main"]


def _answered(
    responses: pd.DataFrame, study: Study, stimuli: StimulusSet, task: Task
) -> tuple[pd.DataFrame, list[tuple[str, ...]]]:
    """Return the main trials with the factors they share, and the items shown in each."""
    if study.task != task:
        raise InputError(f"task: {study.task} given, {task} accepted")
    check_responses(responses, study)
    main = _main(responses)
    if main.empty:
        raise InputError(f"responses: nothing to analyse yet, no main trial of {study.name}")
    factors = {stimulus.id: stimulus.factors for stimulus in chosen(study, stimuli, "main")}
    shown = [tuple(each) for each in main["stimuli"]]
    answers = [_answer(value) for value in main["answer"]]
    for identifiers, answer in zip(shown, answers, strict=True):
        _check_trial(study, identifiers, answer, factors)
    table = main.loc[:, list(KEPT)].reset_index(drop=True)
    for name in dict.fromkeys((*study.stimuli.within, *study.stimuli.conditions)):
        levels = dict.fromkeys(str(each[name]) for each in factors.values())
        values = [str(factors[identifiers[0]][name]) for identifiers in shown]
        table[name] = pd.Categorical(values, categories=list(levels))
    table["answer"] = pd.Series(answers, dtype=object)
    item = study.stimuli.item
    assert item is not None
    return table, [tuple(str(factors[each][item]) for each in ids) for ids in shown]


def _answer(value: object) -> Answer:
    """Return an answer as the rows have it: a table may hold it as a float or a list."""
    if isinstance(value, list | tuple):
        return tuple(int(part) for part in value)
    if value is None or value is pd.NA or (isinstance(value, float) and math.isnan(value)):
        return None
    return int(value)  # type: ignore[call-overload, no-any-return]  # what a column may hold


def _check_trial(
    study: Study, identifiers: tuple[str, ...], answer: Answer, known: Container[str]
) -> None:
    for identifier in identifiers:
        if identifier not in known:
            raise InputError(f"stimuli: {identifier!r} was shown but is not in the set")
    trial = Trial(0, "main", identifiers)
    if answer is not None and not is_possible(study, trial, answer):
        accepted = accepted_answers(study, trial)
        raise InputError(f"answer: {answer} given, {accepted} or none accepted")
