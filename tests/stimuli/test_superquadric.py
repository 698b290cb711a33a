import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.special import beta

from algorithms.errors import InputError
from stimuli.shapes.mesh import require_closed
from stimuli.shapes.superquadric import superquadric

CASES = [(1.0, 1.0), (0.4, 0.4), (0.3, 1.0), (1.0, 1.5), (1.5, 0.6), (1.4, 1.4)]


@pytest.mark.parametrize("exponents", CASES)
def test_volume(exponents: tuple[float, float]) -> None:
    # Theory: Jaklic, Leonardis and Solina 2000, eq. 2.60; the mesh is scaled to radius 1.
    first, second = exponents
    axes = np.array([0.8, 1.0, 0.6])
    mesh = superquadric(exponents, (0.8, 1.0, 0.6), rows=256, columns=512)
    x, y, z = axes * np.abs(mesh.vertices).max(axis=0)[1] / axes[1]
    expected = (
        2 * x * y * z * first * second * beta(first / 2 + 1, first) * beta(second / 2, second / 2)
    )
    assert_allclose(mesh.volume, expected, rtol=2e-3)


@pytest.mark.parametrize("exponents", CASES)
def test_points_and_normals_fit_the_implicit_form(exponents: tuple[float, float]) -> None:
    # Theory: the inside-outside function (Barr 1981) is constant, and its gradient is normal.
    first, second = exponents
    mesh = superquadric(exponents, rows=32, columns=64)

    def inside(points: np.ndarray) -> np.ndarray:
        x, y, z = np.abs(points.T) / np.abs(mesh.vertices).max(axis=0)[1]
        across = x ** (2 / second) + z ** (2 / second)
        return np.asarray((across ** (second / first) + y ** (2 / first)) ** (first / 2))

    assert_allclose(inside(mesh.vertices), 1, rtol=1e-9)
    # Away from the planes of symmetry, where finite differences are crude.
    clear = (np.abs(mesh.vertices) > 0.1).all(axis=1)
    points, step = mesh.vertices[clear], 1e-6
    gradient = np.stack(
        [inside(points + axis * step) - inside(points - axis * step) for axis in np.eye(3)], axis=1
    )
    gradient /= np.linalg.norm(gradient, axis=1, keepdims=True)
    assert clear.sum() > 100
    assert_allclose(mesh.normals[clear], gradient, atol=1e-5)


@pytest.mark.parametrize("exponents", [(0.2, 0.2), (0.2, 1.8), (1.8, 1.8), (1.0, 1.0)])
def test_closed_up_to_the_extremes(exponents: tuple[float, float]) -> None:
    mesh = superquadric(exponents)
    require_closed(mesh, "superquadric")
    assert_allclose(mesh.bounding_radius, 1)
    assert np.isfinite(mesh.normals).all()


def test_refuses_what_is_no_superquadric() -> None:
    with pytest.raises(InputError, match=r"exponents: 0\.2\.\.1\.8 are accepted"):
        superquadric((0.1, 1.0))
    with pytest.raises(InputError, match="axes: more than 0 is accepted"):
        superquadric((1.0, 1.0), (1.0, 0.0, 1.0))
