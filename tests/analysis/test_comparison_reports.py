"""Reports of pairs, rankings and judgements: what they say, of whom, and that it is the truth."""

import base64
import json
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.report import analyse, differences
from experiments.item_observers import ItemObserver, simulate_comparisons
from experiments.store import Store
from experiments.study import Study, Task
from stimuli.manifest import StimulusSet
from tests.comparison_studies import ITEMS, comparison_study

QUALITIES = {"front": 0.0, "back": 1.0, "front-back": -0.4}


def report_of(
    task: Task, study: Study, stimuli: StimulusSet, folder: Path, participants: int = 6
) -> Path:
    """Simulate a study and return the folder of its report."""
    observer = ItemObserver(QUALITIES, lapse_rate=0.0, criterion=0.2)
    asked = comparison_study(study, task)
    with Store.open(folder / "answers.sqlite") as store:
        generator = np.random.default_rng(8)
        simulate_comparisons(asked, stimuli, store, observer, participants, generator)
    analyse(folder / "answers.sqlite", folder / "report")
    return folder / "report"


@pytest.fixture(scope="module")
def pairs(study: Study, drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return report_of("two-alternative", study, drawn_set, tmp_path_factory.mktemp("pairs"))


def visible_text(page: str) -> str:
    """Return what a reader sees of a page, in one line."""
    return " ".join(re.sub(r"<[^>]+>", " ", re.sub(r"base64,[^\"]+", "", page)).split())


def test_the_scale_of_the_pairs_is_that_of_the_observers(pairs: Path) -> None:
    # Recovery: the items' known qualities lie within the reported intervals.
    table = pd.read_csv(pairs / "tables" / "scale.csv")
    overall = table[table["group"] == "all"].set_index("item").loc[list(QUALITIES)]
    known = np.array(list(QUALITIES.values()))
    low, high = (overall[name].to_numpy(float) for name in ("low", "high"))
    assert ((low < known - known.mean()) & (known - known.mean() < high)).all()
    results = json.loads((pairs / "results.json").read_text())
    assert results["task"] == "two-alternative"
    assert results["items"] == list(ITEMS)
    assert "place the items, best first, at back" in results["verdict"][0]


def test_every_condition_has_consistency_agreement_and_groups(pairs: Path) -> None:
    for name in ("consistency", "agreement", "score-groups", "scale", "transitivity"):
        table = pd.read_csv(pairs / "tables" / f"{name}.csv")
        assert set(table["group"]) == {"all", "material diffuse", "material shiny"}
        assert table["simulated"].all()
    tests = pd.read_csv(pairs / "tables" / "agreement-tests.csv")
    assert (tests["p_holm"] >= tests["p_value"]).all()
    agreement = pd.read_csv(pairs / "tables" / "agreement.csv").set_index("group")
    # All sets of pairs of six participants: levels x materials, or levels alone.
    assert agreement["conditions"].tolist() == [20, 10, 10]
    assert (agreement["n"] == 6).all()


def test_the_pages_of_comparisons_stand_alone_and_say_simulated(pairs: Path) -> None:
    page = (pairs / "report.html").read_text()
    text = visible_text(page)
    assert "SIMULATED" in text
    assert "Simulated observers, not people, place the items" in text
    for heading in ("Scale", "Consistency and agreement", "Score groups", "Methods", "Provenance"):
        assert f"<h2>{heading}</h2>" in page
    assert not re.search(r"\b(nan|inf|None)\b", text)
    assert "http" not in re.sub(r"base64,[^\"]+", "", page)
    for drawing in re.findall(r"svg\+xml;base64,([^\"]+)", page):
        assert b"svg" in base64.b64decode(drawing)
    assert differences(pairs.parent / "answers.sqlite", pairs) == []


def test_one_participant_gets_what_one_can_give(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    report = report_of("two-alternative", study, drawn_set, tmp_path, participants=1)
    text = visible_text((report / "report.html").read_text())
    assert "none: wins: one observer given, agreement needs two or more" in text
    assert not re.search(r"\b(nan|inf|None)\b", text)


def test_an_empty_study_is_one_line(study: Study, drawn_set: StimulusSet, tmp_path: Path) -> None:
    with Store.open(tmp_path / "answers.sqlite") as store:
        store.register(comparison_study(study, "ranking"), drawn_set)
    with pytest.raises(InputError, match="nothing to analyse yet"):
        analyse(tmp_path / "answers.sqlite", tmp_path / "report")
    assert not (tmp_path / "report").exists()
