"""A body's two sides against geometry, and the method of chapter 9 run forwards on them."""

import mitsuba as mi
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import View
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import Mesh, Value, to_mitsuba
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.media import MEASURED
from stimuli.translucency.renderer import Translucent, TranslucentRenderer
from stimuli.translucency.two_sides import two_sides
from tests.stimuli.bodies import UnitSphere, sphere_points
from tests.stimuli.test_irradiance import fresnel_transmittance

pytestmark = pytest.mark.usefixtures("llvm")

VIEW = View(width_px=60, height_px=50, radius_px=22, samples=1)


def scene_of(mesh: Mesh) -> Value:
    return mi.load_dict({"type": "scene", "body": to_mitsuba(mesh, {"type": "diffuse"}, "body")})


def test_sides_of_a_sphere() -> None:
    # Theory: the back is the front's mirror image, and the normal is the position.
    sides = two_sides(scene_of(UnitSphere().mesh(128, 256)), VIEW)
    seen, points = sphere_points(VIEW, (0, 0))
    assert_array_equal(sides.inside, seen)
    inner = points[..., 2] > 0.2
    mirrored = points * [1, 1, -1]
    for side, expected in ((sides.front, points), (sides.back, mirrored)):
        assert_allclose(side.position[inner], expected[inner], atol=2e-3)
        assert_allclose(side.normal[inner], expected[inner], atol=2e-3)
        assert not side.position[~seen].any()
        assert not side.normal[~seen].any()

    relief, back_relief = sides.relief(VIEW)
    assert np.isnan(relief[~seen]).all()
    assert np.nanmin(relief) == 0
    thickness = (relief - back_relief)[inner]
    assert_allclose(thickness, 2 * points[inner, 2] * VIEW.radius_px, atol=0.1)


def test_both_sides_line_up_whatever_the_body() -> None:
    # Property: front and back lie on one line through the pixel, the back behind.
    sides = two_sides(scene_of(AbstractShape(np.random.default_rng(3)).mesh(64, 128)), VIEW)
    front, back = sides.front.position[sides.inside], sides.back.position[sides.inside]
    assert_allclose(front[:, :2], back[:, :2], atol=1e-5)
    assert (front[:, 2] >= back[:, 2]).all()


def test_irradiance_of_a_sphere() -> None:
    # Theory: E = intensity F_t(cosine) cosine, on the side that the light is on.
    scene = scene_of(UnitSphere().mesh(128, 256))
    sides = two_sides(scene, VIEW)
    light = Light(30, -40, intensity=2.0)
    maps = sides.irradiance(scene, [light], 1.3)
    for found, side in zip(maps, (sides.front, sides.back), strict=True):
        cosine = side.normal[sides.inside] @ light.direction
        facing = np.maximum(cosine, 1e-9)
        expected = 2 * facing * fresnel_transmittance(facing, 1.3)
        clear = np.abs(cosine) > 0.03
        assert_allclose(found[sides.inside][clear], expected[clear], rtol=1e-4, atol=1e-6)
        assert not found[~sides.inside].any()


@pytest.mark.parametrize(
    ("light", "accuracy"), [(Light(135, 45, np.pi), 0.02), (Light(60, -45, np.pi), 0.1)]
)
def test_sums_over_the_maps_are_the_picture(light: Light, accuracy: float) -> None:
    # Another implementation: the renderer's own picture, from the maps by eq. 9.3 of Lopez-Moreno
    # 2011, which is how chapter 9 sees it. Pixels are coarse samples where the surface is steep,
    # through which all the light comes that a lamp behind sends to the front.
    medium, millimetres = MEASURED["skin2"], 6.0
    mesh, scene = UnitSphere().mesh(64, 128), scene_of(UnitSphere().mesh(64, 128))
    sides = two_sides(scene, VIEW)
    dipole = Dipole.of(medium)
    seen = sides.front.position[sides.inside]
    leaving = np.zeros((len(seen), 3))
    maps = sides.irradiance(scene, [light], medium.refractive_index)
    for entering, side in zip(maps, (sides.front, sides.back), strict=True):
        slope = np.maximum(np.abs(side.normal[sides.inside, 2]), 0.15)
        areas = (millimetres / VIEW.radius_px) ** 2 / slope
        away = np.linalg.norm(seen[:, None] - side.position[sides.inside], axis=-1) * millimetres
        leaving += np.einsum("pqc,q->pc", dipole(away), entering[sides.inside] * areas)
    cosine = sides.front.normal[sides.inside, 2]
    passing = fresnel_transmittance(np.clip(cosine, 1e-6, 1), medium.refractive_index)
    expected = leaving * passing[:, None] / np.pi

    renderer = TranslucentRenderer(Translucent(mesh, medium, millimetres), points=20_000)
    radiance = renderer.radiance(VIEW, [light], samples=16)[0][sides.inside]
    inner = cosine > 0.5
    assert_allclose(radiance[inner], expected[inner], rtol=2 * accuracy, atol=0.002)
    assert radiance[inner].mean() == pytest.approx(expected[inner].mean(), rel=accuracy)


def test_refuses_a_view_past_the_body() -> None:
    scene = scene_of(UnitSphere().mesh(8, 16).moved(np.array([5.0, 0, 0])))
    with pytest.raises(InputError, match="view: one that shows the body is accepted"):
        two_sides(scene, VIEW)
