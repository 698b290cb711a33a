"""Reports of pairs, rankings and judgements: what they say, of whom, and that it is the truth."""

import base64
import json
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.report.page import analyse, differences
from experiments.simulated.item_observers import (
    NOISE_OF_A_DIFFERENCE,
    ItemObserver,
)
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import Store
from experiments.study import Study, Task
from stimuli.manifest import StimulusSet
from tests.comparison_studies import ITEMS, comparison_study
from tests.drawn_set import draw_set

QUALITIES = {"front": 0.0, "back": 1.0, "front-back": -0.4}


def report_of(
    task: Task, study: Study, stimuli: StimulusSet, folder: Path, participants: int = 6
) -> Path:
    """Simulate a study and return the folder of its report."""
    observer = ItemObserver(QUALITIES, lapse_rate=0.0, criterion=0.2)
    asked = comparison_study(study, task)
    with Store.open(folder / "answers.sqlite") as store:
        generator = np.random.default_rng(9)
        simulate_in_process(asked, stimuli, store, observer, participants, generator)
    analyse(folder / "answers.sqlite", folder / "report")
    return folder / "report"


@pytest.fixture(scope="module")
def pairs(study: Study, drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return report_of("two-alternative", study, drawn_set, tmp_path_factory.mktemp("pairs"))


def with_answers(stimuli: StimulusSet, answers: Sequence[int | None]) -> StimulusSet:
    """Return a set with other right answers."""
    content = stimuli.model_dump()
    for stimulus, answer in zip(content["stimuli"], answers, strict=True):
        stimulus["answer"] = answer
    return StimulusSet.model_validate(content)


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
    found = json.loads((pairs / "results.json").read_text())["preferences"]
    assert [each["names"] for each in found["results"]] == [
        ["front", "back"],
        ["front", "front-back"],
        ["back", "front-back"],
    ]
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


def test_rankings_are_ordered_as_the_observers_see_them(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    report = report_of("ranking", study, drawn_set, tmp_path)
    text = visible_text((report / "report.html").read_text())
    table = pd.read_csv(report / "tables" / "mean-ranks.csv")
    overall = table[table["group"] == "all"]
    assert overall["item"].tolist() == ["back", "front", "front-back"]
    assert overall["mean"].sum() == pytest.approx(6)
    assert "Simulated observers, not people, give these mean ranks (all;" in text
    assert "No Plackett-Luce scale: each participant ranked several sets" in text
    tests = pd.read_csv(report / "tables" / "concordance-tests.csv")
    assert set(tests["test"]) == {"material diffuse", "material shiny"}
    assert not re.search(r"\b(nan|inf|None)\b", text)
    assert differences(tmp_path / "answers.sqlite", report) == []


def test_one_ranking_a_condition_has_a_scale(study: Study, tmp_path: Path) -> None:
    (tmp_path / "set").mkdir()
    stimuli = draw_set(tmp_path / "set", levels_deg=(30,))
    report = report_of("ranking", study, stimuli, tmp_path, participants=12)
    worths = pd.read_csv(report / "tables" / "plackett-luce.csv")
    assert set(worths["group"]) == {"material diffuse", "material shiny"}
    assert worths.groupby("group")["first"].sum().tolist() == pytest.approx([1, 1])
    page = (report / "report.html").read_text()
    assert "First (Plackett-Luce)" in page
    assert not re.search(r"\b(nan|inf|None)\b", visible_text(page))


def test_judgements_tell_photographs_from_the_rest(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    # In this set every image of the placement "back" counts as a true photograph.
    stimuli = with_answers(
        drawn_set, [int(each.factors["placement"] == "back") for each in drawn_set.stimuli]
    )
    report = report_of("yes-no", study, stimuli, tmp_path)
    text = visible_text((report / "report.html").read_text())
    shares = pd.read_csv(report / "tables" / "shares.csv").set_index("item")["share"]
    assert shares["back"] > shares["front"] > shares["front-back"]
    d_prime = pd.read_csv(report / "tables" / "sensitivity.csv").set_index("item")["d_prime"]
    # Theory: yes has z-scores that differ by the difference of qualities over their spread.
    for item, quality in QUALITIES.items():
        if item != "back":
            expected = (QUALITIES["back"] - quality) / (NOISE_OF_A_DIFFERENCE / np.sqrt(2))
            assert d_prime[item] == pytest.approx(expected, abs=0.45)
    assert "Photographs are told from front with d" in text
    assert not re.search(r"\b(nan|inf|None)\b", text)
    assert differences(tmp_path / "answers.sqlite", report) == []


def test_judgements_without_photographs_have_shares_alone(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    stimuli = with_answers(drawn_set, [None] * len(drawn_set.stimuli))
    report = report_of("yes-no", study, stimuli, tmp_path, participants=2)
    text = visible_text((report / "report.html").read_text())
    assert "so there is no d" in text
    assert not (report / "tables" / "sensitivity.csv").exists()


def test_one_participant_gets_what_one_can_give(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    report = report_of("two-alternative", study, drawn_set, tmp_path, participants=1)
    text = visible_text((report / "report.html").read_text())
    assert "none: wins: one observer given, agreement needs two or more" in text
    assert not re.search(r"\b(nan|inf|None)\b", text)


def two_items(
    study: Study, folder: Path, qualities: dict[str, float], participants: int, **design: int
) -> str:
    """Return what the report of two items says that are compared within a declared margin."""
    (folder / "set").mkdir()
    stimuli = draw_set(folder / "set", levels_deg=(30,), placements=tuple(qualities))
    asked = comparison_study(study, "two-alternative", **design)
    asked = Study.model_validate(asked.model_dump() | {"analysis": {"equivalence_margin": 0.15}})
    with Store.open(folder / "answers.sqlite") as store:
        observer = ItemObserver(qualities, lapse_rate=0.0)
        generator = np.random.default_rng(9)
        simulate_in_process(asked, stimuli, store, observer, participants, generator)
    analyse(folder / "answers.sqlite", folder / "report")
    return visible_text((folder / "report" / "report.html").read_text())


def test_two_alike_are_equivalent_within_the_declared_margin(study: Study, tmp_path: Path) -> None:
    # The same images in both places: the truth is one half.
    text = two_items(study, tmp_path, {"ours": 0.0, "theirs": 0.0}, 30, repeats=10)
    table = pd.read_csv(tmp_path / "report" / "tables" / "preferences.csv")
    assert table["material"].tolist() == ["diffuse", "shiny"]
    assert set(table["outcome"]) == {"equivalent"}
    assert "diffuse: ours was preferred to theirs in" in text
    assert "within the margin of 15 percentage points" in text
    assert "There are no score groups" not in text
    assert not re.search(r"\b(nan|inf|None)\b", text)


def test_few_answers_are_undecided_and_nothing_is_called_equal(
    study: Study, tmp_path: Path
) -> None:
    text = two_items(study, tmp_path, {"ours": 0.1, "theirs": 0.0}, 3)
    table = pd.read_csv(tmp_path / "report" / "tables" / "preferences.csv")
    assert set(table["outcome"]) == {"undecided"}
    assert "neither a difference from one half" in text
    # Three people and two items: scores cannot differ by as much as R_c asks for.
    assert "The critical difference cannot be reached" in text
    assert "not reachable" in text
    assert not re.search(r"\b(is|are) (equal|equivalent)\b", text)


def test_an_empty_study_is_one_line(study: Study, drawn_set: StimulusSet, tmp_path: Path) -> None:
    with Store.open(tmp_path / "answers.sqlite") as store:
        store.register(comparison_study(study, "ranking"), drawn_set)
    with pytest.raises(InputError, match="nothing to analyse yet"):
        analyse(tmp_path / "answers.sqlite", tmp_path / "report")
    assert not (tmp_path / "report").exists()
