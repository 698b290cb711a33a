import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.light import Light, angle_between_deg, plane_from_pixels

AZIMUTHS_DEG = st.floats(0, 360, exclude_max=True)
ELEVATIONS_DEG = st.floats(-90, 90)
LIGHTS = st.builds(Light, AZIMUTHS_DEG, ELEVATIONS_DEG)


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "direction"),
    [
        (0, 0, (1, 0, 0)),
        (90, 0, (0, 1, 0)),
        (180, 0, (-1, 0, 0)),
        (45, 90, (0, 0, 1)),
        (0, -90, (0, 0, -1)),
        (270, 30, (0, -math.sqrt(3) / 2, 1 / 2)),
    ],
)
def test_direction_in_the_project_frame(
    azimuth_deg: float, elevation_deg: float, direction: tuple[float, float, float]
) -> None:
    # Theory: x right, y up, z towards the viewer; azimuth counter-clockwise from +x.
    assert_allclose(Light(azimuth_deg, elevation_deg).direction, direction, atol=1e-15)


@given(LIGHTS)
def test_direction_has_unit_length(light: Light) -> None:
    assert_allclose(np.linalg.norm(light.direction), 1)


@given(LIGHTS, st.floats(1e-3, 1e3))
def test_vector_of_any_length_gives_the_light_back(light: Light, length: float) -> None:
    found = Light.from_direction(length * light.direction, intensity=2, distance=3)
    assert 0 <= found.azimuth_deg < 360
    assert angle_between_deg(found, light) < 1e-5
    assert (found.intensity, found.distance) == (2, 3)


def test_azimuth_just_below_the_x_axis_stays_below_360() -> None:
    assert Light.from_direction((1, -1e-300, 0)).azimuth_deg < 360


@given(LIGHTS, LIGHTS)
def test_angle_is_the_central_angle_of_the_sphere(first: Light, second: Light) -> None:
    # Theory: the haversine formula, with elevation as latitude and azimuth as longitude.
    latitudes = np.radians([first.elevation_deg, second.elevation_deg])
    longitude_gap = math.radians(first.azimuth_deg - second.azimuth_deg)
    haversine = (
        math.sin((latitudes[0] - latitudes[1]) / 2) ** 2
        + math.cos(latitudes[0]) * math.cos(latitudes[1]) * math.sin(longitude_gap / 2) ** 2
    )
    expected_deg = math.degrees(2 * math.asin(min(1, math.sqrt(haversine))))
    # Near 180 degrees the haversine formula itself holds to half of the digits only.
    assert_allclose(angle_between_deg(first, second), expected_deg, atol=1e-5)


@given(LIGHTS, LIGHTS)
def test_angle_is_symmetric(first: Light, second: Light) -> None:
    assert_allclose(angle_between_deg(first, second), angle_between_deg(second, first), atol=1e-9)


def test_small_angles_keep_their_digits() -> None:
    # An arc cosine would return 0 here.
    angle_deg = angle_between_deg(Light(0, 0), Light(1e-7, 0))
    assert_allclose(angle_deg, 1e-7, rtol=1e-6)


def test_rows_run_down_and_y_runs_up() -> None:
    # Definition: the first pixel's centre is at (0.5, 0.5) from the top left corner.
    x, y = plane_from_pixels([0.5, 4.0], [0.5, 3.0], height_px=4, width_px=6)
    assert x.tolist() == [-2.5, 0]
    assert y.tolist() == [1.5, -2]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"azimuth_deg": math.nan, "elevation_deg": 0}, "azimuth_deg: a finite number"),
        ({"azimuth_deg": 0, "elevation_deg": 90.1}, "elevation_deg: -90..90"),
        ({"azimuth_deg": 0, "elevation_deg": math.nan}, "elevation_deg: -90..90"),
        ({"azimuth_deg": 0, "elevation_deg": 0, "intensity": -1}, "intensity: 0 or more"),
        ({"azimuth_deg": 0, "elevation_deg": 0, "intensity": math.inf}, "intensity: 0 or more"),
        ({"azimuth_deg": 0, "elevation_deg": 0, "distance": 0}, "distance: more than 0 or None"),
    ],
)
def test_refuses_values_out_of_range(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Light(**arguments)


@pytest.mark.parametrize("direction", [(0, 0, 0), (1, math.nan, 0), (1, 0)])
def test_refuses_what_is_no_direction(direction: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="direction: a finite, non-zero vector of three numbers"):
        Light.from_direction(direction)
