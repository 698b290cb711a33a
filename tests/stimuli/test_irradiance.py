"""Light that enters a surface, against what optics says about it."""

import mitsuba as mi
import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import Mesh, Value, to_mitsuba
from stimuli.translucency.irradiance import entering_irradiance
from tests.stimuli.bodies import UnitSphere

pytestmark = pytest.mark.usefixtures("llvm")


def scene_of(*meshes: Mesh) -> Value:
    shapes = {
        f"mesh_{i}": to_mitsuba(mesh, {"type": "diffuse"}, "") for i, mesh in enumerate(meshes)
    }
    return mi.load_dict({"type": "scene", **shapes})


def directions(count: int, seed: int = 0) -> NDArray[np.float64]:
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def fresnel_transmittance(cosine: NDArray[np.float64], index: float) -> NDArray[np.float64]:
    """Return F_t by Fresnel's formulas, written out here."""
    inside = np.sqrt(1 - (1 - cosine**2) / index**2)
    across = (cosine - index * inside) / (cosine + index * inside)
    along = (index * cosine - inside) / (index * cosine + inside)
    return np.asarray(1 - (across**2 + along**2) / 2)


@pytest.mark.parametrize("index", [1.0, 1.3, 1.5])
def test_distant_light_on_a_sphere(index: float) -> None:
    # Theory: E = intensity F_t(cosine) cosine where the light is above the horizon, else nothing.
    light = Light(20, 40, intensity=2.5)
    normals = directions(500)
    found = entering_irradiance(scene_of(UnitSphere().mesh()), normals, normals, [light], index)
    cosine = normals @ light.direction
    facing = np.maximum(cosine, 1e-9)
    expected = 2.5 * facing * fresnel_transmittance(facing, index)
    clear = np.abs(cosine) > 0.03  # a facet may face away where its normal does not
    assert_allclose(found[clear], expected[clear], rtol=1e-5, atol=1e-6)


def test_lights_add_up() -> None:
    normals = directions(100)
    scene = scene_of(UnitSphere().mesh())
    lights = [Light(0, 30), Light(120, -20, 0.5), Light(240, 60, 2.0, distance=4.0)]
    together = entering_irradiance(scene, normals, normals, lights, 1.3)
    apart = [entering_irradiance(scene, normals, normals, [light], 1.3) for light in lights]
    assert_allclose(together, np.sum(apart, axis=0), rtol=1e-5)


def test_point_light_falls_off_with_the_square_of_its_distance() -> None:
    # Theory: at the origin's distance the intensity holds; on the sphere's near pole, at distance
    # 2 of a light 3 away, it is 9/4 of it.
    light = Light(0, 90, intensity=1.0, distance=3.0)
    pole = np.array([[0.0, 0.0, 1.0]])
    found = entering_irradiance(scene_of(UnitSphere().mesh()), pole, pole, [light], 1.0)
    assert_allclose(found, 9 / 4, rtol=1e-4)
    # Below the horizon of the light nothing arrives: there the cosine to the origin is 1/3.
    below = np.array([[np.sqrt(1 - 0.3**2), 0, 0.3]])
    above = np.array([[np.sqrt(1 - 0.37**2), 0, 0.37]])
    scene = scene_of(UnitSphere().mesh())
    assert entering_irradiance(scene, below, below, [light], 1.0) == 0
    assert entering_irradiance(scene, above, above, [light], 1.0) > 0


def test_other_parts_cast_shadows_up_to_the_light() -> None:
    # Theory: a ball between lamp and surface takes the light away; one behind the lamp does not.
    normal = np.array([[0.0, 0.0, 1.0]])
    ball = UnitSphere().mesh(32, 64)
    between = ball.moved(np.array([0, 0, 3.0]), 0.5)
    scene = scene_of(ball, between)
    assert entering_irradiance(scene, normal, normal, [Light(0, 90)], 1.3) == 0
    assert entering_irradiance(scene, normal, normal, [Light(0, 90, distance=6)], 1.3) == 0
    assert entering_irradiance(scene, normal, normal, [Light(0, 90, distance=2)], 1.3) > 0


def test_no_shadows_where_nothing_is_in_the_way() -> None:
    # Property: on a surface of any form, a point whose way to the light stays outside is lit.
    light = Light(250, -20)
    shape = AbstractShape(np.random.default_rng(5))
    at = directions(2000, seed=2)
    positions, normals = at * shape.radius(at)[:, None], shape.normal(at)
    found = entering_irradiance(scene_of(shape.mesh()), positions, normals, [light], 1.0)
    way = positions[:, None] + np.linspace(0.02, 2.5, 200)[:, None] * light.direction
    height = np.linalg.norm(way, axis=-1)
    clearance = (height / shape.radius(way / height[..., None])).min(axis=1) - 1
    cosine = normals @ light.direction
    free, blocked = clearance > 0.01, (clearance < -0.01) & (cosine > 0.05)
    assert blocked.sum() > 20
    assert not found[blocked].any()
    assert_allclose(found[free & (cosine > 0.05)], cosine[free & (cosine > 0.05)], rtol=1e-4)
