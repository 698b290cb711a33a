import math
from itertools import permutations, product

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from algorithms.errors import InputError
from analysis.paired.score_groups import (
    david_chi_square,
    group_scores,
    score_groups,
    underlined,
    underlined_table,
)
from analysis.paired.score_range import (
    RangeDistribution,
    critical_difference,
    exact_is_feasible,
    exact_range,
    simulated_range,
    toss,
)
from tests.analysis.published_pairs import TASTE
from tests.analysis.test_consistency import coins, every_tournament

ORDER = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]])
CIRCLE = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])


def test_critical_difference_of_the_thesis() -> None:
    # Published: Lopez-Moreno 2011, sec. 7.5.1: 24 at t = 3, n = 44, alpha = 0.01 (W = 4.12).
    formula = critical_difference(3, 44, 0.01)
    assert formula == pytest.approx(23.92, abs=0.005)
    assert math.ceil(formula) == 24
    assert math.ceil(critical_difference(3, 4 * 44, 0.01)) == 48


def test_exact_critical_difference_is_one_more() -> None:
    # Theory: method notes: coins reach 24 with probability 0.01012, more than the 0.01 asked for.
    exact = exact_range(3, 44)
    assert exact.tail[24] == pytest.approx(0.01012, abs=5e-6)
    assert exact.critical(0.01) == 25
    result = score_groups([ORDER] * 44, alpha=0.01)
    assert (result.critical, result.exact_critical, result.null_method) == (24, 25, "exact")
    assert result.formula_size == pytest.approx(0.01012, abs=5e-6)
    assert score_groups([ORDER] * 44, alpha=0.01, critical="exact").critical == 25


def test_formula_is_asymptotic() -> None:
    # Theory: method notes: at t = 5, n = 15, alpha = 0.05 the formula splits 0.053 of equal items.
    rounded = math.ceil(critical_difference(5, 15, 0.05))
    simulated = simulated_range(5, 15, np.random.default_rng(1))
    assert simulated.tail[rounded] == pytest.approx(0.0526, abs=0.002)


@pytest.mark.parametrize(("items", "observers"), [(2, 3), (3, 3), (4, 2), (5, 1)])
def test_exact_range_is_that_of_all_tournaments(items: int, observers: int) -> None:
    # Brute force over every tournament of every observer.
    scores = every_tournament(items).sum(axis=2)
    ranges = [
        np.ptp(scores[list(chosen)].sum(axis=0))
        for chosen in product(range(len(scores)), repeat=observers)
    ]
    tail = exact_range(items, observers).tail
    assert tail.size == observers * (items - 1) + 1
    for least, probability in enumerate(tail):
        assert probability == pytest.approx(np.mean(np.array(ranges) >= least), abs=1e-12)


def test_two_items_are_a_sign_test() -> None:
    # Another implementation: scipy's two-sided binomial test.
    for wins in range(8, 17):
        p_value = exact_range(2, 16).p_value(2 * wins - 16)
        assert p_value == pytest.approx(stats.binomtest(wins, 16).pvalue)


def test_simulated_range_agrees_with_the_exact_one() -> None:
    exact, simulated = exact_range(4, 12), simulated_range(4, 12, np.random.default_rng(2), 40_000)
    error = np.sqrt(exact.tail * (1 - exact.tail) / 40_000)
    assert (np.abs(simulated.tail - exact.tail) <= 4 * error + 1e-4).all()
    assert simulated.method == "simulated, 40000 times"


@pytest.mark.parametrize("number", [1, 5, 64, 65, 176])
def test_coins_are_fair(number: int) -> None:
    heads = toss(np.random.default_rng(number), number, (20_000,))
    assert heads.mean() == pytest.approx(number / 2, abs=4 * math.sqrt(number / 80_000))
    assert heads.var() == pytest.approx(number / 4, rel=0.05)
    assert heads.max() <= number


def test_draws_count_what_was_observed_among_them() -> None:
    drawn = RangeDistribution(np.array([1.0, 0.5, 0.0]), "permuted", draws=99)
    assert drawn.p_value(2) == 0.01
    assert drawn.critical(0.01) == 2
    assert drawn.critical(0.009) is None


def test_groups_are_maximal_runs_and_may_overlap() -> None:
    table, groups = group_scores([10, 60, 40, 25, 61], "abcde", 20)
    assert table["item"].tolist() == ["e", "b", "c", "d", "a"]
    assert groups == (("e", "b"), ("c", "d"), ("d", "a"))
    assert table["groups"].tolist() == ["a", "a", "b", "bc", "c"]
    # A difference of exactly the critical one is significant: b and c differ by 20.
    assert group_scores([20, 0], "ab", 20)[1] == (("a",), ("b",))
    assert group_scores([20, 0], "ab", 21)[1] == (("a", "b"),)
    assert group_scores([20, 0], "ab", None)[1] == (("a", "b"),)


@given(st.lists(st.integers(0, 30), min_size=2, max_size=9), st.integers(1, 20))
def test_two_items_share_a_group_if_and_only_if_they_do_not_differ(
    scores: list[int], critical: int
) -> None:
    items = [str(k) for k in range(len(scores))]
    _, groups = group_scores(scores, items, critical)
    assert {item for group in groups for item in group} == set(items)
    for one, other in product(range(len(scores)), repeat=2):
        together = any({str(one), str(other)} <= set(group) for group in groups)
        assert together == (abs(scores[one] - scores[other]) < critical)
    for group in groups:
        assert not any(set(group) < set(larger) for larger in groups)


