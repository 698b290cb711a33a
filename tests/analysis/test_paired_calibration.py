"""Small versions of benchmarks/paired.py: levels of tests and coverage of intervals."""

import math

import numpy as np
import pytest

from analysis.paired.scale_fit import MODELS
from analysis.paired.score_range import critical_difference, exact_range
from benchmarks.paired import (
    Population,
    agreement_sizes,
    coins,
    consistency_sizes,
    group_sizes,
    scale_coverage,
    speed,
    taste_sizes,
    tastes,
    u_coverage,
)

UNLIKELY = 1e-3  # a fixed seed: a failure is a change, not bad luck


@pytest.mark.parametrize(("items", "approximate"), [(4, False), (8, False), (12, True)])
def test_coins_are_seldom_called_consistent(items: int, approximate: bool) -> None:
    for row in consistency_sizes(1000, items):
        assert row["p_at_most_nominal"] > UNLIKELY, row
        if approximate:
            assert row["p_nominal"] > UNLIKELY, row
        else:
            assert row["exact_true_size"] <= row["alpha"], row


@pytest.mark.parametrize(("observers", "items"), [(5, 4), (44, 3)])
def test_coins_are_seldom_said_to_agree(observers: int, items: int) -> None:
    for row in agreement_sizes(400, observers, items):
        assert row["p_at_most_nominal"] > UNLIKELY, row
        if row["method"] == "exact":
            assert row["true_size"] <= row["alpha"], row
        elif observers > 15:
            assert row["true_size"] == pytest.approx(row["alpha"], abs=0.005), row


@pytest.mark.parametrize("alpha", [0.05, 0.01])
@pytest.mark.parametrize(
    ("items", "observers"), [(3, 25), (3, 30), (3, 50), (3, 60), (3, 176), (4, 10), (4, 12)]
)
def test_formula_splits_equal_items_as_often_as_alpha_says(
    items: int, observers: int, alpha: float
) -> None:
    # Theory: the exact distribution of the range, at numbers where whole differences come close.
    rounded = math.ceil(critical_difference(items, observers, alpha))
    assert exact_range(items, observers).tail[rounded] == pytest.approx(alpha, abs=0.005)


@pytest.mark.parametrize("items", [3, 4])
@pytest.mark.parametrize("observers", range(5, 26, 4))
def test_formula_is_the_exact_difference_or_one_beside(items: int, observers: int) -> None:
    # Theory: elsewhere no whole difference is within 0.005 of alpha; the formula then splits less.
    for alpha in (0.05, 0.01):
        rounded = math.ceil(critical_difference(items, observers, alpha))
        exact = exact_range(items, observers)
        critical = exact.critical(alpha)
        assert critical is not None
        assert abs(rounded - critical) <= 1
        if rounded < exact.tail.size:
            assert exact.tail[rounded] <= alpha + 0.005


def test_overall_test_of_coins() -> None:
    for row in group_sizes(1000, 4, 20):
        assert row["p_at_most_nominal"] > UNLIKELY, row
        assert row["david"]["p_nominal"] > UNLIKELY, row


def test_formula_splits_too_often_where_observers_have_tastes_and_shuffling_does_not() -> None:
    (row,) = taste_sizes(150, 20, 4, 1)
    assert row["formula"]["rate"] > 0.15
    for name in ("permuted", "permuted_david", "u_permuted"):
        assert row[name]["p_at_most_nominal"] > UNLIKELY, name


@pytest.mark.parametrize("model", MODELS)
def test_intervals_of_the_scale_hold_the_truth(model: str) -> None:
    # Recovery: 30 observers who differ. Of 200 x 9 contrasts 93 to 97 % with a margin of
    # two standard errors; percentiles hold it less often than the default.
    (row,) = scale_coverage(200, model, 3, 2.0, 1.0, 30)  # type: ignore[arg-type]
    assert row["no_finite_scale"] == 0
    for held in (row["items_held"], row["gaps_held"]):
        assert 0.91 < held["bootstrap"] < 0.985
        assert 0.91 < held["sandwich"] < 0.985
        assert held["percentile"] < held["bootstrap"]
        assert held["fisher"] < held["sandwich"]


def test_interval_of_u_holds_the_truth() -> None:
    (row,) = u_coverage(300, 4, 3.0, 0.5, 30)
    assert 0.9 < row["held"] < 0.98
    assert row["mean"] == pytest.approx(row["truth"], abs=0.015)


def test_population_scale_is_that_of_many_observers() -> None:
    # Recovery: 40,000 observers against quadrature; with Thurstone's model the spread only
    # stretches the unit, exactly.
    for model in MODELS.values():
        population = Population(model, np.array([-1.0, 0.2, 0.8]), 1.0)
        wins = population.draw(np.random.default_rng(1), 40_000)
        np.testing.assert_allclose(
            wins.mean(axis=0), population.shares() * (1 - np.eye(3)), atol=0.01
        )
    normal = Population(MODELS["thurstone"], np.array([-1.0, 0.2, 0.8]), 1.0)
    unit = MODELS["thurstone"].unit
    np.testing.assert_allclose(
        normal.scale(), normal.values_jod * unit / math.sqrt(1 + 2 * unit**2), atol=1e-9
    )


def test_simulated_observers_are_what_they_are_called() -> None:
    generator = np.random.default_rng(2)
    assert coins(generator, 4000, 3)[:, 0, 1].mean() == pytest.approx(0.5, abs=0.04)
    orders = tastes(generator, 10, 5, conditions=2)
    assert (np.sort(orders.sum(axis=2), axis=1) == np.arange(5)).all()  # no circular triad
    np.testing.assert_array_equal(orders[:10], orders[10:])


def test_speed_reports_its_peers() -> None:
    (row,) = speed(1, 6, 4)
    assert {"bradley-terry_s", "thurstone_s", "choix_opt_pairwise_s"} <= set(row["bootstrap"])
    assert row["choix_over_ours"] > 0
