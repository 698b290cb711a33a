"""From settings to caustics: the maps of an object, and their light on a surface."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.caustics.added import add_caustics
from algorithms.caustics.pattern import caustic_map
from algorithms.caustics.settings import Caustics
from algorithms.color import FloatImage
from algorithms.projection import Plane


def maps_of(relief: NDArray[np.floating[Any]], mask: ArrayLike, settings: Caustics) -> Plane:
    """Return the maps that settings ask for, `(n, rows, columns)`, as `caustic_map` does.

    Raises
    ------
    InputError
        As `caustic_map` does.
    """
    return caustic_map(relief, mask, settings.directions, sharpness=settings.sharpness)


def cast(
    image: NDArray[np.floating[Any]],
    maps: ArrayLike,
    quad: ArrayLike,
    settings: Caustics,
    spared: ArrayLike | None = None,
) -> FloatImage:
    """Add maps to an image as settings say, as `add_caustics` does.

    Raises
    ------
    InputError
        As `add_caustics` does.
    """
    return add_caustics(
        image,
        maps,
        quad,
        settings.strengths,
        colour=settings.colour,
        texture=settings.texture,
        spared=spared,
    )
