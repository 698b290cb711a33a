"""Which answer to a trial is right, where one is."""

from experiments.planning.presentations import Answer, Trial
from experiments.study import Study
from stimuli.manifest import StimulusSet


def right_answer(study: Study, stimuli: StimulusSet, trial: Trial) -> Answer:
    """Return the right answer to a trial, or None where there is none.

    Of a single image it stands in the manifest. Of a comparison it follows from the order of items
    that the study declares: `practice.best_first`, and in a catch trial `catch.better` before
    `catch.worse`.
    """
    if study.task == "pick":
        return stimuli[trial.stimuli[0]].right_labels or None
    if study.task in ("odd-one-out", "yes-no"):
        truth = stimuli[trial.stimuli[0]].answer
        possible = isinstance(truth, int) and (study.task == "odd-one-out" or truth in (0, 1))
        return truth if possible else None  # type: ignore[return-value]  # a label or 0 or 1
    if study.task == "free-viewing":
        return None
    best_first, item = study.practice.best_first, study.stimuli.item
    if trial.phase == "catch" and study.catch is not None:
        best_first = (study.catch.better, study.catch.worse)
    items = [str(stimuli[identifier].factors[item or ""]) for identifier in trial.stimuli]
    if not set(items) <= set(best_first):
        return None
    order = sorted(items, key=best_first.index)
    ranks = tuple(order.index(each) + 1 for each in items)
    return ranks if study.task == "ranking" else ranks.index(1) + 1


def is_right(study: Study, stimuli: StimulusSet, trial: Trial, answer: Answer) -> bool | None:
    """Return whether an answer is right, or None where none is.

    A ranking in a catch trial is right if the better item is ranked above the worse one.
    """
    if study.task == "ranking" and trial.phase == "catch" and study.catch is not None:
        if not isinstance(answer, tuple):
            return False
        items = [str(stimuli[each].factors[study.stimuli.item or ""]) for each in trial.stimuli]
        rank = dict(zip(items, answer, strict=True))
        return rank[study.catch.better] < rank[study.catch.worse]
    right = right_answer(study, stimuli, trial)
    return None if right is None else answer == right
