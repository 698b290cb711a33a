import itertools
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.ranking.comparisons import (
    compare_ranks,
    critical_difference,
    maximal_runs,
    p_conover,
    p_nemenyi,
)
from analysis.ranking.ranks import Rankings, check_ranks
from tests.analysis.rankings import DIURETICS, RUNNERS

# Sachs 1997, p. 675, as R's PMCMRplus prints Nemenyi's p-values (lower triangle by row).
NEMENYI = (
    *(0.1880,),
    *(0.0917, 0.9996),
    *(0.9996, 0.3388, 0.1880),
    *(0.0395, 0.9898, 0.9996, 0.0917),
    *(0.0016, 0.6363, 0.8200, 0.0052, 0.9400),
)


def test_nemenyi_as_published() -> None:
    found = p_nemenyi(DIURETICS)
    np.testing.assert_allclose(found[np.tril_indices(6, -1)], NEMENYI, atol=6e-5)


@pytest.mark.parametrize(
    ("items", "critical"),
    [(2, 1.960), (3, 2.343), (4, 2.569), (5, 2.728), (6, 2.850), (8, 3.031), (10, 3.164)],
)
def test_critical_difference_as_published(items: int, critical: float) -> None:
    # Demsar 2006, table 5a: q at alpha = 0.05, cut after three decimals.
    error = np.sqrt(items * (items + 1) / (6 * 20))
    assert critical_difference(20, items) / error == pytest.approx(critical, abs=1.1e-3)


def conover_by_hand(ranks: Matrix) -> Matrix:
    """Conover 1999, p. 371: t-tests of rank sums, Holm-adjusted."""
    n, k = ranks.shape
    sums, freedom = ranks.sum(axis=0), (n - 1) * (k - 1)
    error = np.sqrt(2 * (n * (ranks**2).sum() - (sums**2).sum()) / freedom)
    pairs = list(itertools.combinations(range(k), 2))
    raw = [2 * stats.t.sf(abs(sums[one] - sums[other]) / error, freedom) for one, other in pairs]
    adjusted, largest = np.ones((k, k)), 0.0
    for place, number in enumerate(np.argsort(raw)):
        largest = max(largest, min(1.0, (len(raw) - place) * raw[number]))
        one, other = pairs[number]
        adjusted[one, other] = adjusted[other, one] = largest
    return adjusted


@pytest.mark.parametrize("ranks", [RUNNERS, DIURETICS], ids=["runners", "diuretics"])
def test_conover_is_the_textbook_formula(ranks: Matrix) -> None:
    np.testing.assert_allclose(p_conover(ranks), conover_by_hand(ranks), rtol=1e-6, atol=1e-12)


def test_table_names_pairs_in_order_of_mean_rank() -> None:
    rankings = Rankings(DIURETICS, tuple("ABCDEF"))
    found = compare_ranks(rankings)
    means = dict(zip("ABCDEF", DIURETICS.mean(axis=0), strict=True))
    row = found.table[(found.table["item"] == "A") & (found.table["other"] == "F")].iloc[0]
    assert row["difference"] == pytest.approx(means["A"] - means["F"])
    assert row["high"] - row["difference"] == pytest.approx(found.critical_difference)
    assert row["p_nemenyi"] == pytest.approx(0.0016, abs=6e-5)
    assert (found.table["difference"] <= 0).all()
    # The difference excludes zero where the test finds one.
    np.testing.assert_array_equal(found.table["high"] < 0, found.table["p_nemenyi"] < 0.05)


def test_groups_overlap_and_follow_the_test() -> None:
    # Sachs' example by the p-values above: A and D differ from F, A from E.
    found = compare_ranks(Rankings(DIURETICS, tuple("ABCDEF")))
    assert found.groups == (("A", "D", "B", "C"), ("D", "B", "C", "E"), ("B", "C", "E", "F"))
    assert found.differ("A", "E")
    assert found.differ("F", "D")
    assert not found.differ("A", "C")
    more = compare_ranks(Rankings(DIURETICS, tuple("ABCDEF")), posthoc="conover")
    assert more.groups == (("A", "D"), ("B", "C", "E"), ("C", "E", "F"))


def test_all_rankings_alike() -> None:
    # Conover's variance is zero there; Nemenyi's is that of the null hypothesis.
    found = compare_ranks(check_ranks(np.tile([1, 2, 3], (5, 1))), posthoc="conover")
    assert found.groups == (("1",), ("2",), ("3",))
    assert compare_ranks(check_ranks(np.tile([1, 2, 3], (5, 1)))).groups == (
        ("1", "2"),
        ("2", "3"),
    )


@given(st.integers(1, 6), st.integers(0, 2**15 - 1))
def test_runs_are_the_longest_without_a_difference(size: int, bits: int) -> None:
    # Brute force over all runs.
    differs = np.zeros((size, size), dtype=bool)
    for place, (one, other) in enumerate(itertools.combinations(range(size), 2)):
        differs[one, other] = differs[other, one] = bool(bits >> place & 1)
    alike = {
        (first, last)
        for first in range(size)
        for last in range(first, size)
        if not differs[first : last + 1, first : last + 1].any()
    }
    longest = [
        run
        for run in sorted(alike)
        if not any(run != other and other[0] <= run[0] and run[1] <= other[1] for other in alike)
    ]
    assert [(run.start, run.stop - 1) for run in maximal_runs(differs)] == longest


def test_refuses() -> None:
    rankings = check_ranks(DIURETICS)
    with pytest.raises(InputError, match="posthoc: 'tukey' given, 'nemenyi' or 'conover' accepted"):
        compare_ranks(rankings, posthoc="tukey")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="alpha: 1 given, above 0 and below 1 accepted"):
        compare_ranks(rankings, alpha=1)
    with pytest.raises(InputError, match=re.escape("item, other: '1' and '9' given")):
        compare_ranks(rankings).differ("1", "9")
