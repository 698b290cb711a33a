"""Pictures of translucent bodies against the dipole's own theory, and what is refused."""

import re
from dataclasses import replace
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms.errors import InputError, UnavailableError
from algorithms.light import Light
from stimuli.camera import Perspective, View
from stimuli.engine import choose_engine
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import Mesh
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.hierarchical_sum import TOLERANCE, HierarchicalSum
from stimuli.translucency.irradiance import transmittance
from stimuli.translucency.media import MEASURED, Medium
from stimuli.translucency.renderer import (
    MOST_POINTS,
    Translucent,
    TranslucentRenderer,
    exitance_sum,
)
from stimuli.translucency.surface_pieces import cut_surface
from tests.stimuli.bodies import UnitSphere

MARBLE = MEASURED["marble"]
CENTRE = View(width_px=1, height_px=1, radius_px=50, samples=1)
SMALL = View(width_px=48, height_px=48, radius_px=22, samples=4)
llvm = pytest.mark.usefixtures("llvm")


def sphere(rows: int = 48) -> Mesh:
    return UnitSphere().mesh(rows, 2 * rows)


def shape() -> Mesh:
    return AbstractShape(np.random.default_rng(11)).mesh(48, 96)


def slab(half_width: float, thickness: float) -> Mesh:
    """Return a flat box whose upper side is the plane z = 0, with vertices of its own a side."""
    corners: list[NDArray[np.float64]] = []
    normals: list[NDArray[np.float64]] = []
    faces: list[NDArray[np.int64]] = []
    low, high = [-half_width, -half_width, -thickness], [half_width, half_width, 0.0]
    for axis in range(3):
        for side in (low, high):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            square = np.empty((4, 3))
            square[:, axis] = side[axis]
            square[:, u] = [low[u], high[u], high[u], low[u]]
            square[:, v] = [low[v], low[v], high[v], high[v]]
            outwards = 1.0 if side is high else -1.0
            turn = [[0, 1, 2], [0, 2, 3]] if side is high else [[0, 2, 1], [0, 3, 2]]
            faces.append(np.array(turn) + 4 * len(corners))
            corners.append(square)
            normals.append(np.tile(outwards * np.eye(3)[axis], (4, 1)))
    return Mesh(np.concatenate(corners), np.concatenate(normals), None, np.concatenate(faces))


def sums_at(
    total: HierarchicalSum, places: NDArray[np.float64], tolerance: float
) -> NDArray[np.float64]:
    point = mi.Point3f(places.T.astype(np.float32))
    return np.array(total(point, mi.Bool(True), dr.opaque(mi.Float, tolerance))).T


def points_on(mesh: Mesh, count: int) -> NDArray[np.float64]:
    generator = np.random.default_rng(3)
    faces = mesh.faces[generator.integers(len(mesh.faces), size=count)]
    weights = generator.dirichlet(np.ones(3), size=count)
    return np.asarray(np.einsum("nk,nki->ni", weights, mesh.vertices[faces]))


@llvm
@pytest.mark.parametrize("name", ["marble", "skin1", "ketchup"])
def test_hierarchical_sum_is_the_plain_sum(name: str) -> None:
    # Another implementation: the profile summed over every piece in plain NumPy, and over every
    # piece by the kernel; clusters change no value by 1 % where it could be seen in a picture.
    body = Translucent(shape(), MEASURED[name], mm_per_unit=10)
    pieces = cut_surface(body.mesh, 20_000, np.random.default_rng(0))
    entering = np.maximum(0, pieces.normals @ Light(120, 30).direction)
    places = points_on(body.mesh, 100)
    total = exitance_sum(body, pieces, entering)
    clustered, every = sums_at(total, places, TOLERANCE), sums_at(total, places, 0)

    dipole = Dipole.of(body.medium).smoothed(pieces.spacing * 10)
    away = np.linalg.norm(places[:, None] - pieces.centres, axis=-1) * 10
    plain = np.einsum("pnc,n->pc", dipole(away), entering * pieces.areas * 10**2)
    # Pieces have an extent, which the plain sum leaves out.
    assert_allclose(every, plain, rtol=0.02, atol=1e-4 * plain.max())
    visible = every.max() / 3295  # the linear light of the darkest code of 255 but black
    error = np.abs(clustered - every) / np.maximum(every, visible)
    assert error.max() < 0.01
    assert error.mean() < 0.001


