import inspect
import json
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from algorithms.errors import InputError
from analysis.cli import analyse
from analysis.report.page import DEFAULT_SEED
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import fill_store, rows_of

app = typer.Typer()
app.command()(analyse)


@pytest.fixture(scope="module")
def data(study: Study, drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    # Without conditions there is least to fit.
    stimuli = study.stimuli.model_copy(update={"conditions": ()})
    plain = study.model_copy(update={"stimuli": stimuli})
    path = tmp_path_factory.mktemp("store") / "responses.sqlite"
    with Store.open(path) as store:
        fill_store(store, plain, drawn_set, rows_of(plain, drawn_set, 3, seed=1))
    return path


def test_prints_the_verdict_and_where_the_report_is(data: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, [str(data), "--out", str(tmp_path / "out")])
    assert result.exit_code == 0
    assert result.output.startswith("Simulated observers, not people,")
    assert f"wrote {tmp_path / 'out' / 'report.html'}" in result.output


def test_json_holds_the_results_and_the_seed(data: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, [str(data), "--out", str(tmp_path), "--json", "--seed", "7"])
    found = json.loads(result.output)
    assert found["report"] == str(tmp_path / "report.html")
    assert found["seed"] == 7
    assert found["simulated"] is True
    assert found["thresholds"][0]["group"] == "all"


def test_default_seed_is_the_same_in_python() -> None:
    assert inspect.signature(analyse).parameters["seed"].default == DEFAULT_SEED


def test_asking_for_people_where_there_are_none(data: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, [str(data), "--out", str(tmp_path / "out"), "--people"])
    assert isinstance(result.exception, InputError)
    assert str(result.exception).startswith("nothing to analyse yet: no session of people")
    assert not (tmp_path / "out").exists()
