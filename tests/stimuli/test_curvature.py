import numpy as np
from numpy.testing import assert_allclose

from stimuli.shapes.curvature import bending_energy, mean_curvature
from stimuli.shapes.distance_fields import torus
from stimuli.shapes.implicit import surface_of
from stimuli.shapes.superquadric import superquadric
from tests.stimuli.bodies import UnitSphere


def test_a_sphere_bends_alike_everywhere() -> None:
    # Theory: mean curvature 1 / radius, area 4 pi radius^2.
    curvature, area = mean_curvature(UnitSphere().mesh().moved(np.zeros(3), 2))
    assert_allclose(curvature, 0.5, rtol=2e-3)
    assert_allclose(area.sum(), 16 * np.pi, rtol=1e-3)


def test_hollows_bend_the_other_way() -> None:
    curvature, _ = mean_curvature(surface_of(torus(0.75, 0.25), cells=64))
    # Theory: the mean of 1 / r and cos / (R + r cos), at the inner and the outer equator.
    assert_allclose(np.quantile(curvature, [0.002, 0.998]), [1, 2.5], rtol=0.03)


def test_energy_of_a_sphere_is_one_and_of_other_bodies_more() -> None:
    # Theory: Willmore 1965; the torus' energy is pi^2 R^2 / (r sqrt(R^2 - r^2)).
    assert_allclose(bending_energy(UnitSphere().mesh()), 1, rtol=1e-3)
    energy = np.pi**2 * 0.75**2 / (0.25 * np.sqrt(0.75**2 - 0.25**2)) / (4 * np.pi)
    assert_allclose(bending_energy(surface_of(torus(0.75, 0.25))), energy, rtol=1e-3)


def test_energy_of_an_ellipsoid() -> None:
    # Theory: a spheroid's energy by quadrature over its polar angle.
    a, c = 0.5, 1.0
    angle = (np.arange(20_000) + 0.5) * np.pi / 20_000
    stretch = np.sqrt(a**2 * np.cos(angle) ** 2 + c**2 * np.sin(angle) ** 2)
    first, second = a * c / stretch**3, c / (a * stretch)
    area = 2 * np.pi * a * np.sin(angle) * stretch * np.pi / 20_000
    energy = (((first + second) / 2) ** 2 * area).sum() / (4 * np.pi)
    assert_allclose(bending_energy(superquadric((1, 1), (a, c, a))), energy, rtol=2e-3)


def test_energy_does_not_depend_on_size() -> None:
    mesh = superquadric((0.5, 1.2))
    assert_allclose(bending_energy(mesh.moved(np.ones(3), 7)), bending_energy(mesh))
