import numpy as np
import pandas as pd
import pytest
from statsmodels.stats.proportion import proportion_confint

from algorithms.errors import InputError
from analysis.bootstrap import sum_by_participant
from analysis.judgements.shares import Binomial, check_answers, share_interval, share_table

NAN = float("nan")


@pytest.mark.parametrize("binomial", ["clopper-pearson", "wilson"])
@pytest.mark.parametrize(("yes", "people"), [(0, 12), (17, 36), (36, 36)])
def test_one_answer_each_agrees_with_statsmodels(binomial: Binomial, yes: int, people: int) -> None:
    answers = check_answers([1] * yes + [0] * (people - yes))
    estimate, name = share_interval(answers, binomial)
    method = {"clopper-pearson": "beta", "wilson": "wilson"}[binomial]
    low, high = proportion_confint(yes, people, method=method)
    np.testing.assert_allclose(
        (estimate.low, estimate.value, estimate.high), (low, yes / people, high), atol=1e-12
    )
    assert name == {"clopper-pearson": "Clopper-Pearson", "wilson": "Wilson"}[binomial]


def test_several_answers_each_are_not_independent() -> None:
    # Theory: if all answers of a participant are alike, only participants count.
    alike, name = share_interval(check_answers([9] * 80 + [0] * 80, [9] * 160))
    single, _ = share_interval(check_answers([1] * 80 + [0] * 80))
    assert name == "Wilson-type, over participants"
    assert alike.high - alike.low == pytest.approx(single.high - single.low, rel=0.02)


def test_one_participant_stands_for_no_other() -> None:
    _, name = share_interval(check_answers([7], [10]))
    assert name == "Wilson, answers of one participant"


def test_table_has_the_interval_of_each_cell() -> None:
    table = pd.DataFrame(
        {
            "participant": list("abcabc"),
            "method": ["ours"] * 3 + ["artist"] * 3,
            "real": [1, 0, 1, 1, 1, 1],
        }
    )
    table = pd.concat([table, table[table["method"] == "artist"]])
    found = share_table(sum_by_participant(table, "real", ["method"])).set_index("method")
    assert found["yes"].to_dict() == {"artist": 6, "ours": 2}
    assert found["participants"].to_dict() == {"artist": 3, "ours": 3}
    assert found["interval"].to_dict() == {
        "artist": "Wilson-type, over participants",
        "ours": "Wilson",
    }
    assert found["low"].to_dict()["artist"] == pytest.approx(0.025 ** (1 / 3))


def test_leaves_out_who_was_never_asked() -> None:
    answers = check_answers([1, 0, 0], [1, 1, 0])
    assert answers.asked.tolist() == [1, 1]
    assert answers.independent


@pytest.mark.parametrize(
    ("yes", "asked", "message"),
    [
        ([1, 2], [1, 1], "yes: more than the participant was asked given"),
        ([1, 0.5], None, "yes: one whole number of 0 or more for each participant accepted"),
        ([1, NAN], None, "yes: one whole number of 0 or more for each participant accepted"),
        ([[1, 0]], None, "yes: one whole number of 0 or more for each participant accepted"),
        (["a"], None, "yes: not a sequence of numbers"),
        ([1, 0], [1], "yes, asked: 2 and 1 entries given, one a participant accepted"),
        ([0, 0], [0, 0], "asked: no answer given, one or more accepted"),
        ([], None, "asked: no answer given, one or more accepted"),
    ],
)
def test_refuses(yes: list[float], asked: list[float] | None, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_answers(yes, asked)


def test_refuses_another_interval() -> None:
    with pytest.raises(InputError, match="binomial: 'wald' given, one of"):
        share_interval(check_answers([1, 0]), "wald")  # type: ignore[arg-type]
