"""Pictures against what optics says about them."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import CAMERA_DISTANCE, View
from stimuli.light_linking.placed_objects import Placed
from stimuli.light_linking.render import make_renderer
from stimuli.light_linking.rigs import KEY_INTENSITY
from stimuli.shapes.displaced_spheres import AbstractShape, sphere_directions
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
    made = make_renderer([matt_sphere(CENTRE)]).render(VIEW, [[light]])
    radiance = made.radiance
    seen, normal = sphere_points(VIEW, CENTRE)
    cosine = np.maximum(0, normal @ light.direction)
    expected = np.where(seen, 0.5 / np.pi * light.intensity * cosine, 0)
    assert (made.coverage == seen).all()
    # Where the light grazes, a facet (1.4 degrees wide) may face away while its normal does not.
    grazing = np.abs(normal @ light.direction) < np.sin(np.radians(1.4))
    assert_allclose(radiance[~grazing, 1], expected[~grazing], atol=1e-3)
    assert (radiance[grazing, 1] <= expected[grazing] + 1e-3).all()
    assert (radiance == radiance[..., :1]).all()


@pytest.mark.parametrize("distance", [1.5, 4.0])
def test_lambert_sphere_under_a_point_light(distance: float) -> None:
    # Theory: the inverse-square law, and Lambert's; the intensity counts at the sphere's centre.
    light = Light(30, 20, intensity=2.0, distance=distance)
    made = make_renderer([matt_sphere(CENTRE)]).render(VIEW, [[light]])
    seen, normal = sphere_points(VIEW, CENTRE)
    way = distance * light.direction - normal
    length = np.linalg.norm(way, axis=-1)
    cosine = (normal * way).sum(axis=-1) / length
    expected = np.where(seen, light.intensity * (distance / length) ** 2 * cosine / np.pi, 0)
    grazing = np.abs(cosine) < np.sin(np.radians(3))
    clear = (expected > 0) & ~grazing
    # A facet may lie nearer to the light than the sphere, or farther.
    assert_allclose(made.shading[clear], expected[clear], rtol=1e-2, atol=1e-3)
    assert not made.shading[~grazing & (cosine < 0)].any()
    assert_allclose(made.radiance[..., 0], 0.5 * made.shading, atol=1e-6)


def test_point_light_far_away_is_a_directional_one() -> None:
    # Theory: the limit of large distance.
    objects = [of_table("g", CENTRE)]
    near, far = (
        make_renderer(objects).render(VIEW, [[Light(40, 30, 2.0, distance)]])
        for distance in (1e4, None)
    )
    assert_allclose(near.radiance, far.radiance, atol=2e-3)


@pytest.mark.parametrize("letter", ["a", "b"])
def test_albedo_times_shading_is_the_radiance_of_a_matt_object(letter: str) -> None:
    # Theory: Lambert's law; with one sample a pixel the ground truth sees the same points.
    renderer = make_renderer([of_table(letter, CENTRE)])
    made = renderer.render(VIEW, [[Light(20, 30, 3), Light(200, 10, 0.5, distance=2)]])
    albedo = renderer.ground_truth(VIEW).albedo
    product = albedo * made.shading[..., None]
    # On the rim a texture is so foreshortened that the last digit of a position tells.
    assert np.isclose(product, made.radiance, rtol=1e-4, atol=1e-5).mean() > 0.999
    assert_allclose(product, made.radiance, rtol=0.03, atol=1e-5)


def test_shading_knows_no_material() -> None:
    # Property: a shiny, textured object has the shading of a plain matt one of its shape.
    shiny = of_table("e", CENTRE)
    matt = replace(shiny, material=MATT, albedo=np.full((2, 4), 0.5))
    rig = [Light(250, 10, 3), Light(90, 45, 1)]
    one, other = (make_renderer([each]).render(VIEW, [rig]) for each in (shiny, matt))
    assert_allclose(one.shading, other.shading, atol=1e-6)
    assert_allclose(other.radiance[..., 1], 0.5 * other.shading, atol=1e-6)


def test_white_surface_facing_the_key_light_has_radiance_one() -> None:
    # Definition of the rig's unit.
    renderer = make_renderer([matt_sphere(albedo=1.0)])
    made = renderer.render(VIEW, [[Light(0, 90, KEY_INTENSITY)]])
    assert_allclose(made.radiance.max(), 1, rtol=2e-3)


def test_light_adds_up() -> None:
    # Theory: light is linear; a shiny object under three lights is the sum of three pictures.
    lights = (Light(20, 30, 3), Light(160, 10, 0.5), Light(90, 0, 0.7, distance=3))
    renderer = make_renderer([of_table("g")])
    together = renderer.render(VIEW, [lights]).radiance
    parts = [renderer.render(VIEW, [[light]]).radiance for light in lights]
    assert_allclose(together, np.sum(parts, axis=0), atol=1e-5)
    twice = renderer.render(VIEW, [[Light(20, 30, 6)]]).radiance
    assert_allclose(twice, 2 * parts[0], rtol=1e-5)


def test_object_shadows_itself() -> None:
    # Theory: a point is dark where the way to the light passes below the shape's own surface,
    # marched here through the formula of the surface, without mesh or ray tracer.
    light = Light(250, -20, KEY_INTENSITY)
    seed, view = 5, View(width_px=60, height_px=60, radius_px=28, samples=1)
    renderer = make_renderer([matt_shape(seed)])
    truth = renderer.ground_truth(view)
    inside = truth.regions > 0
    cosine = truth.normal[inside] @ light.direction
    points = np.stack([*pixel_centres(view), CAMERA_DISTANCE - truth.distance], axis=-1)[inside]
    way = points[:, None] + np.linspace(0.02, 2.5, 200)[:, None] * light.direction
    height = np.linalg.norm(way, axis=-1)
    shape = AbstractShape(np.random.default_rng(seed))
    clearance = (height / shape.radius(way / height[..., None])).min(axis=1) - 1

    found = renderer.render(view, [[light]]).radiance[inside, 0]
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
    alone = make_renderer([target]).render(view, [[light]]).radiance
    left = slice(0, 40)
    assert (alone[:, left] > 0.1).any()
    for neighbour in (matt_shape(2, (0.0, 0.0)), matt_sphere((2.0, 0.5), albedo=1.0)):
        both = make_renderer([target, neighbour]).render(view, [[light], [light]])
        assert (both.radiance[:, left] == alone[:, left]).all()


def test_only_the_linked_object_changes() -> None:
    # Property: another key light for one object leaves the pixels of all others as they were.
    view = View(width_px=120, height_px=40, radius_px=12, samples=4)
    objects = [matt_shape(1, (-3, 0)), of_table("d", (0, 0)), of_table("b", (3, 0))]
    renderer = make_renderer(objects)
    usual, wrong = ([Light(0, elevation, 3), Light(90, 0, 0.5)] for elevation in (45, 10))
    consistent = renderer.render(view, [usual] * 3).radiance
    other = renderer.render(view, [usual, wrong, usual]).radiance
    left, top, right, bottom = view.box_px((0, 0))
    changed = (other != consistent).any(axis=-1)
    assert changed[top:bottom, left:right].mean() > 0.4
    changed[top:bottom, left:right] = False
    assert not changed.any()


def test_ground_truth_of_a_sphere() -> None:
    # Theory: the unit sphere is its own map of normals; albedo is painted by direction.
    x, y, _ = np.moveaxis(sphere_directions(256, 512), -1, 0)
    painted = Placed(UnitSphere().mesh(), MATT, 0.5 + 0.3 * x + 0.15 * y, CENTRE)
    truth = make_renderer([painted]).ground_truth(VIEW)
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
    renderer = make_renderer(objects)
    regions = renderer.ground_truth(view).regions
    coverage = renderer.render(view, [[Light(0, 90)]] * 3).coverage
    assert ((regions > 0) == (coverage == 1)).all()
    assert [int(regions[20, column]) for column in (24, 60, 96)] == [1, 2, 3]


def test_refuses_what_cannot_be_rendered() -> None:
    with pytest.raises(InputError, match="objects: one or more are accepted"):
        make_renderer([])
    renderer = make_renderer([matt_sphere()])
    with pytest.raises(InputError, match="rigs: 2 given, 1 accepted"):
        renderer.render(VIEW, [[Light(0, 0)]] * 2)
    with pytest.raises(InputError, match="distance of more than 1 is accepted"):
        renderer.render(VIEW, [[Light(0, 0, distance=0.9)]])
    apart = make_renderer([matt_sphere((-1.2, 0)), matt_sphere((1.2, 0))])
    touching = make_renderer([matt_sphere((-0.9, 0)), matt_sphere((0.9, 0))])
    with pytest.raises(InputError, match="number 2 may overlap another one in the image"):
        touching.render(VIEW, [[Light(0, 0)]] * 2)
    uneven: list[list[list[Light]]] = [[[], []], [[Light(0, 0)], [Light(0, 0)] * 2]]
    for rigs in uneven:
        with pytest.raises(InputError, match="rigs: equally many lights for each object"):
            apart.render(VIEW, rigs)
