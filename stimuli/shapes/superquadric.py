"""Superquadrics: from boxes over ellipsoids to pinched octahedra, by two exponents."""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.shapes.displaced_spheres import check_complexity
from stimuli.shapes.mesh import Mesh, grid_mesh

_EXPONENTS: Final = (0.2, 1.8)
_STEPS: Final = (-0.7, 0.5)
_AXES: Final = (0.7, 1.0)


def superquadric(
    exponents: tuple[float, float],
    axes: tuple[float, float, float] = (1.0, 1.0, 1.0),
    rows: int = 128,
    columns: int = 256,
) -> Mesh:
    """Return a superquadric around the origin, of radius 1, as a closed mesh.

    Parameters
    ----------
    exponents
        How its sections bend from pole to pole and around y, each 0.2..1.8: below 1 box-like, at 1
        round, above 1 pinched.
    axes
        The half axes along x, y and z, more than 0; their ratio counts, for the mesh is scaled
        until its largest radius is 1.
    rows, columns
        Quadrilaterals from pole to pole and around, multiples of 4 that edges may fall on them.

    Raises
    ------
    InputError
        If an exponent or an axis is outside its range.

    Notes
    -----
    Barr 1981, *Superquadrics and angle-preserving transformations*: the parametrisation, whose
    samples crowd where the surface bends, and the normals.
    """
    low, high = _EXPONENTS
    if not all(low <= exponent <= high for exponent in exponents):
        raise InputError(f"exponents: {low}..{high} are accepted, not {exponents}")
    if not all(0 < axis < np.inf for axis in axes):
        raise InputError(f"axes: more than 0 is accepted, not {axes}")
    vertices = _point(exponents, rows, columns) * axes
    dual = _point((2 - exponents[0], 2 - exponents[1]), rows, columns) / axes
    largest = np.linalg.norm(vertices, axis=-1).max()
    return grid_mesh(vertices / largest, dual / np.linalg.norm(dual, axis=-1, keepdims=True))


def random_superquadric(generator: np.random.Generator, complexity: float) -> Mesh:
    """Return a superquadric with axes of its own; the exponents' distance from 1 is given.

    Parameters
    ----------
    generator
        Draws the axes, and for each exponent whether it makes boxes or points; the same for every
        complexity.
    complexity
        0..1: how far the exponents are from 1, up to 0.3 or 1.5. 0 is an ellipsoid; the bending
        energy (`stimuli.shapes.curvature`) grows with it.

    Raises
    ------
    InputError
        If the complexity is outside 0..1.
    """
    check_complexity(complexity)
    x, y, z = (float(axis) for axis in generator.uniform(*_AXES, size=3))
    first, second = (float(1 + complexity * step) for step in generator.choice(_STEPS, size=2))
    return superquadric((first, second), (x, y, z))


def _point(exponents: tuple[float, float], rows: int, columns: int) -> NDArray[np.float64]:
    polar = np.linspace(0, np.pi, rows + 1)[:, None]
    longitude = np.linspace(0, 2 * np.pi, columns + 1)[None, :]
    radial = _signed_power(np.sin(polar), exponents[0])
    x = radial * _signed_power(np.sin(longitude), exponents[1])
    z = radial * _signed_power(np.cos(longitude), exponents[1])
    y = np.broadcast_to(_signed_power(np.cos(polar), exponents[0]), x.shape)
    return np.stack([x, y, z], axis=-1)


def _signed_power(values: NDArray[np.floating[Any]], exponent: float) -> NDArray[np.float64]:
    # A small power makes much of the rounding of sin(pi).
    proper = np.where(np.abs(values) < 1e-12, 0.0, values)
    return np.asarray(np.sign(proper) * np.abs(proper) ** exponent)
