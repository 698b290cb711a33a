import numpy as np
import pytest

from algorithms.errors import InputError
from analysis.exclusions import apply_rule, select_sessions
from analysis.study_analysis import analyse_study
from analysis.trials import trial_table
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
