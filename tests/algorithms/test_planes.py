"""Distance from what a user points at, against a pinhole camera over a ground."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from algorithms.depth import (
    distance_of_relief,
    layered_distance,
    receding_distance,
    scaled_distance,
)
from algorithms.errors import InputError

SHAPE = (60, 80)
NEAR = np.zeros(SHAPE, bool)
NEAR[40:] = True
MIDDLE = np.zeros(SHAPE, bool)
MIDDLE[20:50] = True


def test_a_ground_below_a_camera() -> None:
    # Theory: a level ground, a camera 1.6 m above it that looks at the horizon in row 20, focal
    # length 100 px: depth is 1.6 * 100 / (row - 20), by similar triangles.
    centres = np.arange(SHAPE[0]) + 0.5
    with np.errstate(divide="ignore"):
        expected = np.where(centres > 20, 160 / (centres - 20), np.inf)
    for far_row, far in ((30.0, 16.0), (20.0, np.inf)):
        ground = receding_distance(SHAPE, (40, 60.0), (40, far_row), 4.0, far)
        assert_allclose(ground, np.repeat(expected[:, None], SHAPE[1], axis=1), rtol=1e-4)


def test_it_recedes_along_the_line_and_is_even_across() -> None:
    plane = receding_distance(SHAPE, (10.5, 50.5), (50.5, 20.5), 2, 8)
    assert_allclose([plane[50, 10], plane[20, 50]], [2, 8], rtol=1e-5)
    assert_allclose(plane[46, 7], plane[50, 10], rtol=1e-5)


def test_later_layers_cover_earlier_ones() -> None:
    distance = layered_distance([MIDDLE, NEAR], [30.0, 5.0], np.inf)
    assert [distance[0, 0], distance[30, 0], distance[45, 0]] == [np.inf, 30, 5]
    ground = receding_distance(SHAPE, (40, 60.0), (40, 30.0), 4.0, 16.0)
    distance = layered_distance([NEAR], [ground], 100.0)
    assert (distance[NEAR] == ground[NEAR]).all()
    assert (distance[~NEAR] == 100).all()


def test_the_ends_of_a_relief_are_where_they_should_be() -> None:
    relief = np.random.default_rng(2).normal(size=SHAPE)
    distance = distance_of_relief(relief, 3, 7)
    assert distance.flat[relief.argmax()] == 3
    assert distance.flat[relief.argmin()] == 7
    assert np.corrcoef(relief.ravel(), distance.ravel())[0, 1] < -0.9999
    assert (distance_of_relief(np.ones(SHAPE), 3, 7) == 3).all()


def test_scaled_to_the_farthest_thing() -> None:
    assert scaled_distance([[1.0, 4.0, np.inf]]).tolist() == [[0.25, 1, 1]]


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match="distances"):
        layered_distance([NEAR], [1.0, 2.0], 3.0)
    with pytest.raises(InputError, match="masks"):
        layered_distance([NEAR, MIDDLE[1:]], [1.0, 2.0], 3.0)
    with pytest.raises(InputError, match="distances: 0 or more"):
        layered_distance([NEAR], [-1.0], 3.0)
    with pytest.raises(InputError, match="background"):
        layered_distance([NEAR], [1.0], np.nan)
    with pytest.raises(InputError, match="far_point"):
        receding_distance(SHAPE, (1, 1), (1, 1), 2, 8)
    with pytest.raises(InputError, match="near, far"):
        receding_distance(SHAPE, (1, 1), (1, 2), 8, 2)
    with pytest.raises(InputError, match="near_point"):
        receding_distance(SHAPE, (1, np.nan), (1, 2), 2, 8)
    with pytest.raises(InputError, match="relief"):
        distance_of_relief(np.full(SHAPE, np.nan), 1, 2)
    with pytest.raises(InputError, match="distance"):
        scaled_distance(np.full(SHAPE, np.inf))
