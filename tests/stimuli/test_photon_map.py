"""Density of photons: against a loop in numpy, on planes, on curved surfaces, around corners."""

from typing import Any

import mitsuba as mi
import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.photons.photon_map import EnergyBalance, PhotonMap

UP = (0.0, 1.0, 0.0)
Rows = NDArray[np.float64]

pytestmark = pytest.mark.usefixtures("llvm")


def photon_map(positions: Rows, normals: Rows, powers: Rows) -> PhotonMap:
    point, normal, colour = (
        kind(array.T.astype(np.float32))
        for kind, array in ((mi.Point3f, positions), (mi.Normal3f, normals), (mi.Color3f, powers))
    )
    total = powers.sum(axis=0)
    energy = EnergyBalance(total, total, *[np.zeros(3)] * 4)
    return PhotonMap(point, normal, mi.Vector3f(0, 1, 0), colour, energy)


def on_a_plane(count: int, power: float, seed: int = 0) -> PhotonMap:
    """Return photons at random over the square -1..1 of the plane y = 0, of that power in all."""
    places = np.random.default_rng(seed).uniform(-1, 1, (count, 3)) * [1, 0, 1]
    return photon_map(places, np.tile(UP, (count, 1)), np.full((count, 3), power / count))


def looped(
    photons: tuple[Rows, Rows, Rows], points: Rows, normals: Rows, radii: Rows
) -> NDArray[np.float64]:
    """Return the irradiance by a plain sum over all photons."""
    positions, photon_normals, powers = photons
    total = []
    for point, normal, radius in zip(points, normals, radii, strict=True):
        offset = (positions - point) / radius
        closeness = 1 - (offset**2).sum(axis=1)
        near = (closeness > 0) & (np.abs(offset @ normal) < 0.25)
        near &= photon_normals @ normal > 0.7
        total.append((powers * closeness[:, None])[near].sum(axis=0) * 2 / np.pi / radius**2)
    return np.array(total)


def scattered(count: int, seed: int) -> tuple[Rows, Rows, Rows]:
    """Return photons on a plane, a sphere and at random in space, with coloured powers."""
    generator = np.random.default_rng(seed)
    directions = generator.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    flat = generator.uniform(-1, 1, (count, 3)) * [1, 0, 1]
    anywhere = generator.uniform(-1, 1, (count, 3))
    positions = np.concatenate([flat, directions, anywhere]).astype(np.float32)
    normals = np.concatenate([np.tile(UP, (count, 1)), directions, directions])
    powers = generator.uniform(0.1, 1, (3 * count, 3))
    return positions.astype(np.float64), normals, powers


@pytest.mark.parametrize("seed", [0, 1])
def test_nearest_photons_are_the_kernels_sum(seed: int) -> None:
    # Another implementation: brute force.
    photons = scattered(3000, seed)
    places = slice(None, None, 90)
    points, normals = photons[0][places], photons[1][places]
    distances = np.linalg.norm(points[:, None] - photons[0], axis=-1)
    radii = np.sort(distances, axis=1)[:, 19]
    expected = looped(photons, points, normals, radii)
    found = photon_map(*photons).radiance(points, normals, np.pi, nearest=20)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6 * expected.max())
    assert (expected.max(axis=1) > 0).mean() > 0.9
    # No farther than the radius.
    found = photon_map(*photons).radiance(points, normals, np.pi, nearest=20, radius=0.1)
    expected = looped(photons, points, normals, np.minimum(radii, 0.1))
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6 * expected.max())


@pytest.mark.parametrize("radius", [0.03, 0.3])
def test_photons_within_a_radius_are_the_kernels_sum(radius: float) -> None:
    # Another implementation: brute force. Photons that share a voxel are merged at their centroid:
    # within its share of the kernel's slope.
    photons = scattered(3000, seed=2)
    places = slice(None, None, 90)
    points, normals = photons[0][places], photons[1][places]
    expected = looped(photons, points, normals, np.full(len(points), radius))
    found = photon_map(*photons).radiance(points, normals, np.pi, radius=radius)
    tolerance = 0.01 if radius < 0.1 else 0.05
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance * expected.max())
    np.testing.assert_allclose(found.mean(), expected.mean(), rtol=0.01)
    assert (expected.max(axis=1) > 0).mean() > 0.9


