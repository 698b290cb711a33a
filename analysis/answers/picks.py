"""Picked objects joined with what was shown, and how often chance alone would find them."""

from math import comb

import pandas as pd

from algorithms.errors import InputError
from analysis.answers.trials import KEPT, check_responses
from experiments.answers import accepted_answers, is_possible
from experiments.planning.trials import Answer, Trial
from experiments.study import Study, chosen
from stimuli.manifest import Stimulus, StimulusSet


def pick_table(responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
    """Join the answers of a `pick` study with the objects that are right to pick.

    Parameters
    ----------
    responses
        Rows with the columns of `experiments.responses.Response`; those of practice are dropped.
    study, stimuli
        What was run.

    Returns
    -------
    pandas.DataFrame
        One row a main trial: `participant`, `session`, `trial_index`, `stimulus`, `level` (where
        the study names one), the factors of `stimuli.conditions`, `target` and `answer` (tuples of
        labels; None where there is none), `targets` (how many), `any` and `exact` (whether one or
        more of the targets were picked, and whether these and no other; missing without a target
        or an answer), `chance_any` and `chance_exact` (the same for as many picks at random),
        `reaction_time_s`, `dropped_frames`, `simulated`, `pilot`.

    Raises
    ------
    InputError
        If a column is missing, there are no rows, or a row does not fit study and stimuli.
    """
    check_responses(responses, study)
    main = responses[responses["phase"] == "main"]
    if main.empty:
        raise InputError(f"responses: nothing to analyse yet, no main trial of {study.name}")
    known = {stimulus.id: stimulus for stimulus in chosen(study, stimuli, "main")}
    rows = [
        _row(study, known, tuple(shown), given)
        for shown, given in zip(main["stimuli"], main["answer"], strict=True)
    ]
    table = pd.concat([main.loc[:, list(KEPT)].reset_index(drop=True), pd.DataFrame(rows)], axis=1)
    for name in study.stimuli.conditions:
        levels = dict.fromkeys(str(each.factors[name]) for each in known.values())
        table[name] = pd.Categorical(table[name], categories=list(levels))
    return table.astype({"any": "boolean", "exact": "boolean"})


def chance_of_picks(choices: int, targets: int, picks: int) -> tuple[float, float]:
    """Return how often as many picks at random find a target, and all of them and no other.

    Parameters
    ----------
    choices
        How many objects there are, of which none is picked twice.
    targets, picks
        How many are right, and how many are picked; 1 or more.

    Examples
    --------
    One or two picks among eight objects, two of them inserted (Lopez-Moreno 2011, sec. 2.5, where
    other numbers are printed):

    >>> chance_of_picks(8, 2, 1), chance_of_picks(8, 2, 2)
    ((0.25, 0.0), (0.4642857142857143, 0.03571428571428571))
    """
    ways = comb(choices, picks)
    return 1 - comb(choices - targets, picks) / ways, float(picks == targets) / ways


def _row(
    study: Study, known: dict[str, Stimulus], shown: tuple[str, ...], given: object
) -> dict[str, object]:
    (identifier,) = shown
    if identifier not in known:
        raise InputError(f"stimuli: {identifier!r} was shown but is not in the set")
    answer = tuple(int(label) for label in given) if isinstance(given, list | tuple) else None
    _check(study, shown, answer)
    stimulus = known[identifier]
    target = stimulus.right_labels or None
    row: dict[str, object] = {"stimulus": identifier, "target": target, "answer": answer}
    if study.stimuli.level is not None:
        row["level"] = float(stimulus.factors[study.stimuli.level])
    row |= {name: str(stimulus.factors[name]) for name in study.stimuli.conditions}
    scores: tuple[object, ...] = (None, None, None, None)
    if target is not None and answer is not None:
        found = bool(set(target) & set(answer))
        scores = (
            found,
            answer == target,
            *chance_of_picks(study.choices, len(target), len(answer)),
        )
    names = ("any", "exact", "chance_any", "chance_exact")
    return row | {"targets": len(target or ())} | dict(zip(names, scores, strict=True))


def _check(study: Study, shown: tuple[str, ...], answer: Answer) -> None:
    trial = Trial(0, "main", shown)
    if answer is not None and not is_possible(study, trial, answer):
        accepted = accepted_answers(study, trial)
        raise InputError(f"answer: {answer} given, {accepted} or none accepted")
