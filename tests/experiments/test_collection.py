"""What was collected, from a store and from a bundle that left it."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from algorithms.errors import InputError
from experiments.cli import app
from experiments.exports.collection import Collection, load_collection, write_bundle
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.comparison_studies import comparison_study


@pytest.fixture
def data(study: Study, drawn_set: StimulusSet, tmp_path: Path) -> Path:
    """A store with one ranking study, and an event."""
    path = tmp_path / "answers.sqlite"
    observer = ItemObserver({"front": 0.0, "back": 1.0, "front-back": 2.0})
    with Store.open(path) as store:
        asked = comparison_study(study, "ranking")
        (session,) = simulate_in_process(
            asked, drawn_set, store, observer, 1, np.random.default_rng(1)
        )
        store.add_event(session.id, "focus lost", {"trial": 3})
    return path


def test_a_bundle_holds_what_the_store_held(data: Path, tmp_path: Path) -> None:
    # Property: out and in again, nothing is lost or changed, tuples included.
    told = CliRunner().invoke(app, ["bundle", str(data), str(tmp_path / "bundle")])
    assert told.output == f"wrote {tmp_path / 'bundle' / 'bundle.json'}\n"
    stored, bundled = load_collection(data), load_collection(tmp_path / "bundle")
    assert bundled == Collection(
        stored.study, stored.stimuli, stored.sessions, stored.responses, stored.events
    )
    assert bundled.study.digest == stored.study.digest
    assert bundled.stimuli.digest == stored.stimuli.digest
    assert isinstance(bundled.responses[0].answer, tuple)
    assert [event.kind for event in bundled.events] == ["focus lost"]


def test_bundles_that_are_not_as_they_were_are_refused(data: Path, tmp_path: Path) -> None:
    folder = tmp_path / "bundle"
    write_bundle(load_collection(data), folder)
    with pytest.raises(InputError, match="holds other files; choose a new or empty folder"):
        write_bundle(load_collection(data), folder)
    with pytest.raises(InputError, match="study: 'pairs' given, the bundle holds ranking"):
        load_collection(folder, "pairs")
    rows = json.loads((folder / "responses.json").read_text())
    rows[0]["answer"] = [3, 2, 1]
    (folder / "responses.json").write_text(json.dumps(rows))
    with pytest.raises(InputError, match=r"responses\.json: altered since the bundle was made"):
        load_collection(folder)
    (folder / "responses.json").unlink()
    with pytest.raises(InputError, match="cannot be read"):
        load_collection(folder)
    (folder / "bundle.json").write_text("[]")
    with pytest.raises(InputError, match="a bundle of format 1 is accepted"):
        load_collection(folder)
    (folder / "bundle.json").write_text("{")
    with pytest.raises(InputError, match="not a JSON file"):
        load_collection(folder)
    with pytest.raises(InputError, match=r"bundle\.json: cannot be read"):
        load_collection(tmp_path)
