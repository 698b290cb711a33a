"""Studies that compare or judge images: designs, answers, observers, and what is refused."""

import json
from collections import Counter
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from scipy.special import ndtr
from typer.testing import CliRunner

from algorithms.errors import InputError
from experiments.answers import Measurement, make_response
from experiments.cli import app
from experiments.ordering import Order, is_ranking
from experiments.planning.designs import ordered
from experiments.planning.trials import Assignment, Trial, planned_trials
from experiments.responses import Session, load_responses
from experiments.simulated.item_observers import NOISE_OF_A_DIFFERENCE, ItemObserver
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import NewSession, Store
from experiments.study import Study, Task, load_study
from stimuli.manifest import StimulusSet
from tests.comparison_studies import ITEMS, as_toml, comparison_study, pick_study

NOT_MEASURED = Measurement(1.0, None, None, None, None, "none")
QUALITIES = {"front": 0.0, "back": 1.0, "front-back": -0.5}
TASKS: tuple[Task, ...] = ("two-alternative", "ranking", "yes-no")


def main_trials(study: Study, stimuli: StimulusSet, number: int = 1) -> list[Trial]:
    """Return one participant's main trials."""
    trials = planned_trials(study, stimuli, Assignment(number))
    return [trial for trial in trials if trial.phase == "main"]


@given(number=st.integers(1, 1000), repeats=st.integers(1, 3))
def test_pairs_are_all_there_and_left_and_right_are_balanced(
    study: Study, drawn_set: StimulusSet, number: int, repeats: int
) -> None:
    paired = comparison_study(study, "two-alternative", repeats=repeats)
    shown = [trial.stimuli for trial in main_trials(paired, drawn_set, number)]
    counts = Counter(frozenset(pair) for pair in shown)
    assert len(counts) == 20 * 3  # levels x materials, each with the pairs of three placements
    assert set(counts.values()) == {repeats}
    for pair in counts:
        factors = [drawn_set[identifier].factors for identifier in pair]
        assert factors[0]["divergence_deg"] == factors[1]["divergence_deg"]
        assert factors[0]["material"] == factors[1]["material"]
        assert factors[0]["placement"] != factors[1]["placement"]
        # Over the rounds a pair stands either way equally often, or once more.
        ways = Counter(each for each in shown if frozenset(each) == pair)
        assert max(ways.values()) - (min(ways.values()) if len(ways) == 2 else 0) <= 1
    canonical = {pair: tuple(sorted(pair)) for pair in counts}
    turned = sum(each != canonical[frozenset(each)] for each in shown[:60])
    assert 15 <= turned <= 45


def test_no_image_follows_itself_in_pairs(study: Study, drawn_set: StimulusSet) -> None:
    paired = comparison_study(study, "two-alternative", repeats=2)
    for number in range(1, 30):
        shown = [set(trial.stimuli) for trial in main_trials(paired, drawn_set, number)]
        assert sum(bool(one & other) for one, other in pairwise(shown)) <= 2


def test_first_places_are_balanced_to_one_in_each_round() -> None:
    pairs = [(f"{i}", f"{i}x") for i in range(9)]
    for seed in range(20):
        shown = ordered(pairs, 2, np.random.default_rng(seed))
        turned = [pair[0].endswith("x") for pair in shown]
        assert abs(sum(turned[:9]) - 4.5) == 0.5
        assert sum(turned) == 9
        assert {frozenset(pair) for pair in shown[:9]} == {frozenset(pair) for pair in pairs}


@given(number=st.integers(1, 1000))
def test_sets_are_complete_and_shuffled(study: Study, drawn_set: StimulusSet, number: int) -> None:
    ranking = comparison_study(study, "ranking")
    trials = main_trials(ranking, drawn_set, number)
    assert len(trials) == 20
    for trial in trials:
        placements = [drawn_set[identifier].factors["placement"] for identifier in trial.stimuli]
        assert sorted(map(str, placements)) == sorted(ITEMS)
    assert len({tuple(np.argsort(trial.stimuli)) for trial in trials}) > 1


@given(data=st.data(), count=st.integers(2, 9))
def test_ranks_are_those_of_a_competition(data: st.DataObject, count: int) -> None:
    """Theory: a rank is 1 and the number of images in places before those that it is tied to."""
    order = Order.as_shown(count)
    places = st.integers(0, count - 1)
    for source, target in data.draw(st.lists(st.tuples(places, places), max_size=6)):
        order = order.moved(source, target)
    for place in data.draw(st.lists(places, max_size=6)):
        order = order.with_tie_changed(place)
    ranks = order.ranks()
    assert is_ranking(ranks, ties=True)
    assert is_ranking(ranks, ties=False) == (not order.tied)
    assert [ranks[image] for image in order.images] == sorted(ranks)
    tied = [
        place
        for place in range(1, count)
        if len({ranks[i] for i in order.images[place - 1 : place + 1]}) == 1
    ]
    assert set(tied) == order.tied


