"""Picked objects against chance: theory, enumeration, and a report of known observers."""

import json
from itertools import combinations
from math import comb
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from algorithms.errors import InputError
from analysis.answers.picks import chance_of_picks, pick_table
from analysis.rates.picks import p_above_chance, pick_rates
from analysis.report.page import analyse
from experiments.simulated.observers import Observer, simulate_responses
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import fill_store
from tests.comparison_studies import pick_study
from tests.drawn_set import draw_set


@pytest.fixture(scope="module")
def inserted(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Images without, with one and with two inserted objects."""
    folder = tmp_path_factory.mktemp("inserted")
    drawn = draw_set(folder, levels_deg=(0, 45, 90), placements=("front", "back"))
    changed = []
    for one in drawn.stimuli:
        (*_, label) = one.right_labels or (0,)
        both = (label % 8 + 1, label) if label and one.factors["placement"] == "back" else None
        changed.append(one.model_copy(update={"answer": both or one.answer}))
    return drawn.model_copy(update={"stimuli": tuple(changed)}).write(folder)


@pytest.mark.parametrize(("targets", "picks"), [(1, 1), (1, 2), (2, 1), (2, 2), (2, 3)])
def test_chance_is_that_of_all_draws_counted(targets: int, picks: int) -> None:
    draws = list(combinations(range(8), picks))
    wanted = set(range(targets))
    some = sum(bool(wanted & set(draw)) for draw in draws) / len(draws)
    exact = sum(wanted == set(draw) for draw in draws) / len(draws)
    assert chance_of_picks(8, targets, picks) == pytest.approx((some, exact))


def rates_of(answers: list[tuple[int, ...] | None], people: int) -> dict[Any, Any]:
    """Rates of answers to an image with the objects 1 and 2 inserted, dealt to people in turn."""
    rows = []
    for number, answer in enumerate(answers):
        some, exact = chance_of_picks(8, 2, len(answer or (1,)))
        found = answer and bool({1, 2} & set(answer))
        scores = {"any": found, "exact": answer and answer == (1, 2)}
        chances = {"chance_any": some, "chance_exact": exact}
        who = {"participant": f"P{number % people}", "targets": 2}
        rows.append({**who, "target": (1, 2), "answer": answer, **scores, **chances})
    table = pd.DataFrame(rows).astype({"any": "boolean", "exact": "boolean"})
    generator = np.random.default_rng(1)
    names = {label: f"o{label}" for label in range(1, 9)}
    rates = pick_rates(table, ["targets"], names, generator, 200).table
    return rates.set_index("measure").to_dict("index")


def test_the_exact_test_is_the_binomial_one_where_all_pick_as_many() -> None:
    answers: list[tuple[int, ...] | None] = [(1,)] * 4 + [(5,)] * 6 + [None]
    row = rates_of(answers, people=11)["any"]
    assert (row["hits"], row["answers"], row["chance"]) == (4, 10, 0.25)
    theirs = stats.binomtest(4, 10, 0.25, "greater")  # another implementation
    assert row["p_value"] == pytest.approx(theirs.pvalue)


def test_who_picks_more_has_more_chance_and_the_test_knows() -> None:
    # Counted by hand: one pick found (1/4) and a pair not (13/28); at least one of the two.
    row = rates_of([(1,), (4, 5)], people=2)["any"]
    assert row["p_value"] == pytest.approx(1 - (3 / 4) * (15 / 28))
    assert row["chance"] == pytest.approx((1 / 4 + 13 / 28) / 2)
    exact = rates_of([(1, 2), (1, 3)], people=2)["exact"]
    assert exact["p_value"] == pytest.approx(1 - (1 - 1 / comb(8, 2)) ** 2)


def test_guesses_are_found_above_chance_as_rarely_as_stated() -> None:
    """Twelve people who guess ten times each, one or two of eight objects, two inserted."""
    generator = np.random.default_rng(3)
    chance = np.tile([chance_of_picks(8, 2, picks)[0] for picks in (1, 2)], (12, 5))
    rejected = 0
    for _ in range(2000):
        hits = (generator.random(chance.shape) < chance).sum(axis=1).astype(float)
        expected, answers = chance.sum(axis=1), np.full(12, 10.0)
        p_value, test = p_above_chance(hits, expected, answers, chance.ravel())
        assert test == "score test over participants"
        rejected += p_value < 0.05
    assert stats.binom.ppf(1e-4, 2000, 0.03) <= rejected <= stats.binom.ppf(0.9999, 2000, 0.05)


def test_the_report_finds_what_the_observers_see(
    study: Study, inserted: StimulusSet, tmp_path: Path
) -> None:
    picking = pick_study(study, (1, 2))
    observer = Observer(threshold=45, width=20, lapse_rate=0.0)
    rows = simulate_responses(picking, inserted, observer, 10, np.random.default_rng(4))
    with Store.open(tmp_path / "rows.sqlite") as store:
        fill_store(store, picking, inserted, rows)
    page = analyse(tmp_path / "rows.sqlite", tmp_path / "out").read_text("utf-8")
    assert "SIMULATED" in page
    found = pd.read_csv(tmp_path / "out" / "tables" / "found-by-level.csv")
    exact = found[found["measure"] == "exact"].set_index(["level", "targets"])["rate"]
    assert exact[90, 2] == 1  # both noticed, and no room for a third
    assert exact[90, 1] == pytest.approx(0.5, abs=0.25)  # a second pick half the time
    assert exact[45, 2] < 0.6
    results = json.loads((tmp_path / "out" / "results.json").read_bytes())
    assert results["by_condition"]["by"] == ["level", "targets", "placement", "material"]
    objects = pd.read_csv(tmp_path / "out" / "tables" / "objects.csv")
    shares = objects.groupby("inserted")["rate"].mean()
    assert shares[True] > 0.6 > 0.3 > shares[False]
    for name in ("found", "objects"):
        assert (tmp_path / "out" / "figures" / f"{name}.svg").stat().st_size > 5000
    with pytest.raises(InputError, match=r"answer: \(9,\) given, 1 to 2 labels from 1 to 8"):
        pick_table(rows.assign(answer=rows["answer"].map(lambda _: (9,))), picking, inserted)
