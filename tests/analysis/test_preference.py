import re

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats
from statsmodels.stats.proportion import binom_test, binom_tost

from algorithms.errors import InputError
from analysis.estimates import to_json
from analysis.judgements.preference import Preference, preference
from analysis.judgements.preference_pairs import item_preferences, preferences
from analysis.multiplicity import holm
from benchmarks.judgements import MARGIN, repeated, sizes_single


def of(chosen: int, people: int, margin: float | None = None) -> Preference:
    """One answer a participant."""
    return preference([1] * chosen + [0] * (people - chosen), margin=margin)


@given(st.integers(1, 60), st.data())
def test_agrees_with_statsmodels(people: int, data: st.DataObject) -> None:
    chosen = data.draw(st.integers(0, people))
    margin = data.draw(st.floats(0.02, 0.45))
    found = of(chosen, people, margin)
    assert found.p_value == pytest.approx(binom_test(chosen, people, 0.5))
    larger, *_ = binom_tost(chosen, people, 0.5 - margin, 0.5 + margin)
    assert found.p_equivalence == pytest.approx(larger)


@pytest.mark.parametrize(
    ("chosen", "people", "p_value"),
    [
        (17, 36, 0.8679),  # Lopez-Moreno 2011, sec. 7.5: none chosen above chance
        (12, 17, 0.1435),  # sec. 6.4.2: 70.59 % thought the fog real
        (9, 17, 1.0),  # sec. 6.4.2: 52.94 % gave high scores
        (22, 42, 0.8776),  # sec. 8.7: a difference of 2/42 in preference
        (23, 42, 0.6440),  # sec. 8.7: a difference of 4/42
        (21, 41, 1.0),  # sec. 8.7: a difference of 1/41
    ],
)
def test_published_preferences_are_undecided(chosen: int, people: int, p_value: float) -> None:
    # Published counts: no difference is shown, and no equivalence within 10 points either.
    found = of(chosen, people, margin=0.1)
    assert found.p_value == pytest.approx(p_value, abs=5e-5)
    assert found.outcome == "undecided"


def test_published_limit_is_for_shares_not_for_their_difference() -> None:
    # Sec. 8.7 compares differences of two shares that sum to one with 1.96 * 0.5 / sqrt(42), which
    # is the half width for one share; the difference is twice as far from zero as the share from
    # one half, so its own limit is twice as wide.
    limit = 1.96 * np.sqrt(0.25 / 42)
    assert limit == pytest.approx(0.15121, abs=1e-5)
    share = (1 + 0.09524) / 2
    assert share == pytest.approx(23 / 42, abs=5e-6)
    assert abs(share - 0.5) / limit == pytest.approx(0.09524 / (2 * limit))


@pytest.mark.parametrize(
    ("chosen", "people", "margin", "outcome", "words"),
    [
        (45, 60, None, "differs", "more often than one half (p < 0.001, exact binomial test)."),
        (15, 60, 0.1, "differs", "less often than one half (p < 0.001, exact binomial test)."),
        (560, 1000, 0.1, "differs", "test), although within the margin of 10 percentage points"),
        (201, 400, 0.1, "equivalent", ": within the margin of 10 percentage points around one"),
        (20, 40, 0.1, "undecided", "neither a difference from one half (p = 1.000, exact"),
        (20, 40, None, "undecided", "which does not show that there is none; no margin of"),
    ],
)
def test_three_outcomes_in_words(
    chosen: int, people: int, margin: float | None, outcome: str, words: str
) -> None:
    found = preference([1] * chosen + [0] * (people - chosen), margin=margin, names=("A", "B"))
    assert found.outcome == outcome
    assert words in found.sentence
    assert found.sentence.startswith(f"A was preferred to B in {chosen} of {people} answers (")


@given(st.integers(2, 40), st.integers(1, 6), st.data())
def test_never_says_equal_and_shows_equivalence_only_if_tested(
    people: int, asked: int, data: st.DataObject
) -> None:
    chosen = data.draw(st.lists(st.integers(0, asked), min_size=people, max_size=people))
    margin = data.draw(st.none() | st.floats(0.01, 0.49))
    found = preference(chosen, [asked] * people, margin=margin)
    words = found.sentence.lower()
    assert not re.search(r"\bequal|\bsame\b|indistinguishable", words)
    if found.outcome != "differs":
        assert ("within the margin" in words) == (found.outcome == "equivalent")
    if margin is None:
        assert found.outcome != "equivalent"


@given(st.integers(2, 40), st.integers(1, 6), st.data())
def test_turning_the_pair_turns_the_share_only(
    people: int, asked: int, data: st.DataObject
) -> None:
    chosen = np.array(data.draw(st.lists(st.integers(0, asked), min_size=people, max_size=people)))
    one, other = (
        preference(each, [asked] * people, margin=0.1) for each in (chosen, asked - chosen)
    )
    assert one.p_value == pytest.approx(other.p_value)
    assert one.p_equivalence == pytest.approx(other.p_equivalence)
    assert one.share.low == pytest.approx(1 - other.share.high)