def test_overall_test_is_davids() -> None:
    # Theory: D = 4 sum (a - mean)^2 / (n t); with two items the squared sign statistic. The taste
    # data of David 1988, p. 116: scores 7, 26, 22, 35 of 15 judges.
    assert TASTE.sum(axis=1).tolist() == [7, 26, 22, 35]
    assert david_chi_square([7, 26, 22, 35], 15) == pytest.approx(4 * 409 / 60)
    assert david_chi_square([12, 4], 16) == pytest.approx((12 - 4) ** 2 / 16)
    result = score_groups([ORDER] * 6 + [CIRCLE])
    assert result.p_value == pytest.approx(stats.chi2.sf(result.chi_square, 2))
    assert result.freedom == 2


def test_overall_test_is_friedmans_for_orders() -> None:
    # Another implementation: if everybody is consistent, Friedman's statistic is D times
    # 3 / (t + 1), since orders spread the scores more than coins do.
    generator = np.random.default_rng(3)
    ranks = np.array([generator.permutation(4) for _ in range(12)])
    wins = (ranks[:, :, None] > ranks[:, None, :]).astype(int)
    result = score_groups(wins, generator=generator)
    friedman = stats.friedmanchisquare(*ranks.T)
    assert result.chi_square * 3 / 5 == pytest.approx(friedman.statistic)
    assert result.permuted_p_value == pytest.approx(friedman.pvalue, abs=0.04)


def test_permuted_range_is_that_of_all_permutations() -> None:
    # Brute force: three orders, each in any of six arrangements.
    scores = [np.array(order) for order in permutations((0, 1, 2))]
    ranges = np.array([np.ptp(np.add(np.add(a, b), c)) for a, b, c in product(scores, repeat=3)])
    result = score_groups([ORDER] * 3, generator=np.random.default_rng(4), permutations=40_000)
    assert result.permuted_range_p_value == pytest.approx(np.mean(ranges >= 6), abs=0.005)
    assert (result.permutations, result.seed) == (40_000, 4)


def test_permutation_keeps_an_observers_tournaments_together() -> None:
    # Theory: four copies of one observer's order are no more evidence than one: range 8 is certain.
    wins = [ORDER] * 4
    together = score_groups(
        wins, observers=["p"] * 4, critical="permuted", generator=np.random.default_rng(5)
    )
    assert (together.permuted_range_p_value, together.observers, together.n) == (1, 1, 4)
    assert together.critical is None
    assert together.groups == (("1", "2", "3"),)
    apart = score_groups(wins, generator=np.random.default_rng(5))
    assert apart.permuted_range_p_value < 0.02


def test_a_difference_that_cannot_be_reached_is_said() -> None:
    result = score_groups([ORDER] * 2, alpha=0.01, items=["a", "b", "c"])
    assert result.critical is None
    assert result.groups == (("a", "b", "c"),)
    assert result.remark == (
        "The critical difference cannot be reached: 6 is needed at alpha = 0.01,"
        " 4 is the largest possible difference of two scores."
    )
    assert underlined(result).endswith(result.remark)
    assert score_groups([ORDER] * 20).remark == ""


def test_rendering_underlines_each_group() -> None:
    wins = np.array([np.triu(np.ones((4, 4), dtype=int), k=1)] * 6)
    result = score_groups(wins, items=["ours", "photon map", "silhouette", "none"])
    assert result.critical == 10
    assert underlined(result) == (
        "ours (18)  photon map (12)  silhouette (6)  none (0)\n"
        "──────────────────────────\n"
        "           ───────────────────────────────\n"
        "                            ────────────────────────"
    )
    assert underlined_table({"bull": result, "skull": result}).split("\n\n")[1].startswith("skull")


def test_table_holds_scores_and_letters() -> None:
    frame = score_groups([ORDER] * 20, items=["a", "b", "c"]).to_frame()
    expected = {"item": ["a", "b", "c"], "score": [40, 20, 0], "groups": ["a", "b", "c"]}
    pd.testing.assert_frame_equal(frame, pd.DataFrame(expected))


def test_what_needs_a_generator_is_left_out_or_refused() -> None:
    wins = coins(np.random.default_rng(6), 20, 8)
    assert not exact_is_feasible(8, 20)
    result = score_groups(wins)
    assert result.null_method.startswith("left out")
    assert (result.exact_critical, result.permuted_critical, result.seed) == (None, None, None)
    assert np.isnan([result.formula_size, result.range_p_value, result.permuted_p_value]).all()
    simulated = score_groups(wins, generator=np.random.default_rng(7), critical="exact")
    assert simulated.null_method == "simulated, 100000 times"
    assert simulated.critical == simulated.exact_critical
    for critical in ("exact", "permuted"):
        with pytest.raises(InputError, match=f"generator: needed for critical='{critical}'"):
            score_groups(wins, critical=critical)


def test_same_seed_same_result() -> None:
    wins = coins(np.random.default_rng(8), 9, 4)
    one, other = (score_groups(wins, generator=np.random.default_rng(9)) for _ in range(2))
    assert one.permuted_range_p_value == other.permuted_range_p_value
    assert one.permuted_critical == other.permuted_critical


def test_refuses() -> None:
    with pytest.raises(InputError, match="alpha: 0 given, above 0 and below 1 accepted"):
        score_groups([ORDER], alpha=0)
    with pytest.raises(InputError, match="critical: 'tukey' given, formula, exact or permuted"):
        score_groups([ORDER], critical="tukey")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"items: .* given, 3 different names accepted"):
        score_groups([ORDER], items=["a", "b"])
    with pytest.raises(InputError, match="observers: 1 given, one for each of 2 tournaments"):
        score_groups([ORDER] * 2, observers=["p"])
    with pytest.raises(InputError, match=r"wins: .* both 0"):
        score_groups([[0, 1, 1], [0, 0, 0], [0, 0, 0]])
