import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial import ConvexHull

from stimuli.shapes.displaced_spheres import AbstractShape, sphere_directions

SEEDS = range(8)


def shape_of(seed: int) -> AbstractShape:
    """Return one abstract object."""
    return AbstractShape(np.random.default_rng(seed))


@pytest.mark.parametrize("seed", SEEDS)
def test_mesh_is_closed_and_like_a_sphere(seed: int) -> None:
    # Theory: Euler's characteristic of a surface without holes is 2; three edges serve two faces.
    mesh = shape_of(seed).mesh(32, 64)
    faces = mesh.welded_faces()
    assert mesh.is_closed
    assert len(np.unique(faces)) - 3 * len(faces) // 2 + len(faces) == 2


def test_volume_approaches_that_of_the_surface() -> None:
    # Theory: the volume of a star-shaped body is the integral of radius^3 / 3 over directions.
    shape, generator = shape_of(1), np.random.default_rng(2)
    directions = generator.normal(size=(200_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    cubes = shape.radius(directions) ** 3
    tolerance = 5 * 4 / 3 * np.pi * cubes.std() / np.sqrt(len(cubes))
    assert_allclose(shape.mesh().volume, 4 / 3 * np.pi * cubes.mean(), atol=tolerance)


@pytest.mark.parametrize("seed", SEEDS)
def test_normals_are_those_of_the_surface(seed: int) -> None:
    # Theory: the normal is at right angles to the surface along any way over it, here along
    # longitude and latitude by finite differences.
    shape, step = shape_of(seed), 1e-6
    directions = np.random.default_rng(seed).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    normals = shape.normal(directions)
    assert_allclose(np.linalg.norm(normals, axis=1), 1)
    assert (np.einsum("ij,ij->i", normals, directions) > 0.2).all()  # outwards, nowhere hidden
    for axis in np.eye(3):
        tangent = np.cross(axis, directions)
        ahead, behind = (
            turned / np.linalg.norm(turned, axis=1, keepdims=True)
            for turned in (directions + step * tangent, directions - step * tangent)
        )
        way = ahead * shape.radius(ahead)[:, None] - behind * shape.radius(behind)[:, None]
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        assert_allclose(np.einsum("ij,ij->i", normals, way), 0, atol=2e-3)


def test_normals_of_faces_approach_those_of_the_surface() -> None:
    # Theory: the angle between them shrinks as the faces do.
    largest_deg = []
    for rows in (64, 256):
        mesh = shape_of(3).mesh(rows, 2 * rows)
        corners = mesh.vertices[mesh.faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        smooth = mesh.normals[mesh.faces].mean(axis=1)
        sine = np.linalg.norm(np.cross(across, smooth), axis=1)
        angles = np.arctan2(sine, np.einsum("ij,ij->i", across, smooth))
        largest_deg.append(np.degrees(angles.max()))
    assert largest_deg[1] < 5
    assert largest_deg[1] < largest_deg[0] / 3


@pytest.mark.parametrize("seed", SEEDS)
def test_fits_its_place_and_is_globally_convex(seed: int) -> None:
    # Properties: within the unit sphere but for the sampling; dents take little of the hull.
    mesh = shape_of(seed).mesh(64, 128)
    radii = np.linalg.norm(mesh.vertices, axis=1)
    assert 0.99 < radii.max() < 1.005
    assert radii.min() > 0.4
    assert 0.85 < mesh.volume / ConvexHull(mesh.vertices).volume < 0.98


def test_complexity_is_equal_and_no_two_are_alike() -> None:
    directions = sphere_directions(32, 64)
    logs = np.log([shape_of(seed).radius(directions) for seed in SEEDS])
    assert_allclose(logs.std(axis=(1, 2)), logs[0].std(), rtol=1e-6)
    correlation = np.corrcoef(logs.reshape(len(logs), -1))
    assert np.abs(correlation[~np.eye(len(logs), dtype=bool)]).max() < 0.5


def test_no_shape_is_its_own_mirror_image() -> None:
    directions = sphere_directions(32, 64)
    for seed in SEEDS:
        shape = shape_of(seed)
        radii = shape.radius(directions).ravel()
        for flip in (np.diag([-1, 1, 1]), np.diag([1, -1, 1]), np.diag([1, 1, -1])):
            mirrored = shape.radius(directions @ flip).ravel()
            assert np.corrcoef(radii, mirrored)[0, 1] < 0.9


def test_directions_run_from_pole_to_pole() -> None:
    # Definition: rows from +y to -y, columns around y from +z over +x.
    directions = sphere_directions(4, 8)
    assert directions.shape == (5, 9, 3)
    assert_allclose(directions[0], np.broadcast_to([0, 1, 0], (9, 3)), atol=1e-15)
    assert_allclose(directions[2, [0, 2, 4]], [[0, 0, 1], [1, 0, 0], [0, 0, -1]], atol=1e-15)
    assert (directions[:, 0] == directions[:, -1]).all()
