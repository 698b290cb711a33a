"""Objects whose pictures are known, or nearly so."""

import numpy as np
from numpy.typing import NDArray

from stimuli.camera import View
from stimuli.light_linking.materials import TABLE_2_1, Material
from stimuli.light_linking.placed_objects import Placed
from stimuli.shapes.displaced_spheres import AbstractShape, sphere_directions

MATT = Material("diffuse", "plain", (0.5, 0.5))


class UnitSphere(AbstractShape):
    """The shape that theory knows everything about."""

    def __init__(self) -> None:
        """Nothing is drawn."""

    def radius(self, directions: NDArray[np.floating]) -> NDArray[np.float64]:
        return np.ones(np.shape(directions)[:-1])


def matt_sphere(centre: tuple[float, float] = (0, 0), albedo: float = 0.5) -> Placed:
    """Return a Lambertian unit sphere."""
    return Placed(UnitSphere().mesh(), MATT, np.full((2, 4), albedo), centre)


def matt_shape(seed: int, centre: tuple[float, float] = (0, 0)) -> Placed:
    """Return an abstract object, Lambertian and plain."""
    shape = AbstractShape(np.random.default_rng(seed))
    return Placed(shape.mesh(), MATT, np.full((2, 4), 0.5), centre)


def of_table(letter: str, centre: tuple[float, float] = (0, 0)) -> Placed:
    """Return an abstract object with a material of table 2.1."""
    generator = np.random.default_rng(ord(letter))
    material = TABLE_2_1[letter]
    albedo = material.albedo_at(sphere_directions(256, 512), generator)
    return Placed(AbstractShape(generator).mesh(), material, albedo, centre)


def pixel_centres(view: View) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return x and y of each pixel's centre in object radii, `(height, width)` each."""
    rows, columns = np.mgrid[: view.height_px, : view.width_px] + 0.5
    x = (columns - view.width_px / 2) / view.radius_px
    y = (view.height_px / 2 - rows) / view.radius_px
    return x, y


def sphere_points(
    view: View, centre: tuple[float, float]
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return where a unit sphere is seen, and its visible points around its centre, by pixel."""
    x, y = pixel_centres(view)
    x, y = x - centre[0], y - centre[1]
    seen = x**2 + y**2 < 1
    return seen, np.stack([x, y, np.sqrt(np.maximum(0, 1 - x**2 - y**2))], axis=-1)
