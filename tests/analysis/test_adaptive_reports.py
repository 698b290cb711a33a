"""The report of an adaptive study: uneven answers, and no test that fixed levels would need."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.report.page import analyse
from experiments.simulated.observers import Observer
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.adaptive_studies import adaptive_study

THRESHOLDS = {"front": 30.0, "back": 50.0, "front-back": 40.0}


@pytest.fixture(scope="module")
def report(study: Study, drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("adaptive")
    asked = adaptive_study(study, "quest-plus", quest_plus={"trials": 30, "sd": 3.0})
    observer = Observer(THRESHOLDS, 30.0, condition="placement")
    with Store.open(folder / "answers.sqlite") as store:
        simulate_in_process(asked, drawn_set, store, observer, 4, np.random.default_rng(1))
    analyse(folder / "answers.sqlite", folder / "report")
    return folder / "report"


def test_known_thresholds_are_recovered_from_uneven_answers(report: Path) -> None:
    table = pd.read_csv(report / "tables" / "thresholds.csv").set_index("group")
    rates = pd.read_csv(report / "tables" / "hit-rates.csv")
    assert rates["answers"].max() > 5 * rates["answers"].min()
    known = np.array(list(THRESHOLDS.values()))
    low, high = (
        table.loc[list(THRESHOLDS), f"threshold_{end}"].to_numpy(float) for end in ("low", "high")
    )
    assert ((low < known) & (known < high)).all()
    (front,) = pd.read_csv(report / "tables" / "threshold-differences.csv").query(
        "pair == 'front - back'"
    )["difference"]
    assert front == pytest.approx(-20, abs=7)


def test_what_fixed_levels_would_need_is_not_told(report: Path) -> None:
    results = json.loads((report / "results.json").read_text(encoding="utf-8"))
    assert set(results["not_told"]) >= {"largest level at chance", "effects on the hit rate"}
    assert all(group["at_chance"] is None for group in results["thresholds"])
    page = (report / "report.html").read_text(encoding="utf-8")
    assert "Adaptive design (quest-plus)" in page
    assert "exact binomial" not in page
    assert not any("cannot be told from guessing" in each for each in results["verdict"])
