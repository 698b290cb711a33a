"""Designs beyond single lists: subsets, blocks, catch trials, and who gets which order."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from algorithms.errors import InputError
from analysis.answers.exclusions import apply_rule, catch_answers
from experiments.planning.designs import block_order, block_rows, drawn_subset, next_number
from experiments.planning.right_answers import is_right, right_answer
from experiments.planning.trials import Assignment, Trial, planned_trials
from experiments.responses import responses_frame
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import NewSession, Store
from experiments.study import Study, check_stimuli
from experiments.study_parts import Design
from stimuli.manifest import StimulusSet
from tests.comparison_studies import ITEMS, comparison_study

WORST_LAST = {"better": "front", "worse": "front-back", "trials": 5}
NEW = NewSession("web", "test", {}, {})


def changed(study: Study, **parts: object) -> Study:
    return Study.model_validate(study.model_dump(mode="json") | parts)


@given(number=st.integers(1, 500))
def test_a_subset_has_each_level_once_and_repeats_nothing(
    study: Study, drawn_set: StimulusSet, number: int
) -> None:
    design = {"kind": "factorial", "seed": 3, "one_of_each": "placement", "distinct": "target"}
    drawn = changed(study, design=design)
    trials = planned_trials(drawn, drawn_set, Assignment(number))
    shown = [drawn_set[trial.stimuli[0]].factors for trial in trials if trial.phase == "main"]
    assert Counter(each["placement"] for each in shown) == dict.fromkeys(ITEMS, 1)
    assert len({each["target"] for each in shown}) == 3


def test_every_subset_of_a_crossed_set_is_as_likely(drawn_set: StimulusSet) -> None:
    """Theory: 3 levels by 3 others have 6 draws, each with probability 1/6."""
    design = Design(seed=0, one_of_each="row", distinct="column")
    stimuli = [
        drawn_set.stimuli[0].model_copy(update={"factors": {"row": row, "column": column}})
        for row in range(3)
        for column in range(3)
    ]
    generator, draws = np.random.default_rng(1), 3000
    counts = Counter(
        tuple(stimulus.factors["column"] for stimulus in drawn_subset(design, stimuli, generator))
        for _ in range(draws)
    )
    assert len(counts) == 6
    deviation = np.sqrt(draws * 5 / 36)
    assert all(abs(count - draws / 6) < 5 * deviation for count in counts.values())


def test_a_subset_that_cannot_be_is_refused(drawn_set: StimulusSet) -> None:
    design = Design(seed=0, one_of_each="placement", distinct="material")
    with pytest.raises(InputError, match=r"^design\.distinct: there are not enough levels"):
        drawn_subset(design, drawn_set.with_role("main"), np.random.default_rng(1))


@pytest.mark.parametrize("blocks", range(1, 9))
def test_orders_of_blocks_are_a_balanced_latin_square(blocks: int) -> None:
    """Williams 1949: each block equally often in each place, and after each other block."""
    orders = [block_order(blocks, number + 1) for number in range(block_rows(blocks))]
    for place in zip(*orders, strict=True):
        assert set(Counter(place).values()) == {len(orders) // blocks}
    after = Counter(pair for order in orders for pair in pairwise(order))
    assert len(after) == blocks * (blocks - 1)
    assert len(set(after.values())) <= 1


def test_blocks_come_one_after_the_other(study: Study, drawn_set: StimulusSet) -> None:
    blocked = changed(study, design={"kind": "factorial", "seed": 1, "blocks": "placement"})
    firsts = set()
    for number in range(1, 7):
        trials = planned_trials(blocked, drawn_set, Assignment(number))
        main = [drawn_set[t.stimuli[0]].factors["placement"] for t in trials if t.phase == "main"]
        assert len(main) == 60
        assert sum(one != other for one, other in pairwise(main)) == 2
        firsts.add(main[0])
    assert firsts == set(ITEMS)


@given(taken=st.dictionaries(st.integers(1, 60), st.booleans()), rows=st.integers(1, 8))
def test_the_next_participant_gets_the_order_that_fewest_finished(
    taken: dict[int, bool], rows: int
) -> None:
    number = next_number(taken, rows)
    assert number > max(taken, default=0)
    finished = Counter(each % rows for each, done in taken.items() if done)
    assert finished[number % rows] == min(finished[row] for row in range(rows))


def test_who_leaves_is_made_up_for(study: Study, drawn_set: StimulusSet, store: Store) -> None:
    """Three orders of blocks and their reverses; only some participants finish."""
    blocked = changed(study, design={"kind": "factorial", "seed": 1, "blocks": "placement"})
    store.register(blocked, drawn_set)
    generator = np.random.default_rng(3)
    rows = []
    for _ in range(60):
        session, _ = store.begin_session(blocked, drawn_set, NEW)
        if generator.random() < 0.6:
            store.complete(session.id)
            rows.append(session.participant_number % 6)
    counts = Counter(rows)
    assert len(counts) == 6
    assert max(counts.values()) - min(counts.values()) <= 1


@pytest.mark.parametrize("task", ["two-alternative", "ranking"])
def test_catch_trials_stand_among_the_main_ones(
    study: Study, drawn_set: StimulusSet, task: str
) -> None:
    rule = {"exclusion": {"least_catch_share": 0.8}}
    plain = comparison_study(study, task)  # type: ignore[arg-type]
    only = plain.stimuli.model_dump(mode="json") | {"only": {"placement": ["front", "back"]}}
    caught = changed(plain, catch=WORST_LAST, stimuli=only, **rule)
    check_stimuli(caught, drawn_set)
    places = []
    for number in range(1, 30):
        trials = planned_trials(caught, drawn_set, Assignment(number))
        main = [trial for trial in trials if trial.phase == "main"]
        catch = [trial for trial in trials if trial.phase == "catch"]
        assert len(main) == 20
        assert len(catch) == len({frozenset(trial.stimuli) for trial in catch}) == 5
        for trial in main:
            items = {drawn_set[each].factors["placement"] for each in trial.stimuli}
            assert items == {"front", "back"}
        for trial in catch:
            items = {drawn_set[each].factors["placement"] for each in trial.stimuli}
            assert items == {"front", "front-back"} | ({"back"} if task == "ranking" else set())
        places += [trial.index for trial in catch]
    assert 0 in places
    assert 24 in places


def test_right_answers_follow_from_the_declared_order(study: Study, drawn_set: StimulusSet) -> None:
    order = {"practice": {"trials": 0, "best_first": ["back", "front", "front-back"]}}
    ranking = changed(comparison_study(study, "ranking"), **order)
    pairs = changed(comparison_study(study, "two-alternative"), **order)
    by_item = {str(s.factors["placement"]): s.id for s in drawn_set.with_role("practice")}
    shown = tuple(by_item[item] for item in ("front", "back", "front-back"))
    ranked = Trial(0, "practice", shown)
    assert right_answer(ranking, drawn_set, ranked) == (2, 1, 3)
    assert is_right(ranking, drawn_set, ranked, (2, 1, 3))
    assert not is_right(ranking, drawn_set, ranked, (1, 2, 3))
    pair = Trial(0, "practice", shown[:2])
    assert right_answer(pairs, drawn_set, pair) == 2
    assert right_answer(comparison_study(study, "two-alternative"), drawn_set, pair) is None


def test_who_guesses_in_catch_trials_is_left_out(
    study: Study, drawn_set: StimulusSet, store: Store
) -> None:
    """Observers who see a large difference pass; those who always guess do not (P < 2 %)."""
    paired = changed(
        comparison_study(study, "two-alternative"),
        catch={**WORST_LAST, "trials": 20},
        exclusion={"least_catch_share": 0.8},
    )
    seeing = ItemObserver({"front": 9.0, "back": 8.0, "front-back": 0.0}, lapse_rate=0.0)
    guessing = ItemObserver(dict.fromkeys(ITEMS, 0.0), lapse_rate=1.0)
    generator = np.random.default_rng(5)
    for observer in (seeing, guessing):
        simulate_in_process(paired, drawn_set, store, observer, 3, generator)
    rows = responses_frame(store.responses())
    caught = catch_answers(rows, paired, drawn_set)
    main = rows[rows["phase"] == "main"]
    excluded = apply_rule(paired.exclusion, store.sessions(), main, caught=caught)
    assert [each.participant for each in excluded] == ["P0004", "P0005", "P0006"]
    assert {each.reason for each in excluded} == {"right in less than 80 % of the catch trials"}


@pytest.mark.parametrize(
    ("task", "parts", "message"),
    [
        ("ranking", {"catch": WORST_LAST}, "exclusion.least_catch_share: missing"),
        ("yes-no", {"catch": WORST_LAST}, "catch: the task yes-no has no use"),
        ("yes-no", {"design": {"seed": 1, "distinct": "target"}}, "design.one_of_each, distinct"),
        ("ranking", {"timing": {"image_s": 1}}, "timing.image_s: the task ranking has no use"),
        ("two-alternative", {"timing": {"mask_s": 1}}, "timing.image_s: missing"),
        ("yes-no", {"timing": {"image_s": 3, "time_limit_s": 2}}, "timing.image_s: 3 given"),
        ("two-alternative", {"answers": {"ties": True}}, "answers.ties: the task two-alternative"),
        ("two-alternative", {"answers": {"labels": ["a", "b"]}}, "answers.labels: the task"),
        ("yes-no", {"practice": {"trials": 0, "best_first": ["a"]}}, "practice.best_first: the"),
    ],
)
def test_rules_that_do_not_fit_are_refused(
    study: Study, task: str, parts: dict[str, object], message: str
) -> None:
    with pytest.raises(ValidationError, match=message):
        changed(comparison_study(study, task), **parts)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"design": {"kind": "pairs", "seed": 1, "blocks": "colour"}}, "design.blocks: the study"),
        (
            {"stimuli": {"set": "divergence", "item": "placement", "only": {"material": ["x"]}}},
            "stimuli.only.material: the study says x",
        ),
        (
            {"stimuli": {"set": "divergence", "item": "placement", "only": {"x": [1]}}},
            "stimuli.only: the study says x",
        ),
    ],
)
def test_designs_that_do_not_fit_the_set_are_refused(
    study: Study, drawn_set: StimulusSet, parts: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        check_stimuli(changed(comparison_study(study, "two-alternative"), **parts), drawn_set)