@llvm
def test_pieces_are_integrated_to_third_order() -> None:
    # Theory: over a single triangle at some distance, the kernel's sum is the integral.
    corners = np.array([[0.0, 0, 0], [0.5, 0.1, 0], [0.1, 0.4, 0.2], [0.2, 0.1, -0.5]])
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    body = Translucent(Mesh(corners, corners, None, faces), MARBLE, mm_per_unit=3)
    coarse = cut_surface(body.mesh, 500, np.random.default_rng(0))
    fine = cut_surface(body.mesh, 100_000, np.random.default_rng(0))
    places = np.array([[1.5, 0.3, 0.2], [-0.3, 0.9, 0.4]])
    sums = [
        sums_at(exitance_sum(body, pieces, np.ones(len(pieces.areas))), places, 0)
        for pieces in (coarse, fine)
    ]
    assert_allclose(sums[0], sums[1], rtol=1e-4)


@llvm
@pytest.mark.parametrize("name", ["marble", "skin2", "cream"])
def test_even_light_on_a_slab_leaves_by_the_albedo(name: str) -> None:
    # Theory (a furnace): radiant exitance = total reflectance x irradiance, wherever the pieces
    # are finer or coarser than the mean free path.
    medium = MEASURED[name]
    light = Light(0, 90, intensity=2.0)
    for millimetres in (40.0, 400.0):
        body = Translucent(slab(1.0, 0.5), medium, mm_per_unit=millimetres)
        radiance, coverage = TranslucentRenderer(body, points=60_000).radiance(CENTRE, [light])
        passing = float(transmittance(mi.Float(1.0), medium.refractive_index)[0])
        entering = light.intensity * passing
        leaving = np.pi * radiance[0, 0] / passing
        assert coverage == 1
        assert_allclose(leaving, Dipole.of(medium).total_reflectance * entering, rtol=0.02)


@llvm
def test_far_side_brightens_with_decreasing_extinction() -> None:
    # Property: lit from behind, the thinner the medium the brighter the near side.
    light = Light(0, -90)
    brightness = []
    for millimetres in (40.0, 20.0, 10.0, 5.0):
        body = Translucent(sphere(), MEASURED["wholemilk"], millimetres)
        radiance, _ = TranslucentRenderer(body, points=10_000).radiance(CENTRE, [light])
        brightness.append(radiance[0, 0])
    assert (np.diff(brightness, axis=0) > 0).all()
    assert (brightness[-1] > 20 * brightness[0]).all()


@llvm
def test_size_and_density_are_one() -> None:
    # Property: ten times the size of a medium a tenth as dense is the same picture.
    light = Light(20, 10)
    tenth = Medium("thin marble", (0.219, 0.262, 0.300), (0.00021, 0.00041, 0.00071), 1.5)
    first, second = (
        TranslucentRenderer(Translucent(shape(), medium, size), 5000).radiance(SMALL, [light])[0]
        for medium, size in ((MARBLE, 8.0), (tenth, 80.0))
    )
    assert_allclose(first, second, rtol=2e-4, atol=1e-7)


@llvm
def test_dense_media_look_like_lambert() -> None:
    # Limit: where light comes out where it went in, radiance = R_d E F_t(in) F_t(out) / pi.
    light = Light(40, 50, intensity=np.pi)
    body = Translucent(sphere(96), MEASURED["skin2"], mm_per_unit=2000)
    radiance, coverage = TranslucentRenderer(body, points=100_000).radiance(
        SMALL, [light], samples=16
    )
    rows, columns = np.mgrid[:48, :48] + 0.5
    x, y = (columns - 24) / 22, (24 - rows) / 22
    z = np.sqrt(np.maximum(0, 1 - x**2 - y**2))
    cosine = np.stack([x, y, z], axis=-1) @ light.direction
    passing = [
        np.array(transmittance(mi.Float(c.ravel().astype(np.float32)), 1.3)).reshape(48, 48)
        for c in (cosine, z)
    ]
    reflected = Dipole.of(body.medium).total_reflectance[1]
    expected = reflected * np.maximum(cosine, 0) * passing[0] * passing[1]
    inner = (z > 0.5) & (cosine > 0.3) & (coverage == 1)
    assert_allclose(radiance[inner, 1], expected[inner], rtol=0.05)
    assert radiance[inner, 1].mean() == pytest.approx(expected[inner].mean(), rel=0.01)


@llvm
def test_light_adds_up() -> None:
    renderer = TranslucentRenderer(Translucent(shape(), MARBLE, 10, roughness=0.2), 5000)
    lights = [Light(0, 30), Light(120, -20, 0.5), Light(240, 60, 2.0, distance=4.0)]
    together, coverage = renderer.radiance(SMALL, lights)
    apart = [renderer.radiance(SMALL, [light])[0] for light in lights]
    assert_allclose(together, np.sum(apart, axis=0), rtol=2e-3, atol=1e-4)
    assert (coverage[24] > 0).any()
    assert not coverage[0].any()
    assert not together[coverage == 0].any()


