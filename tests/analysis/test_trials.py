import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.answers.trials import trial_table
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import rows_of


def test_joins_each_answer_with_what_was_shown(study: Study, drawn_set: StimulusSet) -> None:
    # Property: row for row what the manifest says of the stimulus.
    rows = rows_of(study, drawn_set, 2, seed=1)
    table = trial_table(rows, study, drawn_set)
    main = rows[rows["phase"] == "main"].reset_index(drop=True)
    assert len(table) == len(main) == 2 * 60
    for (_, found), (_, row) in zip(table.iterrows(), main.iterrows(), strict=True):
        stimulus = drawn_set[row["stimuli"][0]]
        assert found["level"] == stimulus.factors["divergence_deg"]
        assert found["placement"] == stimulus.factors["placement"]
        assert found["control"] == (stimulus.answer is None)
        if stimulus.answer is None:
            assert found["correct"] is pd.NA
        else:
            assert found["correct"] == (row["answer"] == stimulus.answer)
        assert found["simulated"]


def test_conditions_keep_the_order_of_the_set(study: Study, drawn_set: StimulusSet) -> None:
    table = trial_table(rows_of(study, drawn_set, 1, seed=1), study, drawn_set)
    assert table["placement"].cat.categories.tolist() == ["front", "back", "front-back"]


def test_no_answer_is_neither_right_nor_wrong(study: Study, drawn_set: StimulusSet) -> None:
    rows = rows_of(study, drawn_set, 1, seed=1)
    rows["answer"] = rows["answer"].astype(object).where(rows["trial_index"] != 10, None)
    table = trial_table(rows, study, drawn_set)
    missed = table[table["trial_index"] == 10]
    assert missed["correct"].isna().all()
    assert missed["answer"].isna().all()


@pytest.mark.parametrize(
    ("column", "value", "message"),
    [
        ("study", "another", "study: rows of 'another' given, 'lights-synthetic' accepted"),
        ("stimuli", ("gone",), "stimuli: 'gone' was shown but is not in the set divergence"),
        ("answer", 9, "answer: 9 given, 1 to 8 or none accepted"),
        ("answer", 2.5, "answer: 2.5 given"),
        ("answer", "left", "answer: 'left' given"),
        ("reaction_time_s", -1.0, "reaction_time_s: -1.0 given, more than 0 or none accepted"),
        ("reaction_time_s", "fast", "reaction_time_s: 'fast' given"),
    ],
)
def test_refuses_a_bad_row(
    study: Study, drawn_set: StimulusSet, column: str, value: object, message: str
) -> None:
    rows = rows_of(study, drawn_set, 1, seed=1)
    values = rows[column].tolist()
    values[20] = value
    rows[column] = pd.Series(values, dtype=object)
    with pytest.raises(InputError, match=message):
        trial_table(rows, study, drawn_set)


def test_refuses_what_is_no_table_of_responses(study: Study, drawn_set: StimulusSet) -> None:
    rows = rows_of(study, drawn_set, 1, seed=1)
    with pytest.raises(InputError, match="responses: nothing to analyse yet, there is no answer"):
        trial_table(rows.iloc[:0], study, drawn_set)
    with pytest.raises(InputError, match="nothing to analyse yet, no main trial"):
        trial_table(rows[rows["phase"] == "practice"], study, drawn_set)
    with pytest.raises(InputError, match="responses: the column answer is missing"):
        trial_table(rows.drop(columns="answer"), study, drawn_set)


def test_refuses_a_study_without_level(study: Study, drawn_set: StimulusSet) -> None:
    rows = rows_of(study, drawn_set, 1, seed=1)
    for change, message in (
        ({"level": None}, "names no level"),
        ({"level": "height"}, "the set divergence has no factor 'height'"),
    ):
        part = study.stimuli.model_copy(update=change)
        with pytest.raises(InputError, match=message):
            trial_table(rows, study.model_copy(update={"stimuli": part}), drawn_set)


def test_a_missing_time_stays_missing(study: Study, drawn_set: StimulusSet) -> None:
    table = trial_table(
        rows_of(study, drawn_set, 1, seed=1).assign(reaction_time_s=np.nan), study, drawn_set
    )
    assert table["reaction_time_s"].isna().all()
