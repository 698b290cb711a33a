"""How much a surface bends: the measure by which the complexity of shapes is compared."""

import numpy as np
from numpy.typing import NDArray

from stimuli.shapes.mesh import Mesh


def mean_curvature(mesh: Mesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the mean curvature and the area of each face that has one, `(k,)` each.

    Returns
    -------
    Curvature in 1 / length, positive where the surface is convex as seen from its normals' side,
    and area.

    Notes
    -----
    Half the divergence over the surface of the normals, which are interpolated linearly.
    """
    corners = mesh.vertices[mesh.faces]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    across = np.cross(opposite[:, 1], opposite[:, 2])
    double_area = np.linalg.norm(across, axis=1)
    proper = double_area > 0
    opposite, double_area = opposite[proper], double_area[proper]
    up = across[proper] / double_area[:, None]
    # The gradient of a corner's weight is at right angles to the edge opposite to it.
    gradients = np.cross(up[:, None], opposite) / double_area[:, None, None]
    normals = mesh.normals[mesh.faces][proper]
    return np.einsum("kij,kij->k", normals, gradients) / 2, double_area / 2


def bending_energy(mesh: Mesh) -> float:
    """Return the integral of the squared mean curvature, divided by a sphere's: 1 or more.

    Parameters
    ----------
    mesh
        Closed, with smooth normals.

    Returns
    -------
    Willmore's energy over 4 pi: it does not depend on size or place, is 1 for a sphere alone and
    grows with every dent, edge and limb.

    Notes
    -----
    Willmore 1965, *Note on embedded surfaces*.
    """
    curvature, area = mean_curvature(mesh)
    return float((curvature**2 * area).sum() / (4 * np.pi))
