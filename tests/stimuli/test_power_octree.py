"""The octree against sums over its points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from stimuli.translucency.power_octree import PowerOctree, cluster
from stimuli.translucency.surface_pieces import SurfacePieces, cut_surface
from tests.stimuli.bodies import UnitSphere


def points(count: int, seed: int, size: float = 1.0) -> SurfacePieces:
    """Return scattered points that spread nowhere."""
    generator = np.random.default_rng(seed)
    centres = generator.normal(size=(count, 3)) * size
    areas = generator.uniform(1, 2, size=count)
    return SurfacePieces(centres, centres, areas, np.zeros((count, 3, 3)))


def parts(octree: PowerOctree, index: int) -> NDArray[np.int64]:
    """Return the places of the largest proper parts of a cluster, as a walk meets them."""
    found = []
    part = index + 1
    while part < octree.following[index]:
        found.append(part)
        part = int(octree.following[part])
    return np.array(found, dtype=np.int64)


@settings(max_examples=30, deadline=None)
@given(st.integers(2, 400), st.integers(0, 10**6), st.floats(1e-3, 1e3))
def test_every_cluster_is_the_sum_of_its_parts(count: int, seed: int, size: float) -> None:
    # Property: power, centre and spread of the whole follow from those of the parts.
    pieces = points(count, seed, size)
    powers = np.random.default_rng(seed + 1).uniform(0.1, 1, size=count)
    octree = cluster(pieces, powers)
    assert octree.following[0] == len(octree.powers)
    rows, columns = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
    for index in np.flatnonzero(octree.areas > 0):
        inside = parts(octree, int(index))
        assert len(inside) > 1
        share = octree.powers[inside] / octree.powers[index]
        assert share.sum() == pytest.approx(1)
        assert_allclose(share @ octree.centres[inside], octree.centres[index], atol=1e-9 * size)
        arms = octree.centres[inside] - octree.centres[index]
        spread = share @ (octree.spreads[inside] + arms[:, rows] * arms[:, columns])
        assert_allclose(octree.spreads[index], spread, atol=1e-9 * size**2)


def test_leaves_are_the_points() -> None:
    pieces = points(300, 1)
    powers = np.random.default_rng(2).uniform(0.1, 1, size=300)
    octree = cluster(pieces, powers)
    leaves = octree.following == np.arange(len(octree.powers)) + 1
    assert (octree.areas[leaves] == 0).all()
    assert (octree.areas[~leaves] > 0).all()
    assert_allclose(np.sort(octree.powers[leaves]), np.sort(powers))
    assert_allclose(np.sort(octree.centres[leaves, 0]), np.sort(pieces.centres[:, 0]))


def test_root_is_the_whole_surface() -> None:
    # Theory: an evenly lit unit sphere has its centre in the middle and spreads by 1/3 along each
    # axis.
    pieces = cut_surface(UnitSphere().mesh(32, 64), 4000, np.random.default_rng(0))
    octree = cluster(pieces, pieces.areas)
    assert octree.powers[0] == pytest.approx(pieces.areas.sum())
    assert octree.areas[0] == pytest.approx(pieces.areas.sum())  # more than 2 pi times 1
    assert_allclose(octree.centres[0], 0, atol=1e-6)
    assert_allclose(octree.spreads[0], [1 / 3, 1 / 3, 1 / 3, 0, 0, 0], atol=3e-3)


def test_what_lies_far_apart_is_no_small_cluster() -> None:
    # Theory: two points as one disc that spreads as much, mean square distance = area / 2 pi.
    centres = np.array([[0.0, 0, 0], [1, 1, 1]])
    pair = SurfacePieces(centres, centres, np.full(2, 1e-6), np.zeros((2, 3, 3)))
    octree = cluster(pair, np.ones(2))
    assert octree.areas[0] == pytest.approx(2 * np.pi * 3 / 4)


def test_dark_clusters_need_not_be_looked_into() -> None:
    pieces = points(500, 3)
    powers = np.where(pieces.centres[:, 0] > 0, 1.0, 0.0)
    octree = cluster(pieces, powers)
    assert (octree.areas[octree.powers == 0] == 0).all()
    assert not cluster(pieces, np.zeros(500)).powers.any()


def test_a_single_point_and_points_in_one_place() -> None:
    alone = cluster(points(1, 0), np.ones(1))
    assert len(alone.powers) == 1
    assert alone.following.tolist() == [1]
    together = SurfacePieces(np.ones((3, 3)), np.ones((3, 3)), np.ones(3), np.zeros((3, 3, 3)))
    octree = cluster(together, np.ones(3))
    assert_allclose(octree.powers, [3, 1, 1, 1])
    assert octree.following.tolist() == [4, 2, 3, 4]
