import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.noise import PerlinNoise

NOISE = PerlinNoise(np.random.default_rng(3))
COORDINATES = st.floats(-300, 300)
POINTS = st.tuples(COORDINATES, COORDINATES, COORDINATES).map(np.array)


@given(st.tuples(*[st.integers(-1000, 1000)] * 3))
def test_zero_at_lattice_points(point: tuple[int, int, int]) -> None:
    # Theory: gradient noise is a sum of ramps, all of them zero at their own lattice point.
    assert_allclose(NOISE(np.array(point)), 0, atol=1e-12)


@given(POINTS, st.integers(0, 2))
def test_smooth_across_the_borders_of_cells(point: np.ndarray, axis: int) -> None:
    # Theory: value, slope and curvature are continuous; the curve's steps differ by O(step^3).
    point[axis] = np.round(point[axis])
    step = 2.0**-12  # exact, so that no difference is lost to rounding
    along = np.arange(-2, 3)[:, None] * step * np.eye(3)[axis]
    values = NOISE(point + along)
    curvature = np.diff(values, n=2) / step**2
    assert np.abs(np.diff(values)).max() < 4 * step
    assert np.ptp(curvature) < 400 * step


@given(POINTS)
def test_stays_within_its_range(point: np.ndarray) -> None:
    assert -1 <= NOISE(point) <= 1


def test_mean_is_zero_and_no_axis_is_preferred() -> None:
    # Theory: gradients uniform over the sphere have mean 0 and equal variance along each axis.
    points = np.random.default_rng(4).uniform(0, 256, size=(200_000, 3))
    values = NOISE(points)
    slopes = [NOISE(points + step) - values for step in np.eye(3) * 1e-3]
    assert abs(values.mean()) < 0.02 * values.std() + 5 * values.std() / np.sqrt(len(values))
    deviations = np.std(slopes, axis=1)
    assert_allclose(deviations, deviations.mean(), rtol=0.1)


def test_octaves_add_up_by_hand() -> None:
    # Definition: twice the frequency and `gain` times the amplitude for each further octave.
    points = np.random.default_rng(5).uniform(0, 50, size=(10, 3))
    expected = NOISE(points) + 0.3 * NOISE(2 * points) + 0.09 * NOISE(4 * points)
    assert_allclose(NOISE.fractal(points, octaves=3, gain=0.3), expected)


def test_the_generator_alone_decides() -> None:
    points = np.random.default_rng(6).uniform(0, 50, size=(100, 3))
    again, other = (PerlinNoise(np.random.default_rng(seed))(points) for seed in (3, 4))
    assert (again == NOISE(points)).all()
    assert abs(np.corrcoef(other, again)[0, 1]) < 0.5


@given(st.floats(2, 80), st.integers(1, 4), st.floats(0.2, 0.9))
def test_a_picture_of_it_is_the_same_noise(period_px: float, octaves: int, gain: float) -> None:
    # Another implementation: the points one by one.
    rows, columns = np.indices((13, 17)) / period_px
    points = np.stack([rows, columns, np.zeros_like(rows)], axis=-1)
    picture = NOISE.image((13, 17), period_px, octaves, gain)
    assert_allclose(picture, NOISE.fractal(points, octaves, gain), atol=1e-5)
