"""Power of a study as it is written: its own design, simulated observers, its own test."""

from collections.abc import Sequence
from typing import Final

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.answers.comparison_tables import pair_table
from analysis.answers.trials import trial_table
from analysis.judgements.preference_pairs import item_preferences
from analysis.power import Outcome, Run
from analysis.thresholds.condition_differences import condition_differences
from experiments.responses import responses_frame
from experiments.simulated.observers import Observer, simulate_responses
from experiments.simulated.simulation import AnyObserver, simulate_rows
from experiments.study import Study
from stimuli.manifest import StimulusSet

_UNKNOWN: Final = Outcome(float("nan"), float("nan"))


def study_run(
    study: Study,
    stimuli: StimulusSet,
    observer: AnyObserver,
    between: tuple[str, str],
    condition: str | None = None,
) -> tuple[Run, str, str]:
    """Return what simulates and tests a study once, what it estimates, and how it tests that.

    Parameters
    ----------
    study, stimuli
        An `odd-one-out` study with a condition, or a `two-alternative` one.
    observer
        How participants answer: where the two really differ, the difference is there to be found.
    between
        Two values of the condition, whose thresholds are compared (`threshold_difference`), or two
        items, of which one is preferred (`preference`).
    condition
        Of `odd-one-out`: the factor; None for the study's only one.

    Raises
    ------
    InputError
        If the task has no such test, or the study no such condition or items.
    """
    if study.task == "two-alternative":
        return _preference_run(study, stimuli, observer, between)
    if study.task != "odd-one-out":
        raise InputError(f"task: {study.task} given, odd-one-out or two-alternative accepted")
    conditions = study.stimuli.conditions
    if condition is None and len(conditions) == 1:
        (condition,) = conditions
    if condition not in conditions:
        raise InputError(f"condition: {condition!r} given, {', '.join(conditions)} accepted")
    _check_values(stimuli, condition or "", between)
    return _threshold_run(study, stimuli, observer, between, condition or "")


def _threshold_run(
    study: Study,
    stimuli: StimulusSet,
    observer: AnyObserver,
    between: tuple[str, str],
    condition: str,
) -> tuple[Run, str, str]:
    def run(participants: Sequence[int], generator: np.random.Generator) -> list[Outcome]:
        answers, resampling = generator.spawn(2)
        rows = _simulated(study, stimuli, observer, max(participants), answers)
        table = trial_table(rows, study, stimuli)
        table = table[table[condition].astype(str).isin(between)]
        table[condition] = pd.Categorical(table[condition].astype(str), categories=between)
        found = []
        for part in _first(table, participants):
            try:
                compared = condition_differences(
                    part,
                    condition,
                    study.guess_rate,
                    resampling,
                    levels_fixed=not study.design.is_adaptive,
                )
            except InputError:
                found.append(_UNKNOWN)
                continue
            (difference,) = compared.differences.values()
            found.append(Outcome(difference.difference.value, difference.p_value))
        return found

    quantity = f"threshold of {between[0]} minus that of {between[1]}"
    return run, quantity, "bootstrap over participants (threshold_difference)"


def _preference_run(
    study: Study, stimuli: StimulusSet, observer: AnyObserver, between: tuple[str, str]
) -> tuple[Run, str, str]:
    _check_values(stimuli, study.stimuli.item or "", between)

    def run(participants: Sequence[int], generator: np.random.Generator) -> list[Outcome]:
        rows = _simulated(study, stimuli, observer, max(participants), generator)
        table = pair_table(rows, study, stimuli)
        found = []
        for part in _first(table, participants):
            try:
                (result,) = item_preferences(part, between).results
            except InputError:
                found.append(_UNKNOWN)
                continue
            found.append(Outcome(result.share.value, result.p_value))
        return found

    quantity = f"share of answers for {between[0]} over {between[1]}"
    return run, quantity, "Wilson-type t-test over participants (preference)"


def _simulated(
    study: Study,
    stimuli: StimulusSet,
    observer: AnyObserver,
    participants: int,
    generator: np.random.Generator,
) -> pd.DataFrame:
    if isinstance(observer, Observer) and not study.design.is_adaptive:
        return simulate_responses(study, stimuli, observer, participants, generator)
    return responses_frame(simulate_rows(study, stimuli, observer, participants, generator))


def _first(table: pd.DataFrame, participants: Sequence[int]) -> list[pd.DataFrame]:
    """Return the rows of the first n participants, for each n."""
    people = sorted(set(table["participant"]))
    return [table[table["participant"].isin(people[:number])] for number in participants]


def _check_values(stimuli: StimulusSet, factor: str, between: tuple[str, str]) -> None:
    there = list(dict.fromkeys(str(one.factors[factor]) for one in stimuli.with_role("main")))
    if len(set(between)) != 2 or not set(between) <= set(there):
        raise InputError(
            f"between: {' and '.join(between)} given, two of {', '.join(there)} accepted"
        )