@llvm
def test_gloss_is_added_where_the_light_is_mirrored() -> None:
    # Theory: the highlight of a sphere stands where its normal is halfway between light and
    # viewer, is white, and elsewhere adds nothing.
    light = Light(0, 30, np.pi)
    view = replace(SMALL, width_px=96, height_px=96, radius_px=44)
    dull, shiny = (
        TranslucentRenderer(
            Translucent(sphere(), MEASURED["ketchup"], 20, roughness), 5000
        ).radiance(view, [light])[0]
        for roughness in (None, 0.1)
    )
    gloss = shiny - dull
    assert_allclose(gloss[..., 0], gloss[..., 2], atol=1e-4)
    row, column = np.unravel_index(gloss[..., 0].argmax(), (96, 96))
    assert row == pytest.approx(47.5, abs=2)
    assert column == pytest.approx(47.5 + 44 * np.sin(np.radians(30)), abs=2)
    assert gloss[48, 10].max() < 0.01 * gloss.max()


@llvm
def test_cameras_agree_on_what_lights_mean() -> None:
    # Property: a camera that has walked around the object with its light sees what it saw before.
    body = Translucent(sphere(), MEASURED["skin1"], 10)
    renderer = TranslucentRenderer(body, points=5000)
    light = Light(30, 20)
    front, side = (
        renderer.radiance(Perspective(position, (0, 0, 0), 30, 32, 32), [light], samples=16)[0]
        for position in ((0, 0, 6), (6, 0, 0))
    )
    assert_allclose(front, side, atol=0.02 * front.max())


@llvm
def test_samples_leave_no_noise_to_speak_of() -> None:
    # Property: two renders share neither irradiance points nor pixel samples, and differ; the
    # noise of their mean, half of that, is below 1/255 within an object of this size.
    renderer = TranslucentRenderer(Translucent(shape(), MARBLE, 20), 20_000)
    view = View(width_px=128, height_px=128, radius_px=60, samples=1)
    first, second = (renderer.radiance(view, [Light(0, 45, 2)], seed=seed) for seed in (0, 1))
    whole = (first[1] == 1) & (second[1] == 1)
    difference = (first[0] - second[0])[whole]
    assert (difference != 0).any()
    assert np.sqrt((difference**2).mean()) / 2 < 0.5 / 255


@llvm
def test_same_seed_same_picture() -> None:
    renderer = TranslucentRenderer(Translucent(shape(), MARBLE, 20, 0.2), 5000)
    first, again = (renderer.radiance(SMALL, [Light(0, 45)], seed=7) for _ in range(2))
    assert (first[0] == again[0]).all()
    assert (first[1] == again[1]).all()


@llvm
def test_points_are_as_many_as_the_medium_needs() -> None:
    def points(medium: Medium, size: float) -> int:
        return TranslucentRenderer(Translucent(sphere(), medium, size)).points

    assert points(MARBLE, 5) == 50_000
    assert 50_000 < points(MARBLE, 20) < MOST_POINTS
    assert points(MARBLE, 1000) == MOST_POINTS


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"mm_per_unit": 0.0}, "mm_per_unit: more than 0 accepted, not 0.0"),
        ({"mm_per_unit": np.nan}, "mm_per_unit: more than 0 accepted, not nan"),
        ({"roughness": 0.0}, "roughness: 0.001 to 1 or None accepted, not 0.0"),
        (
            {"medium": replace(MARBLE, refractive_index=1.0), "roughness": 0.1},
            "roughness: None accepted at refractive index 1",
        ),
    ],
)
def test_refuses_a_body_that_is_none(change: dict[str, Any], message: str) -> None:
    body: dict[str, Any] = {"mesh": sphere(8), "medium": MARBLE, "mm_per_unit": 1.0}
    with pytest.raises(InputError, match=re.escape(message)):
        Translucent(**(body | change))


def test_refuses_an_open_mesh() -> None:
    mesh = sphere(8)
    with pytest.raises(InputError, match="mesh: a closed one is accepted"):
        Translucent(replace(mesh, faces=mesh.faces[1:]), MARBLE, 1.0)


@llvm
def test_refuses_to_render_in_the_dark_or_with_few_points() -> None:
    body = Translucent(sphere(8), MARBLE, 1.0)
    with pytest.raises(InputError, match="lights: one or more are accepted"):
        TranslucentRenderer(body).radiance(SMALL, [])
    with pytest.raises(InputError, match="points: 10 given, 500 to 2000000 accepted"):
        TranslucentRenderer(body, points=10)


def test_says_which_engine_is_needed() -> None:
    choose_engine("scalar")
    with pytest.raises(UnavailableError, match="translucent objects need llvm or cuda"):
        TranslucentRenderer(Translucent(sphere(8), MARBLE, 1.0))