@given(st.integers(2, 60), st.integers(1, 6), st.data())
def test_interval_and_test_never_contradict_each_other(
    people: int, asked: int, data: st.DataObject
) -> None:
    chosen = data.draw(st.lists(st.integers(0, asked), min_size=people, max_size=people))
    found = preference(chosen, [asked] * people)
    excludes = not found.share.low <= 0.5 <= found.share.high
    if abs(found.p_value - 0.05) > 1e-9:
        assert excludes == (found.p_value < 0.05)


def test_several_answers_count_by_participant() -> None:
    # Theory: nine who always prefer the first, in ten answers each, are nine coin flips.
    found = preference([10] * 9, [10] * 9)
    assert found.p_value == pytest.approx(2 * 0.5**9)
    assert found.test == "Wilson-type t-test over participants"
    assert found.participants == 9


@pytest.mark.parametrize("people", [17, 36, 100])
def test_exact_tests_keep_their_size(people: int) -> None:
    # Calibration, summed over the binomial distribution: never above alpha.
    sizes = sizes_single(people)
    assert 0 < sizes["differs"] <= 0.05
    assert sizes["equivalent"] <= 0.05


def test_tests_over_participants_keep_their_size() -> None:
    # Calibration: 2,000 repetitions, binomial error 0.005; at the edge of the margin.
    found = repeated(30, 6, 2000, np.random.default_rng(1))
    assert found["differs"] == pytest.approx(0.05, abs=0.015)
    assert found["equivalent"] <= 0.05 + 0.015
    for share in (0.5, 0.5 + MARGIN, 0.85):
        assert 0.93 <= found[f"covered_{share:g}"] <= 0.97


def answers() -> pd.DataFrame:
    generator = np.random.default_rng(2)
    rows = [
        {"participant": f"p{number}", "style": style, "light": light, "chosen": choice}
        for number in range(40)
        for style, share in (("halftone", 0.5), ("multitone", 0.85), ("colour", 0.5))
        for light in ("similar", "different")
        for choice in generator.binomial(1, share, size=3)
    ]
    return pd.DataFrame(rows)


def test_pairs_are_tested_together() -> None:
    found = preferences(answers(), ["style", "light"], margin=0.15, names=("ours", "true depth"))
    table = found.to_frame()
    assert len(table) == 6
    np.testing.assert_allclose(table["p_holm"], holm(table["p_value"]))
    np.testing.assert_allclose(table["p_equivalence_holm"], holm(table["p_equivalence"]))
    assert set(table.loc[table["style"] == "multitone", "outcome"]) == {"differs"}
    assert found.sentences[0].startswith("colour, different: ours was preferred to true depth in ")
    assert all("; for 6 pairs together p " in sentence for sentence in found.sentences)
    assert "NaN" not in to_json(found)


def test_a_pair_alone_is_not_corrected() -> None:
    table = answers()
    table = table[(table["style"] == "halftone") & (table["light"] == "similar")]
    (only,) = preferences(table, ["style", "light"], margin=0.1).results
    chosen = table.groupby("participant")["chosen"].sum()
    assert only == preference(chosen, [3] * 40, margin=0.1)


def test_answers_missing_are_left_out() -> None:
    table = answers().astype({"chosen": float})
    table.loc[::5, "chosen"] = np.nan
    found = preferences(table, ["style"])
    assert sum(result.answers for result in found.results) == table["chosen"].notna().sum()


@pytest.mark.parametrize("margin", [0, 0.5, -0.1, float("nan")])
def test_refuses_margins(margin: float) -> None:
    with pytest.raises(InputError, match=r"margin: .* given, above 0 and below 0.5 accepted"):
        of(3, 6, margin)


def test_refuses() -> None:
    with pytest.raises(InputError, match="alpha: 1 given, above 0 and below 1 accepted"):
        preference([1, 0], alpha=1)
    with pytest.raises(InputError, match="table: the column light is missing"):
        preferences(answers().drop(columns="light"), ["light"])
    with pytest.raises(InputError, match="table, by: answers, and one column or more"):
        preferences(answers().assign(chosen=None), ["light"])
    with pytest.raises(InputError, match="table, by: answers, and one column or more"):
        preferences(answers(), [])


def test_every_two_of_some_items_are_tested_under_their_names() -> None:
    # Worked by hand: b beats a in three of four answers, wherever it stands; c is in one pair only.
    table = pd.DataFrame(
        [
            ("p1", "a", "b", "b"),
            ("p2", "b", "a", "b"),
            ("p3", "a", "b", "b"),
            ("p4", "b", "a", "a"),
            ("p1", "c", "b", "c"),
            ("p2", "b", "c", None),
        ],
        columns=["participant", "item_a", "item_b", "chosen"],
    )
    found = item_preferences(table, ["a", "b", "c"], margin=0.2)
    assert found.cells["pair"].tolist() == ["a over b", "b over c"]
    assert [(each.chosen, each.answers) for each in found.results] == [(1, 4), (0, 1)]
    assert found.results[0].names == ("a", "b")
    assert found.results[0].tests == 2
    assert found.sentences[0].startswith("a was preferred to b in 1 of 4 answers")
    with pytest.raises(InputError, match="table: the column item_a is missing"):
        item_preferences(table.drop(columns="item_a"), ["a", "b"])


def test_p_value_of_one_participant_is_over_the_answers() -> None:
    assert preference([9], [10]).p_value == pytest.approx(stats.binomtest(9, 10).pvalue)
