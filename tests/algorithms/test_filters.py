"""The bilateral grid, against the sum over all neighbours that it stands for."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.filters import bilateral

GENERATOR = np.random.default_rng(11)
ROWS, COLUMNS = np.indices((40, 48))
STEP = np.where(COLUMNS < 24, 0.2, 0.8)
PICTURE = STEP + 0.1 * np.sin(ROWS / 5) + GENERATOR.normal(0, 0.02, STEP.shape)


def by_brute_force(values: np.ndarray, sigma_px: float, sigma_range: float) -> np.ndarray:
    places = np.stack([ROWS.ravel(), COLUMNS.ravel()], axis=-1)
    flat = values.ravel()
    squared = ((places[:, None] - places) ** 2).sum(axis=-1) / sigma_px**2
    squared = squared + (flat[:, None] - flat) ** 2 / sigma_range**2
    weights = np.exp(-squared / 2)
    return np.asarray((weights @ flat) / weights.sum(axis=1)).reshape(values.shape)


@pytest.mark.parametrize(("sigma_px", "sigma_range"), [(4, 0.1), (8, 0.1), (8, 0.3)])
def test_the_sum_over_all_neighbours(sigma_px: float, sigma_range: float) -> None:
    # Another implementation. The grid rounds places to half a standard deviation: a few percent of
    # what the filter does, which is 0.03 to 0.1 here.
    expected = by_brute_force(PICTURE, sigma_px, sigma_range)
    error = np.abs(bilateral(PICTURE, sigma_px, sigma_range) - expected)
    assert error.mean() < 0.1 * np.abs(expected - PICTURE).mean()
    assert error.max() < 0.04


def test_a_finer_grid_is_closer() -> None:
    expected = by_brute_force(PICTURE, 8, 0.2)
    errors = [
        np.abs(bilateral(PICTURE, 8, 0.2, cells_per_sigma=cells) - expected).mean()
        for cells in (1, 2, 4)
    ]
    assert errors[0] > 1.5 * errors[1] > 2.25 * errors[2]


@settings(max_examples=20, deadline=None, derandomize=True)
@given(st.floats(-5, 5), st.floats(2, 30), st.floats(0.01, 10))
def test_a_constant_stays(value: float, sigma_px: float, sigma_range: float) -> None:
    flat = np.full((20, 30), value)
    assert_allclose(bilateral(flat, sigma_px, sigma_range), flat, atol=1e-6)


def test_edges_stay_where_the_guide_has_them() -> None:
    # Theory: with a guide of two levels far apart, each side is an ordinary mean of its own.
    values = GENERATOR.normal(0, 1, STEP.shape)
    smooth = bilateral(values, 200, 0.01, guide=STEP)
    for side in (COLUMNS < 24, COLUMNS >= 24):
        assert_allclose(smooth[side], values[side].mean(), atol=0.02)


def test_nothing_outside_the_mask_plays_a_part() -> None:
    mask = COLUMNS > 10
    spoilt = np.where(mask, PICTURE, np.nan)
    smooth = bilateral(spoilt, 6, 0.1, mask=mask)
    assert (smooth[~mask] == 0).all()
    assert_allclose(smooth, bilateral(np.where(mask, PICTURE, 99), 6, 0.1, mask=mask))
    assert (bilateral(PICTURE, 6, 0.1, mask=np.zeros_like(mask)) == 0).all()


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match=r"values: \(height, width\)"):
        bilateral(np.zeros((3, 3, 3)), 4, 0.1)
    with pytest.raises(InputError, match="mask"):
        bilateral(PICTURE, 4, 0.1, mask=np.ones((3, 3), bool))
    with pytest.raises(InputError, match="guide"):
        bilateral(PICTURE, 4, 0.1, guide=STEP[1:])
    with pytest.raises(InputError, match="sigma_px"):
        bilateral(PICTURE, 0, 0.1)
    with pytest.raises(InputError, match="sigma_range"):
        bilateral(PICTURE, 4, np.nan)
    with pytest.raises(InputError, match="values: finite"):
        bilateral(np.full((4, 4), np.inf), 4, 0.1)