@pytest.mark.parametrize("ranks", [(2, 3, 1), (1, 1, 2), (0, 1), (2, 2, 3), (1, 3, 3, 3)])
def test_only_ranks_of_a_competition_are_rankings(ranks: tuple[int, ...]) -> None:
    assert is_ranking(ranks, ties=True) == (ranks in {(2, 3, 1)})


def test_two_images_of_one_item_cannot_be_compared(study: Study, drawn_set: StimulusSet) -> None:
    paired = comparison_study(study, "two-alternative")
    stimuli = paired.stimuli.model_copy(update={"within": ("material",)})
    wrong = paired.model_copy(update={"stimuli": stimuli})
    with pytest.raises(InputError, match=r"stimuli\.within: .* are both placement front of one"):
        planned_trials(wrong, drawn_set, Assignment(1))


@pytest.mark.parametrize(
    ("task", "change", "message"),
    [
        ("two-alternative", {"design": {"kind": "factorial", "seed": 1}}, "design.kind: 'fact"),
        ("ranking", {"design": {"kind": "pairs", "seed": 1}}, "the task ranking takes 'sets'"),
        ("ranking", {"stimuli": {"set": "divergence"}}, "stimuli.item: missing"),
        ("yes-no", {"stimuli": {"set": "divergence", "item": "x", "within": ["y"]}}, "within: the"),
        ("yes-no", {"stimuli": {"set": "divergence", "item": "x", "choices": 8}}, "choices: the"),
        ("odd-one-out", {"design": {"kind": "factorial", "seed": 1}}, "choices: missing"),
        ("free-viewing", {}, "stimuli.item: the task free-viewing has no use for it"),
        ("free-viewing", {"stimuli": {"set": "divergence"}}, "timing.image_s: missing"),
    ],
)
def test_studies_that_do_not_fit_their_task_are_refused(
    study: Study, task: Task, change: dict[str, Any], message: str
) -> None:
    content = comparison_study(study, "yes-no").model_dump(mode="json")
    if task not in ("yes-no", "free-viewing"):
        content = comparison_study(study, "ranking" if task == "odd-one-out" else task).model_dump(
            mode="json"
        )
    with pytest.raises(ValidationError, match=message):
        Study.model_validate(content | {"task": task} | change)


def test_keys_that_came_later_do_not_change_older_studies(study: Study) -> None:
    # Our own past: the digest of this study before comparisons were added to the model.
    assert study.digest == "b1c9ec49357dc7b52c07b34167925d2553a37b80dd1307af194c82d872faad74"
    assert comparison_study(study, "ranking").digest != study.digest


@pytest.mark.parametrize(
    ("task", "right", "wrong"),
    [
        ("two-alternative", (1, 2), (0, 3, (1, 2))),
        ("yes-no", (0, 1), (2, -1, (1,))),
        ("ranking", ((3, 1, 2),), (1, (1, 2), (1, 1, 2), (0, 1, 2), (1, 2, 3, 4))),
        ("pick", ((2,), (1, 8)), (2, (), (0,), (9,), (3, 1), (2, 2), (1, 2, 3))),
    ],
)
def test_answers_are_those_of_the_task(
    study: Study,
    drawn_set: StimulusSet,
    store: Store,
    task: Task,
    right: tuple[Any, ...],
    wrong: tuple[Any, ...],
) -> None:
    asked = pick_study(study, (1, 2)) if task == "pick" else comparison_study(study, task)
    store.register(asked, drawn_set)
    new = NewSession("simulation", "test", {}, {}, simulated=True)
    session, _ = store.begin_session(asked, drawn_set, new)
    for index, answer in enumerate(right):
        response = make_response(asked, drawn_set, session, index, answer, NOT_MEASURED)
        assert store.record(response)
        assert not store.record(response)  # known for what it is
        assert store.answers(session.id)[index] == answer
    assert [one.answer for one in store.responses(study=asked.name)] == list(right)
    for answer in (*wrong, None):
        with pytest.raises(InputError, match=r"^answer: .* accepted$"):
            make_response(asked, drawn_set, session, 5, answer, NOT_MEASURED)


def simulated(
    study: Study, stimuli: StimulusSet, store: Store, observer: ItemObserver, participants: int
) -> list[Session]:
    """Return the sessions of simulated participants, from a fixed seed."""
    generator = np.random.default_rng(1)
    return simulate_in_process(study, stimuli, store, observer, participants, generator)


