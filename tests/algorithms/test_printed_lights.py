"""The parts of the printed method: pattern search, the osculating arc, scanlines, and all of it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import minimize, rosen

from algorithms.errors import InputError
from algorithms.light import Light
from algorithms.lights.contour import Contour
from algorithms.lights.pattern_search import pattern_search
from algorithms.lights.printed import VARIANTS, contour_lights, near_cosine, printed_lights
from algorithms.lights.probe import prepare_probe
from algorithms.lights.scanlines import osculating_radius, scan_elevation
from tests.algorithms.lit_bodies import ellipsoid, grey, lit


def test_pattern_search_agrees_with_another_minimiser() -> None:
    def bowl(x: np.ndarray) -> float:
        return float((x[0] - 2) ** 2 + 3 * (x[1] + 1) ** 2 + x[0] * x[1])

    place, value = pattern_search(bowl, [0.0, 0.0], [1.0, 1.0], least_step=1e-6)
    expected = minimize(bowl, [0.0, 0.0], tol=1e-12)
    assert_allclose(place, expected.x, atol=1e-4)
    assert value == pytest.approx(expected.fun, abs=1e-8)


def test_pattern_search_follows_a_bent_valley_and_ends_where_there_is_no_floor() -> None:
    place, _ = pattern_search(rosen, [-1.2, 1.0], [0.5, 0.5], least_step=1e-5)
    assert_allclose(place, [1, 1], atol=0.02)
    _, value = pattern_search(lambda x: -float(x[0]), [0.0], [1.0])
    assert value < -1000


def test_pattern_search_refuses_steps() -> None:
    with pytest.raises(InputError, match="steps: one of more than 0"):
        pattern_search(rosen, [0.0, 0.0], [1.0])
    with pytest.raises(InputError, match="least_step: 2 given"):
        pattern_search(rosen, [0.0, 0.0], [1.0, 1.0], least_step=2)


@given(
    radius=st.floats(0.5, 100),
    light_deg=st.floats(5, 60),
    further_deg=st.floats(15, 80),
)
def test_the_arc_has_the_radius_of_the_circle(
    radius: float, light_deg: float, further_deg: float
) -> None:
    # Theory, eq. 3.19: on a circle the normal at distance d leans by arccos(1 - d / r).
    d0, d1 = (radius * (1 - np.cos(np.radians(a))) for a in (light_deg, light_deg + further_deg))
    ratio = np.cos(np.radians(further_deg))
    assert osculating_radius(d0, d1, ratio) == pytest.approx(radius, rel=1e-6)


def test_there_is_no_arc_on_a_plane_or_backwards() -> None:
    assert np.isinf(osculating_radius(1.0, 5.0, 1.0))
    assert np.isinf(osculating_radius(5.0, 1.0, 0.5))


@pytest.mark.parametrize("azimuth_deg", [0.0, 130.0])
@pytest.mark.parametrize("elevation_deg", [-60.0, -20.0, 20.0, 60.0, 80.0])
def test_scanlines_find_the_elevation_on_a_sphere(azimuth_deg: float, elevation_deg: float) -> None:
    # Theory: on a sphere every scanline is half a circle.
    mask, normals, _ = ellipsoid(200, radius=0.9)
    image = grey(lit(normals, [Light(azimuth_deg, elevation_deg)], ambient=0.05) * mask)
    found = scan_elevation(prepare_probe(image, mask), azimuth_deg)
    assert found.elevation_deg == pytest.approx(elevation_deg, abs=6)
    if elevation_deg < 0:
        assert found.shadow == pytest.approx(0.05, abs=0.04)


def test_the_printed_method_finds_a_light_and_multiplies_where_it_should_divide() -> None:
    # Theory, eq. 3.22: on the outline a light counts by the cosine of its elevation.
    mask, normals, _ = ellipsoid(200, radius=0.9)
    found = {}
    for elevation_deg in (25.0, 60.0):
        image = grey(lit(normals, [Light(40, elevation_deg)]) * mask)
        lights = printed_lights(image, mask)
        assert set(lights) == set(VARIANTS)
        for variant, (strongest, *_) in lights.items():
            assert strongest.azimuth_deg == pytest.approx(40, abs=5)
            assert strongest.elevation_deg == pytest.approx(elevation_deg, abs=6)
            found[variant, elevation_deg] = strongest.intensity
    multiplied, _, divided = VARIANTS
    assert found[divided, 60.0] / found[divided, 25.0] == pytest.approx(1, abs=0.25)
    assert found[multiplied, 60.0] / found[multiplied, 25.0] < 0.6


def test_the_printed_cosine_of_a_point_light_is_that_of_the_geometry() -> None:
    # Theory, eq. 3.17: from a point of the circle to the light, against the normal there.
    turned = np.linspace(-np.pi, np.pi, 181)
    normals = np.stack([np.cos(turned), np.sin(turned)], axis=-1)
    towards = np.array([2.5, 0.0]) - normals
    cosine = (normals * towards).sum(axis=1) / np.linalg.norm(towards, axis=1)
    assert_allclose(near_cosine(turned, 2.5), np.maximum(cosine, 0), atol=1e-12)
    assert_allclose(near_cosine(turned, 1e9), np.maximum(np.cos(turned), 0), atol=1e-8)


@pytest.mark.parametrize("distance", [1.5, 2.5, 6.0, None])
def test_the_printed_method_recovers_a_distance(distance: float | None) -> None:
    # Recovery; a light that is infinitely far away stays so. The azimuth is found before the
    # distance, and is uncertain where lit normals are few.
    azimuth_deg = np.arange(-177.5, 180, 5)
    luminance = near_cosine(np.radians(azimuth_deg - 40), distance or 1e9)
    (found,) = contour_lights(Contour(azimuth_deg, luminance, np.zeros_like(luminance)))
    assert found.azimuth_deg == pytest.approx(40, abs=1.5)
    assert (found.distance or 1e9) == pytest.approx(distance or 1e9, rel=0.05)
