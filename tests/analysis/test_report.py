import base64
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import trompe
from algorithms.errors import InputError
from analysis.figures.style import figure_bytes
from analysis.report.page import analyse, differences, render, write_report
from analysis.report.study_analysis import StudyAnalysis, analyse_study
from analysis.report.tables import study_tables
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis
from experiments.exports.collection import load_collection, write_bundle
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import fill_store, responses_of, rows_of, sessions_of


@pytest.fixture(scope="module")
def one_condition(study: Study) -> Study:
    """The study split by placement alone: a third of the fits."""
    part = study.stimuli.model_copy(update={"conditions": ("placement",)})
    return Study.model_validate(study.model_dump() | {"stimuli": part.model_dump()})


@pytest.fixture(scope="module")
def analysis(one_condition: Study, drawn_set: StimulusSet) -> StudyAnalysis:
    return analysis_of(rows_of(one_condition, drawn_set, 3, seed=1), one_condition, drawn_set)


def analysis_of(rows: pd.DataFrame, study: Study, stimuli: StimulusSet) -> OddOneOutAnalysis:
    analysis = analyse_study(study, stimuli, sessions_of(rows), responses_of(rows), seed=1)
    assert isinstance(analysis, OddOneOutAnalysis)
    return analysis


def figures_of(page: str) -> list[str]:
    """The SVG sources inside a page."""
    found = re.findall(r'src="data:image/svg\+xml;base64,([^"]+)"', page)
    return [base64.b64decode(one).decode() for one in found]


@pytest.fixture(scope="module")
def folders(
    study: Study, drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Path]:
    """The reports of one store that holds both people and simulated observers."""
    folder = tmp_path_factory.mktemp("store")
    simulated = rows_of(study, drawn_set, 3, seed=1)
    names = {f"P000{n}": f"P010{n}" for n in (1, 2, 3)}
    people = rows_of(study, drawn_set, 2, seed=2).assign(simulated=False, runner="web")
    people["participant"] = people["participant"].map(names)
    people["session"] = "lights-synthetic." + people["participant"] + ".1"
    people["id"] = people["session"] + people["trial_index"].map(".{:04d}".format)
    with Store.open(folder / "responses.sqlite") as store:
        fill_store(store, study, drawn_set, simulated)
        fill_store(store, study, drawn_set, people)
    for who in ("people", "simulated"):
        analyse(folder / "responses.sqlite", folder / who, who=who)
    return {"people": folder / "people", "simulated": folder / "simulated"}


@pytest.mark.parametrize("who", ["people", "simulated"])
def test_page_needs_nothing_from_elsewhere(folders: dict[str, Path], who: str) -> None:
    page = (folders[who] / "report.html").read_text()
    loads = re.findall(r'(?:src|href|url|@import)\s*[=(]?\s*["\']?([^"\'\s)>]+)', page)
    for target in loads:
        assert target.startswith("data:") or (folders[who] / target).is_file(), target
    assert "http" not in re.sub(r"base64,[^\"]+", "", page)


def test_page_tables_and_figures_say_simulated_where_it_is(folders: dict[str, Path]) -> None:
    page = (folders["simulated"] / "report.html").read_text()
    assert "<strong>SIMULATED.</strong>" in page
    assert "SIMULATED: Which object" in page
    assert "Simulated observers, not people, notice a divergence" in page
    assert "People notice" not in page
    for table in (folders["simulated"] / "tables").glob("*.csv"):
        assert pd.read_csv(table)["simulated"].all(), table


def test_nothing_says_simulated_of_people(folders: dict[str, Path]) -> None:
    page = (folders["people"] / "report.html").read_text()
    assert "SIMULATED" not in page
    assert "People notice a divergence" in page
    assert "The store also holds 3 sessions simulated; they are not in this report" in " ".join(
        page.split()
    )
    assert "Ages 30 to 30 (median 30); 2 female; 2 with an artistic background." in page
    for table in (folders["people"] / "tables").glob("*.csv"):
        assert not pd.read_csv(table)["simulated"].any(), table


def test_results_agree_with_the_tables(folders: dict[str, Path]) -> None:
    results = json.loads((folders["simulated"] / "results.json").read_text())
    table = pd.read_csv(folders["simulated"] / "tables" / "thresholds.csv")
    assert results["simulated"] is True
    assert results["seed"] == 1
    assert [one["group"] for one in results["thresholds"]] == table["group"].tolist()
    for one, (_, row) in zip(results["thresholds"], table.iterrows(), strict=True):
        value = one["fit"]["threshold"]["value"]
        assert value == pytest.approx(row["threshold"]) or value is None
    assert results["verdict"][0].startswith("Simulated observers, not people, notice")
    hits = pd.read_csv(folders["simulated"] / "tables" / "hit-rates.csv")
    rows = pd.DataFrame(results["hit_rates"]["table"])
    pd.testing.assert_frame_equal(rows, hits.drop(columns="simulated"))


def test_page_states_where_it_comes_from(
    folders: dict[str, Path], study: Study, drawn_set: StimulusSet
) -> None:
    page = (folders["people"] / "report.html").read_text()
    for text in (study.digest, drawn_set.digest, "psignifit 4.", "Sch&uuml;tt et al. 2016"):
        assert text in page


