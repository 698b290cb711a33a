import numpy as np
import pytest

from algorithms.errors import InputError
from analysis.paired.scale_fit import MODELS, Model, differences
from analysis.paired.transitivity import KINDS, transitivity
from tests.analysis.published_pairs import CELEBRITIES, DOG


def proportions(over: dict[tuple[int, int], int]) -> np.ndarray:
    """Return wins of 100 answers a pair."""
    wins = np.zeros((3, 3), dtype=int)
    for (one, other), share in over.items():
        wins[one, other], wins[other, one] = share, 100 - share
    return wins


def test_the_celebrities_of_rumelhart_and_greeno() -> None:
    # Published: weak and moderate stochastic transitivity hold, strong does not (documentation of
    # strans() in R's package eba).
    result = transitivity(CELEBRITIES)
    assert (result.violations["weak"], result.violations["moderate"]) == (0, 0)
    assert result.violations["strong"] == 34
    assert result.tested == 84


def test_weak_transitivity_of_one_observer_counts_circular_triads() -> None:
    # Theory: proportions of 0 and 1; the dog of Kendall and Babington Smith has five.
    result = transitivity(DOG, ["meat", "biscuit", "chocolate", "apple", "pear", "cheese"])
    assert set(result.violations.values()) == {5}
    circles = result.table[~result.table["weak"]]
    assert {"meat", "apple"} <= set(circles.iloc[0][["first", "second", "third"]])


@pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: model.title)
def test_every_scale_is_strongly_transitive(model: Model) -> None:
    # Theory: for any F that rises, p is larger the larger the difference.
    values = np.random.default_rng(1).normal(size=7)
    shares = model.probability(differences(values))
    wins = np.rint(1e6 * shares) * (1 - np.eye(7))
    assert set(transitivity(wins).violations.values()) == {0}


@pytest.mark.parametrize(
    ("last", "holds"),
    [
        (85, (True, True, True)),
        (80, (True, True, True)),
        (70, (True, True, False)),
        (60, (True, True, False)),
        (55, (True, False, False)),
        (50, (True, False, False)),
        (49, (False, False, False)),
    ],
)
def test_the_three_kinds(last: int, holds: tuple[bool, bool, bool]) -> None:
    # Theory: majorities of 60 and 80 %; the third must be 50, 60 or 80 %.
    result = transitivity(proportions({(0, 1): 60, (1, 2): 80, (0, 2): last}), list("abc"))
    assert result.violations == {
        kind: int(not held) for kind, held in zip(KINDS, holds, strict=True)
    }
    if last >= 50:
        assert result.table["short_of_strong"][0] == pytest.approx(max(0, 80 - last) / 100)
        assert result.table["first"][0] == "a"


def test_an_even_pair_is_taken_in_the_order_that_violates_least() -> None:
    # a and b even, both better than c: b, a, c or a, b, c: the first fails, the second holds.
    result = transitivity(proportions({(0, 1): 50, (1, 2): 60, (0, 2): 70}), list("abc"))
    assert result.violations == {"weak": 0, "moderate": 0, "strong": 0}
    assert result.table[["first", "second", "third"]].to_numpy().tolist() == [["a", "b", "c"]]


def test_triples_with_a_missing_pair_are_not_tested() -> None:
    wins = np.array([[0, 1, 2, 0], [1, 0, 3, 1.5], [1, 1, 0, 1], [0, 0.5, 1, 0]])
    result = transitivity([wins, wins])
    assert (result.tested, result.untested) == (2, 2)
    assert np.isnan(result.proportions[0, 3])
    assert result.proportions[1, 3] == 0.75
    assert result.n == 2 * wins.sum()


def test_nothing_to_test_is_an_empty_table() -> None:
    result = transitivity([[0, 1, 0], [0, 0, 1], [0, 0, 0]])
    assert (result.tested, result.untested, len(result.to_frame())) == (0, 1, 0)
    assert set(result.violations.values()) == {0}


def test_refuses() -> None:
    with pytest.raises(InputError, match="wins: 2 items given, 3 or more accepted"):
        transitivity([[0, 1], [1, 0]])
    with pytest.raises(InputError, match=r"items: .* given, 3 different names accepted"):
        transitivity(proportions({(0, 1): 50}), ["a"])
