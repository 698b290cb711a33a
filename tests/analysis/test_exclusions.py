import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.answers.exclusions import apply_rule, describe_rule, exclude, select_sessions
from analysis.answers.trials import trial_table
from analysis.report.study_analysis import analyse_study
from experiments.responses import Event
from experiments.study import Exclusion, Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import responses_of, rows_of, sessions_of

RULE = Exclusion(incomplete=True, shortest_median_s=0.3)


def test_people_go_first_and_are_never_mixed(study: Study, drawn_set: StimulusSet) -> None:
    simulated = sessions_of(rows_of(study, drawn_set, 3, seed=1))
    people = sessions_of(rows_of(study, drawn_set, 2, seed=1), simulated=False)
    pilots = sessions_of(rows_of(study, drawn_set, 1, seed=1), simulated=False, pilot=True)
    everybody = [*simulated, *people, *pilots]
    assert select_sessions(everybody) == (people, "people", {"pilot": 1, "simulated": 3})
    assert select_sessions(everybody, "simulated") == (
        simulated,
        "simulated",
        {"pilot": 1, "people": 2},
    )
    chosen, _, left_out = select_sessions(everybody, include_pilot=True)
    assert (chosen, left_out) == ([*people, *pilots], {"simulated": 3})


def test_people_who_have_not_finished_do_not_hide_simulated_ones(
    study: Study, drawn_set: StimulusSet
) -> None:
    simulated = sessions_of(rows_of(study, drawn_set, 3, seed=1))
    begun = sessions_of(rows_of(study, drawn_set, 1, seed=1), simulated=False, completed_at=None)
    assert select_sessions([*begun, *simulated])[1] == "simulated"
    assert select_sessions(begun)[1] == "people"


def test_nobody_is_one_clear_line(study: Study, drawn_set: StimulusSet) -> None:
    simulated = sessions_of(rows_of(study, drawn_set, 3, seed=1))
    with pytest.raises(InputError, match=r"nothing to analyse yet: no session of people .*3 sim"):
        select_sessions(simulated, "people")
    with pytest.raises(InputError, match="nothing to analyse yet"):
        select_sessions([])


def test_the_declared_rule_and_its_reasons(study: Study, drawn_set: StimulusSet) -> None:
    rows = rows_of(study, drawn_set, 5, seed=1)
    fast = rows["participant"] == "P0002"
    rows["reaction_time_s"] = np.where(fast, 0.2, rows["reaction_time_s"])
    rows = rows[rows["participant"] != "P0005"]
    sessions = sessions_of(rows_of(study, drawn_set, 5, seed=1))
    sessions[2] = sessions_of(rows[rows["participant"] == "P0003"], completed_at=None)[0]
    withdrawal = Event(sessions[3].id, "withdrawal", {}, "2026-01-01T00:00:00.000+00:00")
    table = trial_table(rows, study, drawn_set)
    reasons = {
        one.participant: one.reason for one in apply_rule(RULE, sessions, table, [withdrawal])
    }
    assert reasons == {
        "P0002": "median time per answer below 0.3 s",
        "P0003": "did not finish",
        "P0004": "withdrew",
        "P0005": "gave no answer",
    }
    lenient = apply_rule(Exclusion(incomplete=False), sessions, table)
    assert [one.participant for one in lenient] == ["P0005"]


def test_the_flow_adds_up(study: Study, drawn_set: StimulusSet) -> None:
    rows = rows_of(study, drawn_set, 4, seed=2)
    sessions = sessions_of(rows)
    sessions[0] = sessions_of(rows[rows["participant"] == "P0001"], completed_at=None)[0]
    older = sessions_of(rows_of(study, drawn_set, 2, seed=3), study_digest="older")
    result = analyse_study(study, drawn_set, [*sessions, *older], responses_of(rows), seed=1)
    flow = result.flow
    assert (flow.recruited, flow.completed, flow.analysed) == (4, 3, 3)
    assert flow.recruited - len(flow.excluded) == flow.analysed
    assert flow.left_out == {"of other versions of the study or its stimuli": 2}
    assert set(result.trials["participant"]) == {"P0002", "P0003", "P0004"}
    frame = flow.to_frame()
    assert frame["step"].tolist() == [
        "recruited",
        "completed",
        "excluded: did not finish",
        "analysed",
    ]
    assert frame["simulated"].all()


