"""The lights of chapter 3 and pictures under wide ones, against what is known of them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.light import Light, angle_between_deg
from stimuli.camera import View
from stimuli.engine import choose_engine
from stimuli.light_linking.render import make_renderer
from stimuli.scenes.probe_lights import TABLE_3_1, TABLE_3_2, disc, light_of_chapter_3, surroundings
from tests.stimuli.bodies import matt_sphere, of_table, sphere_points

VIEW = View(width_px=48, height_px=48, radius_px=21, samples=16)


def irradiance(lights: tuple[Light, ...], normal: np.ndarray) -> float:
    """Return what lights send to a surface of that normal, with nothing in between."""
    return sum(light.intensity * max(0.0, float(normal @ light.direction)) for light in lights)


@pytest.mark.parametrize(
    "angles_deg", [*TABLE_3_2, *(a for rig in TABLE_3_1.values() for a in rig)]
)
def test_chapter_3_has_its_image_plane_in_y_and_z(angles_deg: tuple[float, float]) -> None:
    # Published: Lopez-Moreno 2011, fig. 3.1d: x comes out of the image, azimuth runs in y and z.
    theta, psi = np.radians(angles_deg)
    out, right, up = np.sin(psi), np.cos(psi) * np.cos(theta), np.cos(psi) * np.sin(theta)
    light = light_of_chapter_3(*angles_deg)
    assert_allclose(light.direction, [right, up, out], atol=1e-9)
    assert light.azimuth_deg == angles_deg[0] % 360
    assert light.elevation_deg == angles_deg[1]


def test_rigs_of_table_3_1() -> None:
    # Published: the rows R; two lights of Apple 1 stand opposite to each other.
    assert [len(rig) for rig in TABLE_3_1.values()] == [2, 1, 2, 3, 2]
    first, second = (light_of_chapter_3(*angles) for angles in TABLE_3_1["apple1"])
    assert angle_between_deg(first, second) == pytest.approx(180)


@pytest.mark.parametrize("radius_deg", [10.0, 30.0])
@pytest.mark.parametrize("tilt_deg", [0, 20, 55])
def test_disc_above_the_horizon_acts_like_its_centre(radius_deg: float, tilt_deg: float) -> None:
    # Theory: while no part of it sets, the irradiance of an even disc is that of its vector.
    centre = Light(70, 15, intensity=2.0)
    lights = disc(centre, radius_deg, 256)
    normal = Light(70, 15 - tilt_deg).direction
    expected = 2.0 * np.cos(np.radians(tilt_deg))
    assert_allclose(irradiance(lights, normal), expected, rtol=2e-3)
    assert max(angle_between_deg(centre, light) for light in lights) < radius_deg


@pytest.mark.parametrize("tilt_deg", [0, 45, 90, 135, 180])
def test_disc_of_half_the_sky(tilt_deg: float) -> None:
    # Theory: under an even hemisphere a tilted surface receives (1 + cosine) / 2.
    normal = Light(0, 90 - tilt_deg).direction
    found = irradiance(disc(Light(0, 90, 3.0), 90, 1024), normal)
    assert_allclose(found, 3 * (1 + np.cos(np.radians(tilt_deg))) / 2, atol=0.02)


@pytest.mark.parametrize("part", range(0, 16, 5))
def test_surroundings_light_all_sides_alike_and_so_does_every_sixteenth(part: int) -> None:
    lights = surroundings(1.5, 256)
    normals = np.random.default_rng(1).normal(size=(40, 3))
    for normal in normals / np.linalg.norm(normals, axis=1, keepdims=True):
        assert_allclose(irradiance(lights, normal), 1.5, rtol=0.02)
        assert_allclose(16 * irradiance(lights[part::16], normal), 1.5, rtol=0.35)


@pytest.mark.usefixtures("engine")
def test_sphere_in_even_surroundings_is_flat() -> None:
    # Theory: a convex body hides nothing from itself.
    made = make_renderer([matt_sphere()]).render(VIEW, [surroundings(np.pi, 64)], dealt=True)
    inner = (made.coverage == 1) & (sphere_points(VIEW, (0, 0))[1][..., 2] > 0.3)
    assert_allclose(made.shading[inner], 1, atol=0.06)
    assert_allclose(made.shading[inner].mean(), 1, atol=0.005)


@pytest.mark.usefixtures("engine")
def test_sphere_under_half_the_sky() -> None:
    # Theory: as above, by normal.
    light = Light(120, 25, np.pi)
    made = make_renderer([matt_sphere()]).render(VIEW, [disc(light, 90, 64)], dealt=True)
    seen, normal = sphere_points(VIEW, (0, 0))
    expected = (1 + normal @ light.direction) / 2
    inner = (made.coverage == 1) & (normal[..., 2] > 0.3)
    assert_allclose(made.shading[inner], expected[inner], atol=0.06)
    assert (made.radiance[~seen & (made.coverage == 0)] == 0).all()


@pytest.mark.usefixtures("llvm")
def test_dealt_lights_give_nearly_the_picture_of_all() -> None:
    renderer, lights = make_renderer([of_table("b")]), disc(Light(30, 10, np.pi), 20, 256)
    dealt, together = (renderer.render(VIEW, [lights], dealt=each) for each in (True, False))
    assert (dealt.coverage == together.coverage).all()
    assert np.sqrt(((dealt.shading - together.shading) ** 2).mean()) < 5e-3
    assert np.sqrt(((dealt.radiance - together.radiance) ** 2).mean()) < 2e-3


def test_refuses_what_is_no_disc() -> None:
    with pytest.raises(InputError, match="radius_deg: 0 given, more than 0 and at most 90"):
        disc(Light(0, 0), 0, 16)
    with pytest.raises(InputError, match="light: one without a distance is accepted"):
        disc(Light(0, 0, distance=2), 10, 16)
    with pytest.raises(InputError, match="count: 0 given, 1 or more accepted"):
        surroundings(1, 0)
    choose_engine()
    with pytest.raises(InputError, match="a multiple of 16 lights is accepted where dealt"):
        make_renderer([matt_sphere()]).render(VIEW, [disc(Light(0, 0), 10, 20)], dealt=True)
