"""Studies of adaptive designs about the drawn set, and answers to their trials."""

from typing import Any

import numpy as np

from experiments.planning.presentations import Answer, Trial
from experiments.planning.right_answers import right_answer
from experiments.simulated.observers import psychometric_function
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.comparison_studies import comparison_study

BRIEF: dict[str, dict[str, Any]] = {
    "staircase": {"trials": 12},
    "quest-plus": {"trials": 12},
    "active-pairs": {"trials": 12},
}


def adaptive_study(study: Study, kind: str, **design: Any) -> Study:  # noqa: ANN401
    """Return the study of that name with a brief adaptive design."""
    if kind == "active-pairs":
        return active_study(study, **design)
    content = study.model_dump(mode="json")
    rule = {kind.replace("-", "_"): BRIEF[kind]}
    changes = {
        "name": kind,
        "design": {"kind": kind, "seed": 5, **rule, **design},
        "stimuli": content["stimuli"] | {"conditions": ["placement"]},
        "practice": {"trials": 1},
    }
    return Study.model_validate(content | changes)


def active_study(study: Study, **changes: Any) -> Study:  # noqa: ANN401
    """Return a study of active pairs: all levels and placements of a material are compared."""
    compared = comparison_study(study, "two-alternative").model_dump(mode="json")
    rule = {"active_pairs": changes.pop("active_pairs", BRIEF["active-pairs"] | changes)}
    changes = {
        "name": "active-pairs",
        "design": {"kind": "active-pairs", "seed": 5, **rule},
        "stimuli": compared["stimuli"]
        | {"item": "divergence_deg", "within": ["placement", "material"]}
        | {"only": {"placement": ["front"]}, "conditions": []},
    }
    return Study.model_validate(compared | changes)


def answered(
    study: Study, stimuli: StimulusSet, trial: Trial, generator: np.random.Generator
) -> Answer:
    """Return an answer that is right the more often the higher the level, or prefers high ones."""
    levels = [float(stimuli[each].factors["divergence_deg"]) for each in trial.stimuli]
    if study.task == "two-alternative":
        return 1 + int(generator.normal(0, 20) < levels[1] - levels[0])
    right = right_answer(study, stimuli, trial)
    noticed = generator.random() < float(psychometric_function(levels[0], 40, 30, 0.125, 0.02))
    assert isinstance(right, int)
    return right if noticed else right % 8 + 1