def test_nobody_left_is_one_clear_line(study: Study, drawn_set: StimulusSet) -> None:
    rows = rows_of(study, drawn_set, 2, seed=2)
    with pytest.raises(
        InputError, match="nothing to analyse yet: 2 began, 0 finished, none is left"
    ):
        analyse_study(
            study, drawn_set, sessions_of(rows, completed_at=None), responses_of(rows), seed=1
        )


def strict_study(study: Study) -> Study:
    """The study with every part of a rule, and without conditions: one fit."""
    rule = {"catch_level": 80, "least_catch_share": 0.6, "largest_late_share": 0.25}
    content = study.model_dump()
    content["stimuli"]["conditions"] = ()
    return Study.model_validate(content | {"exclusion": rule})


def test_catch_trials_and_late_frames_decide_who_counts(
    study: Study, drawn_set: StimulusSet
) -> None:
    strict = strict_study(study)
    rows = rows_of(strict, drawn_set, 4, seed=2).assign(dropped_frames=0)
    labels = {stimulus.id: stimulus.answer for stimulus in drawn_set.stimuli}
    right = rows["stimuli"].map(lambda shown: labels[shown[0]])
    # The first answers as a coin would, the second always rightly, the third with late frames in
    # three of ten trials; who measured no frames cannot have late ones.
    rows["answer"] = np.where(right.notna(), right.fillna(1), rows["answer"]).astype(int)
    wrong = (rows["participant"] == "P0001") & (rows.index % 2 == 0)
    rows.loc[wrong, "answer"] = rows.loc[wrong, "answer"] % study.choices + 1
    rows["dropped_frames"] = rows["dropped_frames"].astype(float)
    late = (rows["participant"] == "P0003") & (rows.index % 10 < 3)
    rows.loc[late, "dropped_frames"] = 2.0
    rows.loc[rows["participant"] == "P0004", "dropped_frames"] = np.nan
    result = analyse_study(strict, drawn_set, sessions_of(rows), responses_of(rows), seed=1)
    assert {one.participant: one.reason for one in result.flow.excluded} == {
        "P0001": "right in less than 60 % of the catch trials",
        "P0003": "late frames in over 25 % of the trials",
    }
    # Catch trials are in no result; controls, at level 0, are none.
    assert result.trials["level"].max() == 70
    assert result.trials["level"].min() == 0


def test_a_rule_in_words() -> None:
    assert describe_rule(Exclusion(incomplete=False)) == "nobody"
    words = describe_rule(
        Exclusion(
            shortest_median_s=0.3, catch_level=80, least_catch_share=0.6, largest_late_share=0.25
        ),
        "deg",
    )
    assert words == (
        "who did not finish; whose median time per answer is below 0.3 s; who was right in less"
        " than 60 % of the catch trials (80 deg and above); who saw late frames in over 25 % of"
        " trials"
    )


def own_answers() -> pd.DataFrame:
    """Three people of five answers: the second is quick, the third misses both catch trials."""
    return pd.DataFrame(
        {
            "participant": np.repeat(["ada", "bob", "cid"], 5),
            "reaction_time_s": np.repeat([2.0, 0.1, 2.0], 5),
            "catch": [False, False, False, True, True] * 3,
            "correct": [True] * 13 + [False] * 2,
        }
    )


def test_the_rule_holds_for_tables_of_ones_own() -> None:
    rule = Exclusion(shortest_median_s=0.3, least_catch_share=0.5)
    kept, flow = exclude(own_answers(), rule)
    assert kept["participant"].tolist() == ["ada"] * 3
    assert (flow.recruited, flow.completed, flow.analysed, flow.who) == (3, 3, 1, "people")
    assert flow.to_frame()["step"].tolist() == [
        "recruited",
        "completed",
        "excluded: median time per answer below 0.3 s",
        "excluded: right in less than 50 % of the catch trials",
        "analysed",
    ]
    begun = own_answers().assign(completed=lambda table: table["participant"] != "ada")
    with pytest.raises(InputError, match="3 participants, none is left after the exclusions"):
        exclude(begun, rule)


@pytest.mark.parametrize("missing", ["participant", "reaction_time_s", "correct", "catch"])
def test_own_tables_that_lack_a_column_are_refused(missing: str) -> None:
    rule = Exclusion(shortest_median_s=0.3, least_catch_share=0.5)
    with pytest.raises(InputError, match=f"table: the column {missing} is missing"):
        exclude(own_answers().drop(columns=missing), rule)


def test_an_empty_table_of_ones_own_is_refused() -> None:
    with pytest.raises(InputError, match="nothing to analyse, there is no answer"):
        exclude(own_answers().head(0), Exclusion())
