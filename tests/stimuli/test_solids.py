"""Solids and trees against geometry: volumes, closed surfaces, normals that point out."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from stimuli.scenes.trees import grow_tree
from stimuli.scenes.village import church, house, lamp_post, marker_post
from stimuli.shapes.mesh import Mesh
from stimuli.shapes.solids import box, gable, tube


def test_volumes_are_those_of_geometry() -> None:
    assert_allclose(box((1, 2, 3), (4, 5, 6)).volume, 6)
    assert_allclose(gable((4, 3, 6), 2).volume, 4 * 3 * 6 + 4 * 2 / 2 * 6)
    # A regular polygon of n sides has n/2 sin(2 pi / n) of its circumscribed circle's r^2.
    straight = tube([(0, 0, 0), (0, 1, 0), (0, 2, 0)], 0.5, sides=12)
    assert_allclose(straight.volume, 12 / 2 * np.sin(2 * np.pi / 12) * 0.25 * 2)
    cone = tube([(0, 0, 0), (0, 3, 0)], (1.0, 0.0), sides=400)
    assert_allclose(cone.volume, np.pi, rtol=1e-3)


@pytest.mark.parametrize(
    "mesh",
    [
        box((1, 2, 3)),
        gable((4, 3, 6), 2),
        tube([(0, 0, 0), (0, 1, 0), (0.6, 1.8, 0.3), (1.5, 2, 0.3)], (0.4, 0.3, 0.2, 0.1)),
    ],
    ids=["box", "gable", "bent tube"],
)
def test_solids_are_closed_and_their_normals_point_out(mesh: Mesh) -> None:
    assert mesh.is_closed
    assert mesh.volume > 0
    assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1)
    corners = mesh.vertices[mesh.faces]
    outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    smooth = mesh.normals[mesh.faces].sum(axis=1)
    assert ((outward * smooth).sum(axis=1) > 0).all()


def test_trees_stand_on_the_ground_and_end_in_leaves() -> None:
    tree = grow_tree(np.random.default_rng(4), levels=4, leaves_per_twig=5)
    again = grow_tree(np.random.default_rng(4), levels=4, leaves_per_twig=5)
    assert_allclose(tree.leaves.vertices, again.leaves.vertices)
    assert -0.05 < tree.wood.vertices[:, 1].min() <= 0.01
    assert 0.6 < tree.wood.vertices[:, 1].max() < 1.4
    assert tree.leaves.vertices[:, 1].min() > 0.15  # none on the trunk
    assert len(tree.leaves.faces) % (2 * 5) == 0
    assert_allclose(np.linalg.norm(tree.leaves.normals, axis=1), 1)


def test_what_stands_in_the_village_stands_on_the_ground() -> None:
    parts = house(lit_windows=(0, 5))
    for mesh in (parts.walls, church()[0], lamp_post(), *marker_post()[:1]):
        assert_allclose(mesh.vertices[:, 1].min(), 0, atol=1e-9)
    assert len(parts.lit.faces) == 2 * 2
    assert len(parts.panes.faces) == (9 - 2 + 1) * 2