def test_pairs_are_preferred_as_thurstone_says(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    # Theory: P(A over B) = Phi((a - b) / noise), which is 75 % at one JOD.
    paired = comparison_study(study, "two-alternative")
    observer = ItemObserver(QUALITIES, lapse_rate=0.0)
    sessions = simulated(paired, drawn_set, store, observer, 40)
    assert all(session.completed_at and session.simulated for session in sessions)
    wins: Counter[tuple[str, str]] = Counter()
    for response in store.responses(study=paired.name):
        assert response.runner == "simulation"
        items = [str(drawn_set[shown].factors["placement"]) for shown in response.stimuli]
        assert isinstance(response.answer, int)
        wins[items[response.answer - 1], items[2 - response.answer]] += 1
    assert pytest.approx(0.75) == ndtr(1 / NOISE_OF_A_DIFFERENCE)
    for one, other in combinations(ITEMS, 2):
        count = wins[one, other] + wins[other, one]
        assert count == 40 * 20
        expected = float(ndtr((QUALITIES[one] - QUALITIES[other]) / NOISE_OF_A_DIFFERENCE))
        margin = 4 * np.sqrt(expected * (1 - expected) / count)
        assert wins[one, other] / count == pytest.approx(expected, abs=margin)


def test_rankings_and_judgements_follow_quality(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    observer = ItemObserver({name: 3 * value for name, value in QUALITIES.items()}, criterion=1.0)
    ranking = comparison_study(study, "ranking")
    simulated(ranking, drawn_set, store, observer, 10)
    ranks: dict[str, list[int]] = {item: [] for item in ITEMS}
    for response in store.responses(study=ranking.name):
        assert isinstance(response.answer, tuple)
        for shown, rank in zip(response.stimuli, response.answer, strict=True):
            ranks[str(drawn_set[shown].factors["placement"])].append(rank)
    means = {item: np.mean(values) for item, values in ranks.items()}
    assert means["back"] < means["front"] < means["front-back"]
    assert sum(means.values()) == pytest.approx(6)
    judged = comparison_study(study, "yes-no")
    simulated(judged, drawn_set, store, observer, 10)
    table = load_responses(store.engine.url.render_as_string(), judged.name)
    table["item"] = [str(drawn_set[shown[0]].factors["placement"]) for shown in table["stimuli"]]
    rates = table.assign(answer=table["answer"].astype(float)).groupby("item")["answer"].mean()
    noise = NOISE_OF_A_DIFFERENCE / np.sqrt(2)
    for item in ITEMS:
        expected = 0.98 * ndtr((3 * QUALITIES[item] - 1) / noise) + 0.02 * 0.5
        assert rates[item] == pytest.approx(expected, abs=0.12)


def test_first_places_and_people_can_differ(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    paired = comparison_study(study, "two-alternative")
    observer = ItemObserver(dict.fromkeys(ITEMS, 0.0), position_bias=2.0, spread=0.0)
    simulated(paired, drawn_set, store, observer, 5)
    first = np.mean([response.answer == 1 for response in store.responses(study=paired.name)])
    assert first > 0.8
    people = [
        ItemObserver(QUALITIES, spread=2.0).participant(np.random.default_rng(seed))
        for seed in range(200)
    ]
    deviation = np.std([person.qualities["back"] for person in people])
    assert deviation == pytest.approx(2.0, rel=0.2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"spread": -1.0}, "spread: -1.0 given, 0 to inf accepted"),
        ({"lapse_rate": 1.5}, "lapse_rate: 1.5 given, 0 to 1 accepted"),
        ({"median_time_s": 0.0}, "median_time_s: 0.0 given, more than 0 accepted"),
    ],
)
def test_impossible_observers_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        ItemObserver(QUALITIES, **change)


def test_items_without_a_quality_and_other_tasks_are_refused(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    with pytest.raises(InputError, match="qualities: none is given for placement"):
        simulated(comparison_study(study, "ranking"), drawn_set, store, ItemObserver({}), 1)
    with pytest.raises(InputError, match="task: odd-one-out given"):
        simulated(study, drawn_set, store, ItemObserver(QUALITIES), 1)
    with pytest.raises(InputError, match="participants: 0 given"):
        simulated(comparison_study(study, "ranking"), drawn_set, store, ItemObserver({}), 0)


def test_the_command_simulates_comparisons(
    study: Study, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    toml = as_toml(comparison_study(study, "two-alternative"))
    (tmp_path / "pairs.toml").write_text(toml, encoding="utf-8")
    common = ["simulate", str(tmp_path / "pairs.toml"), "--stimuli", str(drawn_set.folder)]
    data = str(tmp_path / "answers.sqlite")
    options = ["--data", data, "--qualities", "front=0,back=1,front-back=2", "--participants", "3"]
    told = CliRunner().invoke(app, [*common, *options, "--json"])
    assert json.loads(told.output) == {"simulated_sessions": 3, "seed": 2011}
    assert load_study(tmp_path / "pairs.toml").task == "two-alternative"
    assert len(load_responses(data)) == 3 * 60
    refused = CliRunner().invoke(app, [*common, "--data", data])
    assert "qualities: needed to simulate two-alternative" in str(refused.exception)
