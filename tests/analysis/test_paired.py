import math
from itertools import combinations

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.estimates import to_json
from analysis.paired.agreement import agreement, agreement_over
from analysis.paired.agreement_table import PUBLISHED, agreement_table, published_agreement
from analysis.paired.consistency import group_consistency
from analysis.paired.every_result import analyse_pairs
from analysis.paired.score_groups import score_groups

SCENES, ANGLES = ("bull", "skull"), (0, 60)
ITEMS = ("ours", "photon", "silhouette")


@pytest.fixture(scope="module")
def answers() -> pd.DataFrame:
    """The answers of 12 simulated people to all pairs in two scenes from two angles."""
    generator = np.random.default_rng(1)
    merit = {"bull": (1.2, 1.0, -1.0), "skull": (0.0, 0.0, 0.0)}
    rows = []
    for person in range(12):
        for scene in SCENES:
            taste = merit[scene] + generator.normal(0, 0.5, 3)
            for angle in ANGLES:
                for one, other in combinations(range(3), 2):
                    gap = taste[one] - taste[other] + generator.normal()
                    chosen = ITEMS[one] if gap > 0 else ITEMS[other]
                    rows.append((f"p{person}", scene, angle, ITEMS[other], ITEMS[one], chosen))
    columns = ["participant", "scene", "angle", "item_a", "item_b", "chosen"]
    return pd.DataFrame(rows, columns=columns)


def wins_of(answers: pd.DataFrame, scene: str, angle: int) -> np.ndarray:
    """Return the tournaments of a cell, counted by hand."""
    part = answers[(answers["scene"] == scene) & (answers["angle"] == angle)]
    people = sorted(set(part["participant"]))
    wins = np.zeros((len(people), 3, 3), dtype=int)
    for name, one, other, chosen in part[["participant", "item_a", "item_b", "chosen"]].to_numpy():
        loser = one if chosen == other else other
        wins[people.index(name), ITEMS.index(chosen), ITEMS.index(loser)] = 1
    return wins


def test_table_by_scene_is_the_mean_over_angles(answers: pd.DataFrame) -> None:
    result = agreement_table(answers, "scene", ["angle"])
    assert result.table["scene"].tolist() == ["bull", "skull"]
    for scene, row in result.table.set_index("scene").iterrows():
        cells = [wins_of(answers, str(scene), angle) for angle in ANGLES]
        by_cell = [agreement(cell).u.value for cell in cells]
        assert row["u"] == pytest.approx(np.mean(by_cell))
        assert row["u_p_value"] == agreement_over(cells).p_value
        zeta = group_consistency(np.concatenate(cells)).table["zeta"]
        assert row["mean_zeta"] == pytest.approx(zeta.mean())
        assert (row["participants"], row["tournaments"]) == (12, 24)
        assert (row["chance_zeta"], row["minimum_u"]) == (0.75, -1 / 11)


def test_table_by_angle(answers: pd.DataFrame) -> None:
    result = agreement_table(answers, "angle", ["scene"])
    assert result.table["angle"].tolist() == ["0", "60"]
    assert (result.by, result.within) == ("angle", ("scene",))


def test_incomplete_participants_are_named_or_left_out(answers: pd.DataFrame) -> None:
    part = answers.drop(index=0)  # p0 misses a pair of the bull
    with pytest.raises(InputError, match="participant p0 did not compare every pair once in scene"):
        agreement_table(part, "scene", ["angle"])
    result = agreement_table(part, "scene", ["angle"], drop_incomplete=True)
    assert result.dropped == {"bull": ("p0",)}
    assert result.table["participants"].tolist() == [11, 12]


def test_published_table_is_shown_with_what_cannot_be() -> None:
    # Published: Lopez-Moreno 2011, table 7.2; theory: 44 observers have u of -1/43 or more, and
    # coins a zeta of 0.75 with three items.
    table = published_agreement().set_index("value")
    assert len(table) == len(PUBLISHED) == 8
    assert table["minimum_u"].unique().tolist() == [-1 / 43]
    assert table.index[~table["possible"]].tolist() == ["skull", "vertebrae"]
    assert "u is impossible: of 44 observers it is -0.0233 or more" in table["remark"]["skull"]
    assert "zeta is not told from the 0.75 of coins (p = 0.13)" in table["remark"]["skull"]
    assert "zeta" not in table["remark"]["vertebrae"]
    assert (table["remark"][["dolphin", "bull", "0", "60", "120", "180"]] == "").all()


