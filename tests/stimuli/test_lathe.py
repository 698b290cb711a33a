from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose
from skimage.draw import disk, ellipse, polygon

from algorithms.errors import InputError
from stimuli.shapes.lathe import lathe, lathe_from_silhouette
from stimuli.shapes.mesh import Mesh, require_closed
from stimuli.shapes.vessels import bowl, goblet, vase

POLAR = np.linspace(0, np.pi, 65)
BALL = np.column_stack([np.sin(POLAR), np.cos(POLAR)])
BALL[[0, -1], 0] = 0
BOTTLE = [(0, 1), (0.2, 0.95), (0.15, 0.5), (0.5, 0.0), (0.45, -0.8), (0.3, -0.95), (0, -0.9)]


def test_a_half_circle_gives_a_sphere() -> None:
    mesh = lathe(BALL)
    require_closed(mesh, "ball")
    assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1, atol=1e-6)
    assert_allclose(mesh.normals, mesh.vertices, atol=1e-4)
    assert_allclose(mesh.volume, 4 / 3 * np.pi, rtol=1e-3)


@pytest.mark.parametrize("profile", [BOTTLE, BOTTLE[::-1]])
def test_volume_is_that_of_the_revolved_area(profile: list[tuple[float, float]]) -> None:
    # Theory: Pappus; the area and its centroid from the polygon of the section.
    mesh = lathe(profile, rows=256, columns=256)
    require_closed(mesh, "bottle")
    section = mesh.vertices[mesh.vertices[:, 0] == 0]
    section = section[section[:, 2] >= 0][:, [2, 1]]
    radius, height = section[np.lexsort([np.arange(len(section))])].T
    cross = radius * np.roll(height, -1) - np.roll(radius, -1) * height
    area = cross.sum() / 2
    centroid = ((radius + np.roll(radius, -1)) * cross).sum() / (6 * area)
    assert_allclose(mesh.volume, abs(area) * 2 * np.pi * centroid, rtol=1e-3)


def test_passes_through_its_control_points() -> None:
    mesh = lathe(BOTTLE, rows=2048, columns=4)
    points = np.column_stack(
        [np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 2]), mesh.vertices[:, 1]]
    )
    for control in BOTTLE:
        assert np.linalg.norm(points - control, axis=1).min() < 2e-3


def test_normals_are_at_right_angles_and_the_poles_are_flat() -> None:
    mesh = lathe(BOTTLE, rows=512, columns=64)
    grid = mesh.vertices.reshape(513, 65, 3)
    normals = mesh.normals.reshape(513, 65, 3)
    down = grid[2:] - grid[:-2]
    down /= np.linalg.norm(down, axis=-1, keepdims=True)
    assert np.abs(np.einsum("ijk,ijk->ij", down, normals[1:-1])).max() < 0.02
    assert_allclose(normals[0], np.broadcast_to([0, 1, 0], (65, 3)), atol=1e-12)
    assert_allclose(normals[-1], np.broadcast_to([0, -1, 0], (65, 3)), atol=1e-12)


@pytest.mark.parametrize(
    ("profile", "message"),
    [
        ([(0, 1), (0, -1)], "three or more points"),
        ([(0.1, 1), (1, 0), (0, -1)], "two ends on the axis"),
        ([(0, 1), (-1, 0), (0, -1)], "radii above 0"),
        ([(0, 1), (np.nan, 0), (0, -1)], "radii above 0"),
        ([(0, 1), (1, 0), (1, 0), (0, -1)], "differ from the next"),
        ([(0, 1), (1, -1), (1, 1), (0.5, 1.5), (0, -1)], "crosses neither itself"),
        ([(0, 1), (1, 0.9), (0.02, 0.5), (0.01, 0.2), (1, -0.5), (0, -1)], "crosses neither"),
    ],
)
def test_refuses_what_is_no_profile(profile: list[tuple[float, float]], message: str) -> None:
    with pytest.raises(InputError, match=f"profile: .*{message}"):
        lathe(profile)


