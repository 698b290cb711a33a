from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

from analysis.estimates import Estimate
from analysis.figures.effects import effects_figure
from analysis.figures.style import SIMULATED_TEXT, figure_bytes
from analysis.figures.threshold_differences import differences_figure
from analysis.rates.effects import Effects, hit_effects, time_effects
from analysis.thresholds.condition_differences import ConditionDifferences, condition_differences
from benchmarks.thresholds import study

FACTORS = ("level", "placement", "gender")


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return study(12, np.random.default_rng(1))


@pytest.fixture(scope="module")
def hits(table: pd.DataFrame) -> Effects:
    return hit_effects(table, FACTORS)


@pytest.fixture(scope="module")
def differences(table: pd.DataFrame) -> ConditionDifferences:
    return condition_differences(table, "placement", 1 / 8, np.random.default_rng(1), 100)


def test_only_simulated_answers_bear_the_mark(
    hits: Effects, differences: ConditionDifferences
) -> None:
    for simulated in (True, False):
        expected = SIMULATED_TEXT if simulated else ""
        assert effects_figure(hits, simulated).get_suptitle() == expected
        assert differences_figure([differences], simulated).get_suptitle() == expected
    assert plt.get_fignums() == []


def test_every_contrast_has_its_row(table: pd.DataFrame, hits: Effects) -> None:
    left, right = effects_figure(hits, True, {"level": "divergence"}).axes
    labels = [label.get_text() for label in left.get_yticklabels()]
    assert labels[0] == "divergence: per 10"
    assert len(labels) == len(hits.contrasts)
    shown = [np.asarray(line.get_xdata(), float).ravel() for line in right.lines]
    marks = np.concatenate([one for one in shown if one.size == 1])
    np.testing.assert_allclose(marks, hits.contrasts["ratio"])
    (only,) = effects_figure(time_effects(table, FACTORS), True).axes
    assert only.get_xlabel() == "ratio of geometric means"


def test_few_participants_have_a_figure_too() -> None:
    two = study(2, np.random.default_rng(2))
    effects = hit_effects(two, ("placement", "age"))
    assert effects.contrasts["ratio_low"].isna().any()
    right = effects_figure(effects, True).axes[1]
    assert 0.005 < right.get_xlim()[0] < right.get_xlim()[1] < 200


def test_filled_marks_are_those_that_the_corrected_test_finds(hits: Effects) -> None:
    found = hits.to_frame()["p_holm"] < 0.05
    assert 0 < found.sum() < len(found)
    axes = effects_figure(hits, True).axes[0]
    marks = [line for line in axes.lines if line.get_marker() not in ("None", None)]
    assert [mark.get_markerfacecolor() != "white" for mark in marks] == found.tolist()


def test_a_difference_without_bound_is_an_arrow_and_none_is_said(
    differences: ConditionDifferences,
) -> None:
    first, *_ = differences.differences.values()
    changed = {
        "back - front": replace(first, difference=Estimate(-3.0, -np.inf, 1.0)),
        "back - front-back": replace(
            first, difference=Estimate(*[np.nan] * 3), p_value=float("nan")
        ),
        "front - front-back": first,
    }
    figure = differences_figure([replace(differences, differences=changed)], True, "deg")
    (axes,) = figure.axes
    assert "<" in [line.get_marker() for line in axes.lines]
    assert [text.get_text().strip() for text in axes.texts] == [
        "a threshold beyond the levels tested"
    ]
    assert axes.get_xlabel() == "difference (deg)"
    assert "of mid-points" in axes.get_title(loc="left")


def test_the_same_bytes(hits: Effects, differences: ConditionDifferences) -> None:
    assert figure_bytes(effects_figure(hits, True), "svg") == figure_bytes(
        effects_figure(hits, True), "svg"
    )
    assert figure_bytes(differences_figure([differences], True), "svg") == figure_bytes(
        differences_figure([differences], True), "svg"
    )
