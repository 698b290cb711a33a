from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from stimuli.shapes.curvature import bending_energy
from stimuli.shapes.figures import FIGURES
from stimuli.shapes.implicit import surface_of
from stimuli.shapes.mesh import Mesh
from tests.stimuli.test_shape_families import check_mesh

HOLES = {"vertebra": 1, "knot": 1, "twisted-ring": 1}


@cache
def coarse(name: str, seed: int) -> Mesh:
    """Return a figure as a mesh that is quickly made."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "stimuli.shapes.figures.surface_of",
            lambda field, cells, reach=1.05: surface_of(field, cells // 2, reach),
        )
        return FIGURES[name](np.random.default_rng(seed))


def holes(mesh: Mesh) -> int:
    """Return the number of handles of a mesh in one piece, by Euler's characteristic."""
    faces = mesh.welded_faces()
    characteristic = len(np.unique(faces)) - len(faces) // 2
    return 1 - characteristic // 2


@pytest.mark.parametrize("name", FIGURES)
def test_figures_are_closed_in_one_piece(name: str) -> None:
    # Theory: Euler's characteristic is 2 - 2 holes for one piece; a second piece would add 2.
    mesh = coarse(name, 1)
    check_mesh(mesh)
    assert holes(mesh) == HOLES.get(name, 0)


def test_the_first_four_are_of_increasing_complexity() -> None:
    # In place of Lopez-Moreno 2011, fig. 7.11: skull, vertebrae, dolphin and bull.
    energies = [
        bending_energy(coarse(name, 1)) for name in ("pebble", "vertebra", "dolphin", "bull")
    ]
    assert (np.diff(energies) > 0.5).all()


def test_generators_vary_them_a_little() -> None:
    first, second = coarse("dolphin", 1), coarse("dolphin", 2)
    coarse.cache_clear()
    assert first.volume != second.volume
    assert_allclose(first.volume, second.volume, rtol=0.3)
    assert (first.vertices == coarse("dolphin", 1).vertices).all()