@pytest.mark.parametrize("make", [vase, goblet, bowl])
@pytest.mark.parametrize("seed", range(4))
def test_vessels_are_hollow_with_a_wall(
    make: Callable[[np.random.Generator], Mesh], seed: int
) -> None:
    mesh = make(np.random.default_rng(seed))
    require_closed(mesh, "vessel")
    assert_allclose(mesh.bounding_radius, 1)
    points, normals = (
        values.reshape(385, 257, 3)[:, 0, 1:] for values in (mesh.vertices, mesh.normals)
    )
    # Where two sides face away from each other they are a wall apart, nowhere nearer.
    opposite = np.triu(normals @ normals.T < -0.8)
    apart = np.linalg.norm(points[:, None] - points[None], axis=2)
    assert 0.015 < apart[opposite].min() < 0.1
    # Property: what it could hold is much more than what it is made of.
    levels = np.linspace(points[:, 0].min(), points[:, 0].max(), 200)
    nearest = np.abs(points[:, 0] - levels[:, None]).argsort(axis=1)[:, :6]
    filled = np.trapezoid(np.pi * points[nearest, 1].max(axis=1) ** 2, levels)
    assert mesh.volume < 0.5 * filled


def disk_mask(radius: float, centre: tuple[float, float] = (100, 120)) -> np.ndarray:
    mask = np.zeros((200, 240), dtype=bool)
    mask[disk(centre, radius)] = True
    return mask


def largest_tilt_deg(mesh: Mesh, centre: np.ndarray) -> float:
    """Return the largest angle between the normals and those of a sphere."""
    outward = mesh.vertices - centre
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    return float(np.degrees(np.arccos(np.einsum("ij,ij->i", outward, mesh.normals).min())))


def test_a_disk_revolved_is_a_sphere_where_the_disk_is_seen() -> None:
    mesh = lathe_from_silhouette(disk_mask(60, (80, 150)))
    require_closed(mesh, "ball")
    centre = np.array([150.5 - 120, 100 - 80.5, 0])
    distances = np.linalg.norm(mesh.vertices - centre, axis=1)
    assert np.abs(distances - 60).max() < 1
    assert_allclose(mesh.volume, 4 / 3 * np.pi * 60**3, rtol=0.02)
    # No rings of pixels: the normals are those of the sphere within three degrees.
    assert largest_tilt_deg(mesh, centre) < 3


def test_an_ellipse_revolved_is_a_spheroid() -> None:
    mask = np.zeros((200, 300), dtype=bool)
    mask[ellipse(100, 150, 80, 40)] = True
    mesh = lathe_from_silhouette(mask)
    assert_allclose(mesh.volume, 4 / 3 * np.pi * 80 * 40**2, rtol=0.03)


def test_legs_are_revolved_to_a_skirt() -> None:
    # Definition: the outermost edges of each row count, and the mean middle is the axis.
    mask = np.zeros((100, 100), dtype=bool)
    mask[polygon([10, 10, 60, 60], [30, 70, 70, 30])] = True
    mask[55:90, 30:38] = mask[55:90, 62:70] = True
    mesh = lathe_from_silhouette(mask, smoothing_px=1)
    assert_allclose(mesh.volume, np.pi * 20**2 * 80, rtol=0.05)


def test_smoothing_takes_off_pixels_and_no_more() -> None:
    rough, smooth = (lathe_from_silhouette(disk_mask(60), px) for px in (0.7, 6))
    centre = np.array([0.5, -0.5, 0])
    assert largest_tilt_deg(rough, centre) > 5
    assert largest_tilt_deg(smooth, centre) < 2
    assert_allclose(smooth.volume, rough.volume, rtol=0.02)


@pytest.mark.parametrize(
    ("mask", "message"),
    [
        (np.zeros((20, 20), dtype=bool), "at least 4 x 4"),
        (np.ones((20, 20), dtype=np.uint8), "bool"),
        (np.ones((20, 20, 3), dtype=bool), "bool"),
        (np.eye(20, dtype=bool)[:3], "at least 4 x 4"),
        (np.kron(np.eye(2, dtype=bool)[::-1], np.pad(np.ones((8, 8), dtype=bool), 2)), "one piece"),
    ],
)
def test_refuses_what_is_no_silhouette(mask: np.ndarray, message: str) -> None:
    with pytest.raises(InputError, match=f"mask: .*{message}"):
        lathe_from_silhouette(mask)