def test_the_whole_analysis_is_that_of_its_parts(answers: pd.DataFrame) -> None:
    bull = answers[answers["scene"] == "bull"]
    result = analyse_pairs(bull, np.random.default_rng(2), within=["angle"])
    cells = [wins_of(answers, "bull", angle) for angle in ANGLES]
    assert (result.items, len(result.participants), result.answers) == (ITEMS, 12, 72)
    assert result.left_out == {}
    assert result.consistency is not None
    assert (result.consistency.n, result.consistency.tournaments) == (12, 24)
    assert result.agreement is not None
    assert result.agreement.u == agreement_over(cells).u
    assert result.groups is not None
    assert (result.groups.n, result.groups.observers) == (24, 12)
    expected = score_groups(np.concatenate(cells), items=ITEMS)
    pd.testing.assert_frame_equal(result.groups.table, expected.table)
    assert result.scale is not None
    assert (result.scale.observers, result.scale.n) == (12, 72)
    assert result.transitivity is not None
    assert result.transitivity.tested == 1


def test_same_seed_same_json(answers: pd.DataFrame) -> None:
    one, other = (
        to_json(analyse_pairs(answers, np.random.default_rng(3), within=["scene", "angle"]))
        for _ in range(2)
    )
    assert one == other


def test_what_the_answers_do_not_allow_is_left_out_and_said(answers: pd.DataFrame) -> None:
    repeated = analyse_pairs(answers, np.random.default_rng(4))  # scenes and angles not split
    assert len(repeated.incomplete) == 12
    assert (repeated.consistency, repeated.agreement, repeated.groups) == (None, None, None)
    assert repeated.left_out["groups"].startswith("table: no participant compared every pair once")
    assert repeated.scale is not None

    one_pair = answers[(answers["item_a"] == "photon") & (answers["angle"] == 0)]
    result = analyse_pairs(one_pair[one_pair["scene"] == "bull"], np.random.default_rng(4))
    assert set(result.left_out) == {"consistency", "transitivity"}
    assert result.agreement is not None

    alone = answers[answers["participant"] == "p0"].assign(chosen=answers["item_b"])
    result = analyse_pairs(alone, np.random.default_rng(4), within=["scene", "angle"])
    assert result.left_out["agreement"] == "wins: one observer given, agreement needs two or more"
    assert "no finite scale" in result.left_out["scale"]


def test_one_who_missed_a_pair_is_in_the_scale_only(answers: pd.DataFrame) -> None:
    part = answers[answers["scene"] == "bull"].reset_index(drop=True)
    part.loc[0, "chosen"] = math.nan
    result = analyse_pairs(part, np.random.default_rng(5), within=["angle"])
    assert (result.unanswered, result.answers, result.incomplete) == (1, 71, ("p0",))
    assert result.groups is not None
    assert result.groups.observers == 11
    assert result.scale is not None
    assert (result.scale.n, result.scale.observers) == (71, 12)


def test_refuses(answers: pd.DataFrame) -> None:
    generator = np.random.default_rng(6)
    with pytest.raises(InputError, match="table: the column angel is missing"):
        analyse_pairs(answers, generator, within=["angel"])
    with pytest.raises(InputError, match="alpha: 2 given"):
        analyse_pairs(answers, generator, alpha=2)
    with pytest.raises(InputError, match="model: 'elo' given"):
        analyse_pairs(answers, generator, model="elo")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="table: the column place is missing"):
        agreement_table(answers, "place")
    with pytest.raises(InputError, match="table: nothing to analyse"):
        agreement_table(answers.iloc[:0], "scene")
    with pytest.raises(InputError, match="1 participants with every pair in scene bull, two or"):
        agreement_table(answers[answers["participant"] == "p1"], "scene", ["angle"])
