"""Every kind of bad input ends in one line that names the argument and what is accepted."""

from collections.abc import Callable

import numpy as np
import pandas as pd
import pytest

import analysis
from algorithms.errors import InputError
from analysis.report.study_analysis import analyse_study
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import responses_of, rows_of, sessions_of

NAN = float("nan")
WINS = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]])
UNKNOWN = np.where(WINS > 0, NAN, 0)
GAZE = pd.DataFrame(
    columns=["participant", "session", "trial_index", "time_s", "x_px", "y_px", "valid"]
)


def pairs(*rows: tuple[str, str, str, str], items: list[str] | None = None) -> object:
    table = pd.DataFrame(rows, columns=["participant", "item_a", "item_b", "chosen"])
    return analysis.analyse_pairs(table, np.random.default_rng(1), items=items)


BAD: dict[str, tuple[Callable[[], object], str]] = {
    "consistency of a wrong shape": (
        lambda: analysis.consistency(np.zeros((3, 2))),
        r"wins: shape \(3, 2\) given, \(items, items\) or \(observers, items, items\) accepted",
    ),
    "score groups of a wrong shape": (
        lambda: analysis.score_groups(np.zeros((2, 3, 2))),
        r"wins: shape \(2, 3, 2\) given",
    ),
    "thresholds of lists of other lengths": (
        lambda: analysis.fit_threshold([1, 2], [1], [2, 2], 0.5),
        "levels, correct, total: 2, 1 and 2 entries given, one for each level accepted",
    ),
    "ranks of a wrong shape": (
        lambda: analysis.rank_summary(np.zeros(3)),
        r"ranks: shape \(3,\) given, \(participants, items\)",
    ),
    "preferences of other lengths": (
        lambda: analysis.preference([1, 0], [1, 1, 1]),
        "yes, asked: 2 and 3 entries given",
    ),
    "wins of 2": (lambda: analysis.consistency(WINS * 2), r"wins: 2 at \[0, 1\] given, 0 or 1"),
    "half wins": (
        lambda: analysis.agreement(np.stack([WINS * 0.5, WINS])),
        r"wins: 0\.5 at \[0, 0, 1\] given, 0 or 1 accepted",
    ),
    "both won": (
        lambda: analysis.consistency(np.array([[0, 1, 1], [1, 0, 1], [0, 0, 0]])),
        r"wins: entry \[0, 1\] and its mirror image are both 1, exactly one of them accepted",
    ),
    "none won": (
        lambda: analysis.agreement(np.stack([WINS, np.zeros((3, 3))])),
        r"wins: entry \[1, 0, 1\] and its mirror image are both 0, exactly one of them accepted",
    ),
    "an item against itself": (
        lambda: analysis.scale_pairs(WINS + np.eye(3)),
        r"wins: 1 at \[0, 0\] given, 0 accepted: an item is not compared with itself",
    ),
    "less than no wins": (lambda: analysis.scale_pairs(-WINS), r"wins: -1 at \[0, 1\] given"),
    "a choice that was not shown": (
        lambda: pairs(("p1", "a", "b", "c")),
        "chosen: 'c' given, 'a' or 'b' accepted",
    ),
    "an unknown item": (
        lambda: pairs(("p1", "a", "b", "a"), items=["a", "c"]),
        r"items: 'b' found, one of \['a', 'c'\] accepted",
    ),
    "no pairs": (pairs, "table: nothing to analyse, there is no answer"),
    "no levels": (lambda: analysis.fit_threshold([], [], [], 0.5), "levels: 0 with answers given"),
    "no rankings": (lambda: analysis.rank_summary(np.zeros((0, 3))), r"ranks: shape \(0, 3\)"),
    "no preference": (lambda: analysis.preference([]), "asked: no answer given"),
    "no gaze": (lambda: analysis.fixations_by_velocity(GAZE, 30), "gaze: no sample given"),
    "agreement of one": (
        lambda: analysis.agreement(WINS[None]),
        "wins: one observer given, agreement needs two or more",
    ),
    "a ranking alone": (lambda: analysis.rank_summary([[1, 2, 3]]), r"ranks: shape \(1, 3\)"),
    "a scale where one item wins all": (
        lambda: analysis.scale_pairs(np.stack([WINS] * 4)),
        "wins: item 1 won every comparison, so that no finite scale exists",
    ),
    "rankings all alike": (
        lambda: analysis.plackett_luce([[1, 2, 3]] * 4),
        "ranks: every ranking has 1 ahead of all other items",
    ),
    "NaN in consistency": (lambda: analysis.consistency(UNKNOWN), r"wins: nan at \[0, 1\] given"),
    "NaN in agreement": (
        lambda: analysis.agreement(np.stack([WINS, UNKNOWN])),
        r"wins: nan at \[1, 0, 1\] given",
    ),
    "NaN in score groups": (lambda: analysis.score_groups(UNKNOWN), "wins: nan at"),
    "NaN in a scale": (lambda: analysis.scale_pairs(UNKNOWN), "wins: nan at"),
    "NaN in transitivity": (lambda: analysis.transitivity(UNKNOWN), "wins: nan at"),
    "NaN in levels": (
        lambda: analysis.fit_threshold([1, NAN], [1, 1], [2, 2], 0.5),
        "levels: NaN or infinite entries given, finite numbers accepted",
    ),
    "NaN in right answers": (
        lambda: analysis.largest_level_at_chance([1, 2], [1, NAN], [2, 2], 0.5),
        "correct: NaN or infinite entries given",
    ),
    "NaN in fits of many": (
        lambda: analysis.maximum_likelihood([1, 2], [[1, NAN]], [[2, 2]], 0.5),
        "correct: NaN or infinite entries given",
    ),
    "NaN in ranks": (
        lambda: analysis.rank_summary([[1.0, NAN, 3.0], [1.0, 2.0, 3.0]]),
        "ranks: row 0 has missing ranks, complete rankings accepted",
    ),
    "NaN in preferences": (
        lambda: analysis.preference([1, NAN]),
        "yes: one whole number of 0 or more for each participant accepted",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_one_clear_line(name: str) -> None:
    compute, message = BAD[name]
    with pytest.raises(InputError, match=message) as caught:
        compute()
    assert "\n" not in str(caught.value)


def test_answers_all_alike_that_have_a_result_get_it() -> None:
    # All right and all wrong: the mid-point lies beyond the levels, and is not made up.
    assert analysis.fit_threshold([1, 2, 3], [10] * 3, [10] * 3, 0.5).reached == "below"
    assert analysis.fit_threshold([1, 2, 3], [0] * 3, [10] * 3, 0.5).reached == "above"
    assert analysis.rank_summary([[1, 2, 3]] * 4).concordance.w == 1
    assert analysis.preference([1] * 5).share.high == 1


def test_answers_of_an_unknown_participant_are_refused(
    study: Study, drawn_set: StimulusSet
) -> None:
    rows = rows_of(study, drawn_set, 2, seed=1)
    sessions = sessions_of(rows[rows["participant"] == "P0001"])
    with pytest.raises(InputError, match="responses: participant P0002 has answers but no session"):
        analyse_study(study, drawn_set, sessions, responses_of(rows), seed=1)
