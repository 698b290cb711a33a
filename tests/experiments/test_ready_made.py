"""The ready-made studies: each plans, simulates and is served; who lacks its images is told how."""

from collections import Counter
from pathlib import Path

import httpx
import numpy as np
import pytest
from typer.testing import CliRunner

from algorithms.errors import InputError
from experiments.cli import app
from experiments.planning.trials import Assignment, planned_trials
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer, simulate_responses
from experiments.simulated.simulation import simulate_in_process
from experiments.simulated.viewers import Viewer, simulate_viewing
from experiments.storage.store import Store
from experiments.study import CHOOSES, check_stimuli, load_study
from experiments.web import create_app, running_server
from stimuli.manifest import StimulusSet
from tests.drawn_studies import METHODS, draw_for

# What the thesis showed a participant: trials, and images at once.
SHOWN = {
    "lights-texture": {1: 20},  # the drawn set has two of the four textures
    "lights-photographs": {1: 3},
    "fog-realism": {1: 6},
    "fog-ranking": {6: 1},
    "caustics-pairs": {2: 48},
    "caustics-real": {2: 1},
    "caustics-ranking": {5: 1, 6: 1},
    "lights-inserted": {1: 2},
    "stylisation-pairs": {2: 18},
    "light-viewing": {1: 20},
}
LAB_ONLY = ("light-viewing",)


@pytest.fixture(params=SHOWN)
def name(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def drawn(name: str, tmp_path: Path) -> StimulusSet:
    return draw_for(load_study(name), tmp_path / "set")


def test_a_participant_sees_what_the_thesis_showed(name: str, drawn: StimulusSet) -> None:
    study = load_study(name)
    check_stimuli(study, drawn)
    trials = planned_trials(study, drawn, Assignment(1))
    assert Counter(len(t.stimuli) for t in trials if t.phase == "main") == SHOWN[name]
    assert sum(trial.phase == "practice" for trial in trials) == study.practice.trials


def test_it_is_served(name: str, drawn: StimulusSet, store: Store) -> None:
    study = load_study(name)
    if name in LAB_ONLY:
        with pytest.raises(InputError, match="task: free-viewing records gaze"):
            create_app(study, drawn, store)
        return
    with running_server(create_app(study, drawn, store)) as url:
        told = httpx.get(f"{url}/api/studies/{name}").json()
    assert told["task"] == study.task
    assert told["timing"]["time_limit_s"] == (20 if name == "fog-realism" else None)


def test_simulated_observers_take_it(
    name: str, drawn: StimulusSet, store: Store, tmp_path: Path
) -> None:
    study, generator = load_study(name), np.random.default_rng(1)
    trials = len(planned_trials(study, drawn, Assignment(1)))
    if study.task in CHOOSES:
        rows = simulate_responses(study, drawn, Observer(25, 30), 2, generator)
        assert len(rows) == 2 * trials
        return
    if study.task == "free-viewing":
        simulate_viewing(study, drawn, store, Viewer(), 2, generator, tmp_path)
        assert len(store.responses()) == len(list(tmp_path.rglob("*.parquet"))) == 2 * trials
        return
    items = {str(stimulus.factors[study.stimuli.item or ""]) for stimulus in drawn.stimuli}
    simulate_in_process(study, drawn, store, ItemObserver(dict.fromkeys(items, 0.0)), 2, generator)
    assert len(store.responses()) == 2 * trials


def test_each_pair_of_methods_stands_once_within_object_and_light(tmp_path: Path) -> None:
    study = load_study("caustics-pairs")
    drawn = draw_for(study, tmp_path / "set")
    trials = planned_trials(study, drawn, Assignment(7))
    shown = [[drawn[each].factors for each in t.stimuli] for t in trials if t.phase == "main"]
    assert all(left["object"] == right["object"] for left, right in shown)
    assert all(left["light_deg"] == right["light_deg"] for left, right in shown)
    pairs = Counter(frozenset((str(a["method"]), str(b["method"]))) for a, b in shown)
    assert set(pairs.values()) == {16}
    assert len(pairs) == len(METHODS)


def test_who_lacks_the_images_is_told_the_command(tmp_path: Path, name: str) -> None:
    study = load_study(name)
    told = CliRunner().invoke(app, ["check", name, "--stimuli", str(tmp_path / "none")])
    assert f"the images of {name} are made by: {study.stimuli.made_by}" in str(told.exception)
    assert study.stimuli.made_by.startswith("trompe stimuli make ")
