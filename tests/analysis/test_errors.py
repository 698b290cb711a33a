"""Errors of estimated lights."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.light import Light, angle_between_deg
from analysis.errors import azimuth_error_deg, light_error

LIGHTS = st.builds(Light, st.floats(0, 360), st.floats(-90, 90), st.floats(0.1, 2))
FEW = st.lists(LIGHTS, min_size=1, max_size=4)


def test_by_hand() -> None:
    truth = [Light(10, 0), Light(100, 45)]
    found = [Light(95, 40, 1.0), Light(350, 5, 0.9), Light(200, 0, 0.3), Light(250, 0, 0.1)]
    error = light_error(found, truth)
    assert list(zip(error.estimated, error.true, strict=True)) == [(0, 1), (1, 0)]
    assert list(error.azimuth_deg) == [5, 20]
    assert list(error.elevation_deg) == [5, 5]
    assert (error.missed, error.extra, error.strong_extra) == (0, 2, 1)
    assert not error.number_is_right
    assert light_error([*found[:2], found[3]], truth).number_is_right


def test_a_missed_light_makes_the_number_wrong() -> None:
    error = light_error([Light(10, 0)], [Light(10, 0), Light(100, 0)])
    assert list(error.angle_deg) == [0]
    assert error.missed == 1
    assert not error.number_is_right


def test_nothing_found() -> None:
    error = light_error([], [Light(10, 0)])
    assert not error.angle_deg
    assert error.missed == 1


@given(FEW, FEW)
def test_the_assignment_is_the_best_of_all(found: list[Light], truth: list[Light]) -> None:
    # Another implementation: try every one.
    error = light_error(found, truth)
    few, many = sorted([found, truth], key=len)
    sums = [
        sum(angle_between_deg(a, b) for a, b in zip(few, order, strict=False))
        for order in permutations(many, len(few))
    ]
    assert_allclose(sum(error.angle_deg), min(sums), atol=1e-6)
    assert len(error.angle_deg) == len(few)
    assert error.missed == max(0, len(truth) - len(found))
    assert error.extra == max(0, len(found) - len(truth))


@given(FEW)
def test_the_truth_itself_has_no_error(truth: list[Light]) -> None:
    error = light_error(truth[::-1], truth)
    assert_allclose(error.angle_deg, 0, atol=1e-5)
    assert error.number_is_right


@given(LIGHTS, LIGHTS, st.integers(-3, 3))
def test_azimuths_wrap(first: Light, second: Light, turns: int) -> None:
    error = azimuth_error_deg(first, second)
    turned = Light(second.azimuth_deg + 360 * turns, second.elevation_deg)
    assert 0 <= error <= 180
    assert np.isclose(error, azimuth_error_deg(turned, first))


def test_no_truth_is_refused() -> None:
    with pytest.raises(InputError, match="truth: one light or more"):
        light_error([Light(0, 0)], [])
