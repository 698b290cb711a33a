"""Pictures against what optics says about them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import CAMERA_DISTANCE, View
from stimuli.render import make_renderer
from stimuli.rigs import KEY_INTENSITY
from stimuli.scene import Placed
from stimuli.shapes import AbstractShape, sphere_directions
from tests.stimuli.bodies import (
    MATT,
    UnitSphere,
    matt_shape,
    matt_sphere,
    of_table,
    pixel_centres,
    sphere_points,
)

pytestmark = pytest.mark.usefixtures("engine")

# One sample a pixel: it lies in the pixel's centre.
VIEW = View(width_px=64, height_px=48, radius_px=18, samples=1)
CENTRE = (0.25, -0.125)


@pytest.mark.parametrize("direction_deg", [(0, 45), (200, 10), (90, -30), (315, 90)])
def test_lambert_sphere(direction_deg: tuple[float, float]) -> None:
    # Theory: radiance = albedo / pi * irradiance * max(0, normal . light).
    light = Light(*direction_deg, intensity=2.0)
    radiance, coverage = make_renderer([matt_sphere(CENTRE)], []).radiance(VIEW, [light])
    seen, normal = sphere_points(VIEW, CENTRE)
    cosine = np.maximum(0, normal @ light.direction)
    expected = np.where(seen, 0.5 / np.pi * light.intensity * cosine, 0)
    assert (coverage == seen).all()
    # Where the light grazes, a facet (1.4 degrees wide) may face away while its normal does not.
    grazing = np.abs(normal @ light.direction) < np.sin(np.radians(1.4))
    assert_allclose(radiance[~grazing, 1], expected[~grazing], atol=1e-3)
    assert (radiance[grazing, 1] <= expected[grazing] + 1e-3).all()
    assert (radiance == radiance[..., :1]).all()


def test_white_surface_facing_the_key_light_has_radiance_one() -> None:
    # Definition of the rig's unit.
    renderer = make_renderer([matt_sphere(albedo=1.0)], [])
    radiance, _ = renderer.radiance(VIEW, [Light(0, 90, KEY_INTENSITY)])
    assert_allclose(radiance.max(), 1, rtol=2e-3)


def test_light_adds_up() -> None:
    # Theory: light is linear; a shiny object under three lights is the sum of three pictures.
    key, *others = (Light(20, 30, 3), Light(160, 10, 0.5), Light(90, 0, 0.7))
    objects = [of_table("g")]
    together, _ = make_renderer(objects, others).radiance(VIEW, [key])
    alone = make_renderer(objects, [])
    parts = [alone.radiance(VIEW, [light])[0] for light in (key, *others)]
    assert_allclose(together, np.sum(parts, axis=0), atol=1e-5)
    twice, _ = alone.radiance(VIEW, [Light(20, 30, 6)])
    assert_allclose(twice, 2 * parts[0], rtol=1e-5)


def test_object_shadows_itself() -> None:
    # Theory: a point is dark where the way to the light passes below the shape's own surface,
    # marched here through the formula of the surface, without mesh or ray tracer.
    light = Light(250, -20, KEY_INTENSITY)
    seed, view = 5, View(width_px=60, height_px=60, radius_px=28, samples=1)
    renderer = make_renderer([matt_shape(seed)], [])
    truth = renderer.ground_truth(view)
    inside = truth.regions > 0
    cosine = truth.normal[inside] @ light.direction
    points = np.stack([*pixel_centres(view), CAMERA_DISTANCE - truth.distance], axis=-1)[inside]
    way = points[:, None] + np.linspace(0.02, 2.5, 200)[:, None] * light.direction
    height = np.linalg.norm(way, axis=-1)
    shape = AbstractShape(np.random.default_rng(seed))
    clearance = (height / shape.radius(way / height[..., None])).min(axis=1) - 1

    found = renderer.radiance(view, [light])[0][inside, 0]
    facing = cosine > 0.05
    blocked, free = facing & (clearance < -0.01), facing & (clearance > 0.01)
    assert blocked.sum() > 50
    assert (found[blocked] == 0).all()
    assert_allclose(found[free], 0.5 * cosine[free], atol=1e-5)


def test_neighbour_neither_shadows_nor_lights() -> None:
    # Property: whatever stands between an object and its light, its picture stays the same.
    light = Light(0, 0, KEY_INTENSITY)  # from the right, where the neighbour stands
    view = View(width_px=120, height_px=40, radius_px=12, samples=4)
    target = of_table("e", (-3.0, 0.0))
    alone, _ = make_renderer([target], []).radiance(view, [light])
    left = slice(0, 40)
    assert (alone[:, left] > 0.1).any()
    for neighbour in (matt_shape(2, (0.0, 0.0)), matt_sphere((2.0, 0.5), albedo=1.0)):
        both, _ = make_renderer([target, neighbour], []).radiance(view, [light, light])
        assert (both[:, left] == alone[:, left]).all()


def test_only_the_linked_object_changes() -> None:
    # Property: another key light for one object leaves the pixels of all others as they were.
    view = View(width_px=120, height_px=40, radius_px=12, samples=4)
    objects = [matt_shape(1, (-3, 0)), of_table("d", (0, 0)), of_table("b", (3, 0))]
    renderer = make_renderer(objects, [Light(90, 0, 0.5)])
    keys = [Light(0, 45, 3)] * 3
    consistent, _ = renderer.radiance(view, keys)
    other, _ = renderer.radiance(view, [keys[0], Light(0, 10, 3), keys[2]])
    left, top, right, bottom = view.box_px((0, 0))
    changed = (other != consistent).any(axis=-1)
    assert changed[top:bottom, left:right].mean() > 0.4
    changed[top:bottom, left:right] = False
    assert not changed.any()


def test_ground_truth_of_a_sphere() -> None:
    # Theory: the unit sphere is its own map of normals; albedo is painted by direction.
    x, y, _ = np.moveaxis(sphere_directions(256, 512), -1, 0)
    painted = Placed(UnitSphere().mesh(), MATT, 0.5 + 0.3 * x + 0.15 * y, CENTRE)
    truth = make_renderer([painted], []).ground_truth(VIEW)
    seen, points = sphere_points(VIEW, CENTRE)
    assert (truth.regions == seen).all()
    assert (truth.distance[~seen] == np.inf).all()
    assert not truth.normal[~seen].any()
    assert not truth.albedo[~seen].any()
    # The rim is left out of the comparison: there depth runs away within a facet.
    inner = points[..., 2] > 0.2
    assert_allclose(truth.distance[inner], CAMERA_DISTANCE - points[inner, 2], atol=2e-3)
    assert_allclose(truth.normal[inner], points[inner], atol=2e-3)
    expected = 0.5 + 0.3 * points[inner, 0] + 0.15 * points[inner, 1]
    assert_allclose(truth.albedo[inner, 0], expected, atol=5e-3)


def test_regions_are_where_objects_cover_the_pixels_centres() -> None:
    view = View(width_px=120, height_px=40, radius_px=12, samples=1)
    objects = [matt_shape(number, (3 * number - 3, 0)) for number in range(3)]
    renderer = make_renderer(objects, [])
    regions = renderer.ground_truth(view).regions
    _, coverage = renderer.radiance(view, [Light(0, 90)] * 3)
    assert ((regions > 0) == (coverage == 1)).all()
    assert [int(regions[20, column]) for column in (24, 60, 96)] == [1, 2, 3]


def test_refuses_what_cannot_be_rendered() -> None:
    with pytest.raises(InputError, match="objects: one or more are accepted"):
        make_renderer([], [])
    renderer = make_renderer([matt_sphere()], [])
    with pytest.raises(InputError, match="keys: 2 given, 1 accepted"):
        renderer.radiance(VIEW, [Light(0, 0)] * 2)
    touching = make_renderer([matt_sphere((-0.9, 0)), matt_sphere((0.9, 0))], [])
    with pytest.raises(InputError, match="number 2 may overlap another one in the image"):
        touching.radiance(VIEW, [Light(0, 0)] * 2)
