"""Maps in perspective: theory, and quadrilaterals that are refused."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.errors import InputError
from algorithms.projection import checked_quad, project_map

SHAPE = (60, 80)
SQUARE = [(10, 20), (42, 20), (42, 52), (10, 52)]


def whole(values: np.ndarray, quad: object, shape: tuple[int, int] = SHAPE) -> np.ndarray:
    """Return a projected map in an image of its own."""
    place, projected = project_map(values, quad, shape)  # type: ignore[arg-type]
    image = np.zeros(shape)
    image[place] = projected
    return image


def test_an_upright_square_of_the_map_s_size_shows_the_map() -> None:
    values = np.random.default_rng(1).uniform(size=(32, 32))
    # Drawn three times as fine, between pixels, and averaged: only linear maps stay as they are.
    ramp = np.add.outer(np.arange(32.0), np.arange(32.0))
    shown = whole(ramp, SQUARE)[20:52, 10:42]
    np.testing.assert_allclose(shown[1:-1, 1:-1], ramp[1:-1, 1:-1], atol=1e-4)
    assert np.corrcoef(whole(values, SQUARE)[20:52, 10:42].ravel(), values.ravel())[0, 1] > 0.95


def test_nothing_lies_outside_of_the_quadrilateral() -> None:
    quad = [(20, 10), (60, 14), (70, 50), (8, 44)]
    shown = whole(np.ones((64, 64)), quad)
    row, column = np.mgrid[: SHAPE[0], : SHAPE[1]] + 0.5
    distance = np.full(SHAPE, np.inf)
    for (x0, y0), (x1, y1) in zip(quad, quad[1:] + quad[:1], strict=True):
        across = (x1 - x0) * (row - y0) - (y1 - y0) * (column - x0)
        distance = np.minimum(distance, across / np.hypot(x1 - x0, y1 - y0))
    assert not shown[distance < -1.5].any()
    np.testing.assert_allclose(shown[distance > 3], 1, atol=1e-5)


@pytest.mark.parametrize("first", [0, 1, 2, 3])
@pytest.mark.parametrize("clockwise", [True, False])
def test_the_map_s_top_left_goes_to_the_first_corner(first: int, clockwise: bool) -> None:
    quad = [(20, 10), (60, 14), (70, 50), (8, 44)]
    order = quad[first:] + quad[:first]
    values = np.zeros((32, 32))
    values[:8, :8] = 1  # top left
    values[:8, -8:] = 0.1  # top right
    corners = order if clockwise else [order[0], order[3], order[2], order[1]]
    shown = whole(values, corners)
    middle = np.mean(quad, axis=0)
    for corner, value in ((corners[0], 1), (corners[1], 0.1), (corners[2], 0)):
        x, y = 0.9 * np.array(corner) + 0.1 * middle
        assert shown[int(y), int(x)] == pytest.approx(value, abs=0.02)


def test_the_middle_is_where_the_diagonals_cross() -> None:
    quad = np.array([(30, 10), (50, 10), (75, 55), (5, 55)], dtype=float)
    values = np.zeros((64, 64))
    values[30:34, 30:34] = 1
    shown = whole(values, quad)
    row, column = np.mgrid[: SHAPE[0], : SHAPE[1]] + 0.5
    mean = [float((shown * axis).sum() / shown.sum()) for axis in (column, row)]
    # By symmetry x = 40; the diagonal from (30, 10) to (75, 55) is there at y = 20.
    np.testing.assert_allclose(mean, [40, 20], atol=0.4)


@pytest.mark.parametrize("side_px", [8, 13, 20])
def test_fine_maps_are_averaged_not_sampled(side_px: int) -> None:
    values = np.tile([0.0, 1.0], (256, 128))  # columns that alternate
    quad = np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * side_px + 20.3
    inside = whole(values, quad)[22 : 18 + side_px, 22 : 18 + side_px]
    np.testing.assert_allclose(inside, 0.5, atol=0.02)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(0, 80), st.floats(0, 60)), min_size=4, max_size=4))
def test_any_quadrilateral_is_refused_or_shown_within_it(
    corners: list[tuple[float, float]],
) -> None:
    try:
        checked_quad(corners, SHAPE)
    except InputError:
        return
    shown = whole(np.ones((64, 64)), corners)
    assert shown.min() >= 0
    assert shown.max() <= 1 + 1e-5
    x, y = np.array(corners).T
    area = abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2
    perimeter = np.hypot(x - np.roll(x, -1), y - np.roll(y, -1)).sum()
    # The map's border fades over one of its pixels, about one of the image's or less.
    assert area - 1.5 * perimeter < shown.sum() < area + 0.5 * perimeter


@pytest.mark.parametrize(
    "quad",
    [
        [(10, 10), (40, 40), (40, 10), (10, 40)],  # crosses itself
        [(10, 10), (40, 10), (20, 20), (10, 40)],  # a dent
        [(10, 10), (20, 20), (30, 30), (10, 30)],  # three on a line
        [(10, 10), (10, 10), (30, 30), (10, 30)],  # two are the same
        [(10, 10), (40, 10), (40, 61), (10, 40)],  # below the image
        [(-1, 10), (40, 10), (40, 40), (10, 40)],
        [(10, 10), (81, 10), (40, 40), (10, 40)],
        [(10, 10), (np.nan, 10), (40, 40), (10, 40)],
        [(10, 10), (np.inf, 10), (40, 40), (10, 40)],
        [(10, 10), (40, 10), (40, 40)],
        [10, 10, 40, 10, 40, 40, 10, 40],
    ],
)
def test_refuses(quad: object) -> None:
    with pytest.raises(InputError, match="quad: four corners"):
        project_map(np.ones((8, 8)), quad, SHAPE)  # type: ignore[arg-type]