@pytest.mark.parametrize("reach", [{"radius": 0.2}, {"nearest": 2000}])
def test_even_light_on_a_plane(reach: dict[str, Any]) -> None:
    # Theory: radiance = albedo / pi times power by area; inside, away from the border.
    photons = on_a_plane(100_000, power=8.0)
    points = np.random.default_rng(1).uniform(-0.7, 0.7, (400, 3)) * [1, 0, 1]
    found = photons.radiance(points, np.tile(UP, (400, 1)), (0.9, 0.6, 0.3), **reach)
    expected = np.array([0.9, 0.6, 0.3]) / np.pi * 8.0 / 4
    np.testing.assert_allclose(found.mean(axis=0), expected, rtol=0.01)
    assert found[:, 0].std() < 0.05 * expected[0]


@pytest.mark.parametrize("reach", [{"radius": 0.25}, {"nearest": 1500}])
def test_even_light_on_a_sphere(reach: dict[str, Any]) -> None:
    # Theory: the kernel's norm is the same on a sphere, even if it reaches a quarter of a radian.
    directions = np.random.default_rng(3).normal(size=(100_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    photons = photon_map(directions, directions, np.full((100_000, 3), 4 * np.pi / 100_000))
    found = photons.radiance(directions[:400], directions[:400], np.pi, **reach)
    np.testing.assert_allclose(found.mean(), 1.0, rtol=0.01)


def test_light_does_not_leak_around_a_corner_or_through_a_sheet() -> None:
    # Property: photons of a wall, of the sheet's other side and of a step are another surface's.
    generator = np.random.default_rng(4)
    count = 20_000
    wall = generator.uniform(0, 1, (count, 3)) * [0, 1, 1]
    for positions, normal in (
        (wall, (1.0, 0.0, 0.0)),
        (wall[:, [1, 0, 2]], (0.0, -1.0, 0.0)),
        (wall[:, [1, 0, 2]] - [0, 0.03, 0], UP),
    ):
        photons = photon_map(positions, np.tile(normal, (count, 1)), np.ones((count, 3)))
        points = np.array([[0.001, 0.0, 0.5], [0.03, 0.0, 0.4]])
        for nearest in (None, 5000):
            found = photons.radiance(points, np.tile(UP, (2, 1)), 1.0, radius=0.1, nearest=nearest)
            assert (found == 0).all()
        lit = photons.radiance(positions[:2], np.tile(normal, (2, 1)), 1.0, radius=0.1)
        assert (lit > 0).all()


def test_a_focus_costs_no_energy() -> None:
    # Property: half of the photons in one spot, many of them in one place; power by area integrates
    # to the power, whatever is merged.
    generator = np.random.default_rng(5)
    count = 50_000
    spread = np.where(np.arange(count) % 2, 0.3, 1e-3)[:, None]
    positions = generator.normal(size=(count, 3)) * spread * [1, 0, 1]
    positions[::10] = 0
    photons = photon_map(positions, np.tile(UP, (count, 1)), np.full((count, 3), 1 / count))
    axis = np.linspace(-2, 2, 401)
    x, z = np.meshgrid(axis, axis)
    points = np.stack([x, np.zeros_like(x), z], axis=-1).reshape(-1, 3)
    found = photons.radiance(points, np.tile(UP, (len(points), 1)), np.pi, radius=0.05)
    np.testing.assert_allclose(found[:, 0].sum() * 0.01**2, 1.0, rtol=5e-3)


def test_few_photons_are_no_trouble() -> None:
    # Property: none, one, and fewer than asked for.
    point, up = np.zeros((1, 3)), np.array([UP])
    empty = photon_map(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)))
    for reach in ({"radius": 0.1}, {"nearest": 50}):
        assert (empty.radiance(point, up, 0.5, **reach) == 0).all()
    single = on_a_plane(1, power=2.0)
    place = single.positions.astype(np.float64)
    found = single.radiance(place, up, np.pi, radius=0.5)
    np.testing.assert_allclose(found, 2.0 * 2 / np.pi / 0.25, rtol=1e-5)
    assert np.isfinite(single.radiance(place, up, 0.5, nearest=50)).all()
    assert np.isfinite(on_a_plane(3, 1.0).radiance(point, up, 0.5, nearest=50)).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"radius": None}, "radius, nearest: one of them"),
        ({"radius": 0.0}, "radius: 0.0 given"),
        ({"radius": np.inf}, "radius: inf given"),
        ({"nearest": 1}, "nearest: 1 given"),
        ({"points": np.zeros(3)}, "points: finite numbers of shape"),
        ({"normals": np.full((1, 3), np.nan)}, "normals: finite numbers of shape"),
    ],
)
def test_arguments_out_of_range_are_refused(change: dict[str, Any], message: str) -> None:
    arguments = {"points": np.zeros((1, 3)), "normals": np.array([UP]), "albedo": 0.5}
    with pytest.raises(InputError, match=message):
        on_a_plane(10, 1.0).radiance(**{**arguments, "radius": 0.1, **change})
