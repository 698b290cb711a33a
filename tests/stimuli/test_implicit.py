import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from algorithms.errors import InputError
from stimuli.shapes.distance_fields import capsule, ellipsoid, torus, tube
from stimuli.shapes.implicit import Field, gradient_of, smooth_union, surface_of
from stimuli.shapes.mesh import require_closed

TURN = Rotation.from_euler("xyz", [20, 50, 70], degrees=True).as_matrix()
RING = np.array([[np.cos(t), np.sin(t), 0] for t in np.arange(24) * np.pi / 12]) * 0.6
BODIES: dict[str, tuple[Field, float]] = {
    "ball": (ellipsoid([0.1, 0, 0], [0.8, 0.8, 0.8]), 4 / 3 * np.pi * 0.8**3),
    "ellipsoid": (ellipsoid([0, 0, 0.1], [0.9, 0.6, 0.3], TURN), 4 / 3 * np.pi * 0.9 * 0.6 * 0.3),
    "capsule": (
        capsule([-0.4, 0, 0], [0.3, 0.3, 0.1], 0.3),
        np.pi * 0.3**2 * np.sqrt(0.59) + 4 / 3 * np.pi * 0.3**3,
    ),
    "torus": (torus(0.7, 0.25), 2 * np.pi**2 * 0.7 * 0.25**2),
    "ring": (tube(RING, np.full(24, 0.2), closed=True), 2 * np.pi**2 * 0.6 * 0.2**2),
}


@pytest.mark.parametrize("name", BODIES)
def test_volume(name: str) -> None:
    # Theory: solid geometry; Pappus for the rings.
    field, volume = BODIES[name]
    mesh = surface_of(field, cells=96)
    require_closed(mesh, name)
    assert_allclose(mesh.volume, volume, rtol=3e-3)


@pytest.mark.parametrize("name", BODIES)
def test_vertices_lie_on_the_surface_with_its_normals(name: str) -> None:
    field, _ = BODIES[name]
    mesh = surface_of(field, cells=48)
    assert_allclose(field(mesh.vertices), 0, atol=1e-7)
    assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1)
    # Property: the field rises along the normal at the rate of a distance, and not across it.
    ahead = field(mesh.vertices + 1e-3 * mesh.normals)
    across = np.cross(mesh.normals, [0.36, 0.48, 0.8])
    beside = field(mesh.vertices + 1e-4 * across)
    assert_allclose(ahead, 1e-3, rtol=0.02)
    assert np.abs(beside).max() < 1e-6


@pytest.mark.parametrize("name", ["ball", "capsule", "torus", "ring"])
def test_these_are_distances(name: str) -> None:
    # Definition: a distance's gradient has length 1, here outside, away from where two sides meet.
    points = np.random.default_rng(3).normal(size=(2000, 3))
    field, _ = BODIES[name]
    outside = points[field(points) > 0.05]
    lengths = np.linalg.norm(gradient_of(field, outside), axis=1)
    assert_allclose(np.median(lengths), 1, atol=1e-6)
    assert (np.abs(lengths - 1) < 1e-3).mean() > 0.98


def test_a_tube_is_as_near_as_its_curve() -> None:
    # Another way: the least distance to many samples of the curve.
    points = np.array([[-0.6, -0.2, 0], [-0.2, 0.4, 0.2], [0.3, 0, -0.2], [0.6, 0.3, 0.1]])
    field = tube(points, np.full(4, 0.1))
    places = np.random.default_rng(5).uniform(-1, 1, size=(300, 3))
    thin = surface_of(tube(points, np.full(4, 0.03)), cells=128)
    nearest = np.linalg.norm(places[:, None] - thin.vertices[None], axis=2).min(axis=1)
    assert_allclose(field(places) + 0.1, nearest + 0.03, atol=4e-3)


def test_a_tube_passes_its_points_at_their_radii() -> None:
    points = np.array([[-0.6, 0, 0], [0, 0.1, 0], [0.6, 0, 0]])
    radii = np.array([0.1, 0.3, 0.2])
    assert_allclose(tube(points, radii)(points), -radii, atol=1e-6)


def test_a_smooth_union_holds_its_parts_and_a_fillet() -> None:
    parts = [capsule([-0.5, 0, 0], [0.5, 0, 0], 0.2), capsule([0, 0, 0], [0, 0.8, 0], 0.15)]
    union = smooth_union(parts, 0.05)
    points = np.random.default_rng(1).uniform(-1, 1, size=(5000, 3))
    hard = np.minimum(parts[0](points), parts[1](points))
    assert (union(points) <= hard + 1e-12).all()
    assert (union(points) >= hard - 0.05 * np.log(2) - 1e-12).all()
    corner = np.array([0.17, 0.22, 0])  # just outside of both
    assert min(part(corner) for part in parts) > 0
    assert union(corner) < 0


def test_parts_far_from_the_samples_near_the_surface_are_not_missed() -> None:
    # The field is exact only near its surface; sampled everywhere it gives the same mesh.
    field = smooth_union([ellipsoid([0.4, 0, 0], [0.5, 0.1, 0.1]), torus(0.6, 0.1)], 0.02)
    mesh = surface_of(field, cells=64)
    finer = surface_of(field, cells=128)
    assert_allclose(mesh.volume, finer.volume, rtol=0.02)


@pytest.mark.parametrize(
    ("field", "message"),
    [
        (ellipsoid([0, 0, 0], [1.5, 0.2, 0.2]), "it leaves that"),
        (ellipsoid([5, 0, 0], [1, 1, 1]), "there is none"),
        (ellipsoid([0, 0, 0], [9, 9, 9]), "there is none"),
    ],
)
def test_refuses_a_surface_that_is_not_inside(field: Field, message: str) -> None:
    with pytest.raises(InputError, match=message):
        surface_of(field, cells=32)
