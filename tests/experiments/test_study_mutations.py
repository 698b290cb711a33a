"""Property: a study file with anything in it is a study, or is refused in one line."""

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from algorithms.errors import InputError
from experiments.planning.course import course_of
from experiments.planning.trials import Assignment
from experiments.study import READY_MADE, check_stimuli, load_study
from stimuli.manifest import StimulusSet
from tests.comparison_studies import as_toml_text
from tests.drawn_studies import draw_for

NAMES = sorted(path.stem for path in READY_MADE.glob("*.toml") if path.stem != "lights-synthetic")

anything = st.one_of(
    st.integers(-3, 10**6),
    st.floats(),
    st.booleans(),
    st.text(max_size=8),
    st.sampled_from(["method", "object", "pairs", "sets", "ranking", "yes-no", "es", "main"]),
    st.sampled_from(["staircase", "quest-plus", "active-pairs"]),
    st.lists(st.one_of(st.integers(0, 3), st.text(max_size=3)), max_size=3),
    st.dictionaries(st.sampled_from(["method", "trials", "x"]), st.integers(0, 3), max_size=2),
)


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> dict[str, StimulusSet]:
    folder = tmp_path_factory.mktemp("sets")
    return {name: draw_for(load_study(name), folder / name) for name in NAMES}


def places(content: dict[str, Any]) -> list[tuple[str, ...]]:
    """Return the path of every key of a study, tables included."""
    inner: list[tuple[str, ...]] = [
        (table, key)
        for table, keys in content.items()
        if isinstance(keys, dict)
        for key in (*keys, "unknown")
    ]
    return [*((key,) for key in content), *inner]


@given(data=st.data())
@settings(max_examples=300, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_mutated_study_is_one_or_is_refused_in_one_line(
    data: st.DataObject, sets: dict[str, StimulusSet], tmp_path: Path
) -> None:
    name = data.draw(st.sampled_from(NAMES))
    content = json.loads(load_study(name).model_dump_json(exclude_none=True))
    for _ in range(data.draw(st.integers(1, 3))):
        *table, key = data.draw(st.sampled_from(places(content)))
        inside = content[table[0]] if table else content
        if data.draw(st.booleans()):
            inside.pop(key, None)
        else:
            inside[key] = data.draw(anything)
    file = tmp_path / "study.toml"
    file.write_text(as_toml_text(content), encoding="utf-8")
    assert "\n" not in fault_of(file, sets[name])


def fault_of(file: Path, stimuli: StimulusSet) -> str:
    """Return why a study cannot run; nothing if it can."""
    try:
        study = load_study(file)
        check_stimuli(study, stimuli)
        course_of(study, stimuli, Assignment(1))
    except InputError as error:
        return str(error)
    return ""