def test_same_store_same_bytes(folders: dict[str, Path], tmp_path: Path) -> None:
    analyse(folders["simulated"].parent / "responses.sqlite", tmp_path, who="simulated")
    paths = [path for path in sorted(folders["simulated"].rglob("*")) if path.is_file()]
    assert {path.suffix for path in paths} == {".csv", ".html", ".json", ".png", ".svg"}
    for path in paths:
        other = tmp_path / path.relative_to(folders["simulated"])
        assert path.read_bytes() == other.read_bytes(), path


def _all_right(rows: pd.DataFrame, stimuli: StimulusSet) -> pd.DataFrame:
    frame = stimuli.to_frame().set_index("stimulus")["answer"]
    shown = [identifiers[0] for identifiers in rows["stimuli"]]
    return rows.assign(answer=frame.loc[shown].fillna(1).astype(int).to_numpy())


def _all_wrong(rows: pd.DataFrame, stimuli: StimulusSet) -> pd.DataFrame:
    right = _all_right(rows, stimuli)
    return right.assign(answer=right["answer"] % 8 + 1)


def _without_controls(rows: pd.DataFrame, stimuli: StimulusSet) -> pd.DataFrame:
    return rows[[stimuli[shown[0]].answer is not None for shown in rows["stimuli"]]]


def _one_placement(rows: pd.DataFrame, stimuli: StimulusSet) -> pd.DataFrame:
    return rows[[stimuli[shown[0]].factors["placement"] == "back" for shown in rows["stimuli"]]]


def _without_times(rows: pd.DataFrame, _: StimulusSet) -> pd.DataFrame:
    return rows.assign(reaction_time_s=np.nan)


def _unchanged(rows: pd.DataFrame, _: StimulusSet) -> pd.DataFrame:
    return rows


@pytest.mark.parametrize(
    ("change", "participants", "expected"),
    [
        (_unchanged, 1, "notice a divergence|reach no mid-point"),
        (_all_right, 4, "it lies below the smallest divergence, 10 deg"),
        (_all_wrong, 4, "it lies above the largest divergence, 90 deg"),
        (_without_controls, 4, "notice a divergence"),
        (_one_placement, 6, "By placement that mid-point is: back"),
        (_without_times, 4, "notice a divergence"),
    ],
)
def test_report_of_odd_data(
    one_condition: Study,
    drawn_set: StimulusSet,
    change: Callable[[pd.DataFrame, StimulusSet], pd.DataFrame],
    participants: int,
    expected: str,
) -> None:
    rows = change(rows_of(one_condition, drawn_set, participants, seed=6), drawn_set)
    analysis = analysis_of(rows, one_condition, drawn_set)
    # Without files, which take half of the time and are the same for all data.
    drawings = {name: figure_bytes(one, "svg") for name, one in analysis.figures().items()}
    page = render(analysis, drawings)
    assert re.search(expected, page)
    assert ("<h2>Salience</h2>" in page) == (analysis.salience is not None)
    assert ("<h2>Time per answer</h2>" in page) == (analysis.times is not None)
    assert not re.search(r"\b(nan|inf|None)\b", re.sub(r"base64,[^\"]+", "", page))
    assert len(figures_of(page)) == len(drawings)


def test_every_table_carries_the_flag(analysis: StudyAnalysis) -> None:
    people = replace(analysis, flow=replace(analysis.flow, who="people"))
    for name, table in study_tables(analysis).items():
        assert table["simulated"].all(), name
        assert not study_tables(people)[name]["simulated"].any()


def test_refuses(study: Study, drawn_set: StimulusSet, tmp_path: Path) -> None:
    path = tmp_path / "responses.sqlite"
    with pytest.raises(InputError, match="there is no response store"):
        analyse(path, tmp_path / "out")
    with Store.open(path) as store:
        with pytest.raises(InputError, match="nothing to analyse yet, the store holds no study"):
            analyse(path, tmp_path / "out")
        store.register(study, drawn_set)
        other = study.model_dump() | {"name": "other"}
        store.register(Study.model_validate(other), drawn_set)
    with pytest.raises(InputError, match="holds lights-synthetic, other; name one of them"):
        analyse(path, tmp_path / "out")
    with pytest.raises(InputError, match="study: 'third' given, the store holds: lights-s"):
        analyse(path, tmp_path / "out", study="third")
    with pytest.raises(InputError, match="nothing to analyse yet"):
        analyse(path, tmp_path / "out", study="other")
    assert not (tmp_path / "out").exists()


def test_unwritable_folder_is_one_clear_line(analysis: StudyAnalysis, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="not a folder that can be written to"):
        write_report(analysis, tmp_path / "file")


def test_the_same_answers_give_the_same_numbers(
    folders: dict[str, Path], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    # Property: analysed again, from the store or from a bundle of it; and what differs is named.
    data = folders["people"].parent / "responses.sqlite"
    bundle = tmp_path / "bundle"
    write_bundle(load_collection(data), bundle)
    for source in (data, bundle):
        assert differences(source, folders["people"]) == []
    with pytest.raises(SystemExit) as ended:
        trompe.main(["analyse", str(bundle), "--out", str(folders["people"]), "--check"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == "the same numbers\n"
    results = json.loads((folders["people"] / "results.json").read_text())
    other = tmp_path / "report"
    other.mkdir()
    results["seed"] = 2
    (other / "results.json").write_text(json.dumps(results))
    seeded = {"verdict", "hit_rates", "salience", "times", "differences"}
    assert set(differences(data, other)) == seeded
    with pytest.raises(InputError, match="there is no report of this Trompe to compare with"):
        differences(data, tmp_path)
