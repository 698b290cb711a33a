"""The samples of irradiance against the surface that they stand for."""

import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import Mesh
from stimuli.translucency.surface_pieces import (
    MOST_PIECES,
    SurfacePieces,
    cut_surface,
    surface_area,
)
from tests.stimuli.bodies import UnitSphere


def pieces_of(mesh: Mesh, count: int = 2000, seed: int = 0) -> SurfacePieces:
    return cut_surface(mesh, count, np.random.default_rng(seed))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.integers(500, 20_000), st.floats(0.1, 10))
def test_areas_add_up_to_the_mesh(seed: int, count: int, stretch: float) -> None:
    # Property: nothing is covered twice or left out, whatever the mesh's triangles are like.
    mesh = AbstractShape(np.random.default_rng(seed)).mesh(8, 16)
    mesh = replace(mesh, vertices=mesh.vertices * [1, stretch, 1])
    pieces = pieces_of(mesh, count, seed)
    assert pieces.areas.sum() == pytest.approx(surface_area(mesh), rel=1e-12)
    assert (pieces.areas > 0).all()
    assert_allclose(np.linalg.norm(pieces.normals, axis=1), 1)


def test_area_of_a_sphere() -> None:
    # Theory: 4 pi, less what the facets cut off.
    mesh = UnitSphere().mesh(64, 128)
    assert surface_area(mesh) == pytest.approx(4 * np.pi, rel=2e-3)


@pytest.mark.parametrize("count", [1000, 10_000, 50_000])
def test_count_is_about_what_was_asked_for(count: int) -> None:
    pieces = pieces_of(UnitSphere().mesh(12, 24), count)
    assert 0.9 * count < len(pieces.areas) < 1.5 * count
    assert pieces.spacing == pytest.approx(np.sqrt(4 * np.pi / len(pieces.areas)), rel=0.02)


def test_fine_meshes_keep_their_faces() -> None:
    mesh = UnitSphere().mesh(64, 128)
    proper = len(mesh.welded_faces())
    assert len(pieces_of(mesh, 1000).areas) == proper


def test_pieces_lie_on_the_faces_and_carry_their_normals() -> None:
    # Theory: on a facet of the unit sphere, no farther inside than its sagitta, normal outwards.
    pieces = pieces_of(UnitSphere().mesh(32, 64), 20_000)
    radii = np.linalg.norm(pieces.centres, axis=1)
    assert 0.99 < radii.min() < radii.max() <= 1
    outwards = pieces.centres / radii[:, None]
    assert_allclose(np.einsum("ij,ij->i", outwards, pieces.normals), 1, atol=2e-3)


def test_pieces_are_spread_evenly() -> None:
    # Property: each part of the surface has its share of pieces; small ones are no narrower.
    pieces = pieces_of(UnitSphere().mesh(12, 24), 20_000)
    assert pieces.areas.std() < 0.5 * pieces.areas.mean()
    octant = (pieces.centres > 0) @ [1, 2, 4]
    shares = np.bincount(octant, minlength=8) / len(octant)
    assert_allclose(shares, 1 / 8, atol=0.01)


def test_moments_of_the_whole_surface() -> None:
    # Theory: integrals of 1, x and x x^T over the mesh are sums over pieces, with their spreads.
    mesh = AbstractShape(np.random.default_rng(4)).mesh(6, 12)
    corners = mesh.vertices[mesh.faces]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(across, axis=1) / 2
    # Exact for quadratics: the mean over the three midpoints of a triangle's edges.
    midpoints = (corners + np.roll(corners, 1, axis=1)) / 2
    second = np.einsum("n,nki,nkj->ij", areas / 3, midpoints, midpoints)
    first = np.einsum("n,nki->i", areas / 3, midpoints)

    pieces = pieces_of(mesh, 700)
    assert_allclose(pieces.areas @ pieces.centres, first, rtol=1e-9, atol=1e-12)
    outer = np.einsum("ni,nj->nij", pieces.centres, pieces.centres)
    found = np.einsum("n,nij->ij", pieces.areas, outer + pieces.spreads)
    assert_allclose(found, second, rtol=1e-9, atol=1e-12)


def test_cuttings_differ_by_seed_alone() -> None:
    mesh = UnitSphere().mesh(8, 16)
    first, again, other = pieces_of(mesh), pieces_of(mesh), pieces_of(mesh, seed=1)
    assert (first.centres == again.centres).all()
    assert len(first.areas) != len(other.areas) or (first.centres != other.centres).any()


@pytest.mark.parametrize("count", [0, 499, MOST_PIECES + 1])
def test_refuses_too_few_or_too_many(count: int) -> None:
    message = f"points: {count} given, 500 to {MOST_PIECES} accepted"
    with pytest.raises(InputError, match=re.escape(message)):
        pieces_of(UnitSphere().mesh(8, 16), count)


def test_refuses_a_mesh_without_area() -> None:
    mesh = UnitSphere().mesh(8, 16)
    with pytest.raises(InputError, match="mesh: one with an area is accepted"):
        pieces_of(replace(mesh, vertices=mesh.vertices * 0))
