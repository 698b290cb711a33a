"""Answers about pairs, rankings and single images, joined with what was shown."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.answers.comparison_tables import item_names, judgement_table, pair_table, rank_table
from experiments.responses import responses_frame
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import Store
from experiments.study import Study, Task
from stimuli.manifest import StimulusSet
from tests.comparison_studies import ITEMS, comparison_study

OBSERVER = ItemObserver({"front": 0.0, "back": 2.0, "front-back": -2.0})


@pytest.fixture
def answered(study: Study, drawn_set: StimulusSet, store: Store) -> Any:  # noqa: ANN401
    """Return the study of a task and its answers by three simulated participants."""

    def simulate(task: Task) -> tuple[Study, pd.DataFrame]:
        asked = comparison_study(study, task)
        generator = np.random.default_rng(3)
        simulate_in_process(asked, drawn_set, store, OBSERVER, 3, generator)
        return asked, responses_frame(store.responses(study=asked.name))

    return simulate


def test_pairs_say_what_was_shown_and_chosen(answered: Any, drawn_set: StimulusSet) -> None:  # noqa: ANN401
    study, responses = answered("two-alternative")
    table = pair_table(responses, study, drawn_set)
    assert len(table) == len(responses) == 3 * 60
    rows, given = (each.to_dict("records") for each in (table, responses))
    for row, response in zip(rows, given, strict=True):
        left, right = (drawn_set[each].factors for each in response["stimuli"])
        assert (row["item_a"], row["item_b"]) == (left["placement"], right["placement"])
        assert row["chosen"] == (row["item_a"], row["item_b"])[response["answer"] - 1]
        assert row["material"] == left["material"] == right["material"]
        assert float(row["divergence_deg"]) == left["divergence_deg"]
    assert (table["chosen"] == "back").sum() > 0.8 * (2 / 3) * len(table)
    assert item_names(study, drawn_set) == list(ITEMS)


def test_rankings_have_a_column_an_item(answered: Any, drawn_set: StimulusSet) -> None:  # noqa: ANN401
    study, responses = answered("ranking")
    table = rank_table(responses, study, drawn_set)
    assert len(table) == 3 * 20
    assert (table[list(ITEMS)].sum(axis=1) == 6).all()
    assert table["back"].mean() < table["front"].mean() < table["front-back"].mean()


def test_judgements_take_labels_of_regions_for_no_truth(
    answered: Any,  # noqa: ANN401
    drawn_set: StimulusSet,
) -> None:
    study, responses = answered("yes-no")
    table = judgement_table(responses, study, drawn_set)
    assert len(table) == 3 * len(drawn_set.with_role("main"))
    assert set(table["answer"]) == {0, 1}
    for row in table.to_dict("records"):
        stimulus = drawn_set[row["stimulus"]]
        assert row["item"] == stimulus.factors["placement"]
        assert pd.isna(row["truth"])  # this set's answers are labels of regions


def test_answers_that_were_not_given_are_missing(answered: Any, drawn_set: StimulusSet) -> None:  # noqa: ANN401
    study, responses = answered("two-alternative")
    responses.loc[0, "answer"] = None
    table = pair_table(responses.astype({"answer": float}), study, drawn_set)
    assert table["chosen"].isna().tolist()[0]
    assert table["chosen"].notna().sum() == len(table) - 1
    ranking, ranked = answered("ranking")
    ranked.at[0, "answer"] = None  # noqa: PD008  # a cell that may hold a tuple
    ranks = rank_table(ranked, ranking, drawn_set)
    assert ranks["answer"].notna().sum() == ranks["back"].notna().sum() == 3 * 20 - 1


def test_what_does_not_fit_is_refused(answered: Any, drawn_set: StimulusSet) -> None:  # noqa: ANN401
    study, responses = answered("two-alternative")
    with pytest.raises(InputError, match="task: two-alternative given, ranking accepted"):
        rank_table(responses, study, drawn_set)
    with pytest.raises(InputError, match="no main trial"):
        pair_table(responses.assign(phase="practice"), study, drawn_set)
    with pytest.raises(InputError, match="answer: 3 given, 1 to 2 or none accepted"):
        pair_table(responses.assign(answer=3), study, drawn_set)
    other = [("a", "b")] * len(responses)
    with pytest.raises(InputError, match="stimuli: 'a' was shown but is not in the set"):
        pair_table(responses.assign(stimuli=other), study, drawn_set)
    with pytest.raises(InputError, match="column answer is missing"):
        pair_table(responses.drop(columns="answer"), study, drawn_set)
    ranking, ranked = answered("ranking")
    with pytest.raises(InputError, match="the ranks 1 to 3, each once, or none accepted"):
        rank_table(ranked.assign(answer=[(1, 1, 2)] * len(ranked)), ranking, drawn_set)
