"""Studies of comparisons, made from the ready-made one for the drawn set.

The items are the three placements; within a level and a material they are compared with each other.
"""

import json
import math
from collections.abc import Mapping
from typing import Any

from experiments.study import Study, Task

ITEMS = ("front", "back", "front-back")


def comparison_study(study: Study, task: Task, **design: Any) -> Study:  # noqa: ANN401
    """Return a study of another task about the same images."""
    kinds = {"two-alternative": "pairs", "ranking": "sets", "yes-no": "factorial"}
    within = [] if task == "yes-no" else ["divergence_deg", "material"]
    stimuli = {"set": "divergence", "item": "placement", "within": within}
    content = study.model_dump(mode="json") | {
        "name": task,
        "task": task,
        "question": "Which image looks more real?",
        "stimuli": stimuli | {"conditions": ["material"]},
        "design": {"kind": kinds[task], "seed": 5, **design},
        "practice": {"trials": 0},
    }
    return Study.model_validate(content)


def pick_study(study: Study, picks: tuple[int, int], **parts: object) -> Study:
    """Return a study in which objects of the same images are picked."""
    content = study.model_dump(mode="json") | {"practice": {"trials": 0}}
    own = {"name": "pick", "task": "pick", "answers": {"picks": picks}}
    return Study.model_validate(content | own | parts)


def viewing_study(study: Study, image_s: float) -> Study:
    """Return a study in which the same images are only looked at."""
    content: dict[str, Any] = study.model_dump(mode="json")
    own = {"name": "free-viewing", "task": "free-viewing", "practice": {"trials": 0}}
    content["stimuli"]["choices"] = None
    content["exclusion"]["shortest_median_s"] = None
    return Study.model_validate(content | own | {"timing": {"image_s": image_s}})


def as_toml(study: Study) -> str:
    """Write a study as TOML."""
    return as_toml_text(study.model_dump(mode="json", exclude_none=True))


def as_toml_text(content: Mapping[str, Any]) -> str:
    """Write keys as TOML: those at the top first, then the tables."""
    flat = [f"{k} = {_value(v)}" for k, v in content.items() if not isinstance(v, dict)]
    tables = [
        f"[{name}]\n" + "\n".join(f"{k} = {_value(v)}" for k, v in table.items())
        for name, table in content.items()
        if isinstance(table, dict)
    ]
    return "\n".join([*flat, *tables]) + "\n"


def _value(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_value(part)}" for key, part in value.items()) + "}"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return json.dumps(value)
