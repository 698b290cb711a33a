import numpy as np
import pandas as pd
import pytest
from scipy import stats

from algorithms.errors import InputError
from analysis.estimates import to_json
from analysis.judgements.detection import sensitivity
from analysis.judgements.realism import realism


@pytest.fixture
def table() -> pd.DataFrame:
    generator = np.random.default_rng(1)
    rows = [
        {"participant": f"p{number}", "method": method, "answer": answer, "truth": truth}
        for number in range(20)
        for method, rate, truth in (("camera", 0.8, 1), ("ours", 0.7, 0), ("artist", 0.4, 0))
        for answer in generator.binomial(1, rate, size=6)
    ]
    return pd.DataFrame(rows)


def test_shares_and_sensitivities_by_condition(table: pd.DataFrame) -> None:
    found = realism(table, ["method"], photograph="truth")
    shares = found.to_frame().set_index("method")
    expected = table.groupby("method")["answer"].mean()
    np.testing.assert_allclose(shares["share"], expected.loc[shares.index])
    assert shares["kind"].to_dict() == {
        "artist": "processed",
        "camera": "photograph",
        "ours": "processed",
    }
    sums = table.groupby(["method", "participant"])["answer"].sum()
    for method, each in zip(found.conditions["method"], found.sensitivities, strict=True):
        alone = sensitivity(sums["camera"], [6] * 20, sums[method], [6] * 20)
        assert each.d_prime == alone.d_prime
        assert each.criterion == alone.criterion
    assert found.conditions["method"].tolist() == ["artist", "ours"]
    assert found.sensitivity_frame()["d_prime"].is_monotonic_decreasing
    assert (found.participants, found.n) == (20, 360)
    assert "NaN" not in to_json(found)


def test_published_share_of_realism() -> None:
    # Lopez-Moreno 2011, sec. 6.4.2: 12 of 17 thought the image real, one answer each.
    answers = [True] * 12 + [False] * 5
    table = pd.DataFrame({"participant": range(17), "method": "ours", "answer": answers})
    found = realism(table, ["method"])
    row = found.table.iloc[0]
    assert row["share"] == pytest.approx(0.7059, abs=5e-5)
    wilson = stats.binomtest(12, 17).proportion_ci(method="wilson")
    assert (row["low"], row["high"]) == pytest.approx((wilson.low, wilson.high))
    assert row["interval"] == "Wilson"
    assert found.sensitivities == ()


def test_images_of_unknown_kind_have_a_share_only(table: pd.DataFrame) -> None:
    table["truth"] = table["truth"].astype("Int64").mask(table["method"] == "ours")
    found = realism(table, ["method"], photograph="truth")
    assert found.conditions["method"].tolist() == ["artist"]
    assert set(found.table["kind"]) == {"photograph", "processed", "image"}
    nothing = realism(table[table["method"] != "camera"], ["method"], photograph="truth")
    assert nothing.sensitivities == ()
    assert nothing.sensitivity_frame().empty


def test_photographs_of_all_conditions_are_the_signals(table: pd.DataFrame) -> None:
    table = table.assign(scene=["street", "park"] * 180)
    found = realism(table, ["method", "scene"], photograph="truth")
    assert len(found.sensitivities) == 4
    assert {each.signals for each in found.sensitivities} == {120}
    assert {each.noises for each in found.sensitivities} == {60}


def test_missing_answers_are_left_out(table: pd.DataFrame) -> None:
    answers = table["answer"].astype("boolean").mask(table.index % 7 == 0)
    found = realism(table.assign(answer=answers), ["method"], photograph="truth")
    assert found.n == answers.notna().sum()


def test_refuses(table: pd.DataFrame) -> None:
    with pytest.raises(InputError, match="table: the column truth is missing"):
        realism(table.drop(columns="truth"), ["method"], photograph="truth")
    with pytest.raises(InputError, match="by: none given, one column or more"):
        realism(table, [])
    with pytest.raises(InputError, match="table: nothing to analyse, there is no answer"):
        realism(table.assign(answer=None), ["method"])
    with pytest.raises(InputError, match="table: in column answer true, false, 1, 0 or nothing"):
        realism(table.assign(answer=2), ["method"])
    with pytest.raises(InputError, match="table: in column truth true, false, 1, 0 or nothing"):
        realism(table.assign(truth="yes"), ["method"], photograph="truth")
