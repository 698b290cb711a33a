"""Settings of caustics, those of the thesis' objects, and the ranges of both."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from algorithms.color import luminance
from algorithms.errors import InputError
from algorithms.projection import Plane

MAX_DIRECTIONS: Final = 20


def checked_directions(directions: Sequence[int]) -> Sequence[int]:
    """Return the numbers of directions of one or more maps."""
    if not directions or not all(
        isinstance(count, int) and 1 <= count <= MAX_DIRECTIONS for count in directions
    ):
        raise InputError(f"directions: whole numbers of 1 to {MAX_DIRECTIONS} are accepted")
    return directions


def check_sharpness(sharpness: float) -> None:
    """Refuse a power that is out of range."""
    if not 0 < sharpness < np.inf:
        raise InputError("sharpness: a finite number of more than 0 is accepted")


def check_texture(texture: float) -> None:
    """Refuse a share that is out of range."""
    if not 0 <= texture <= 1:
        raise InputError("texture: 0..1 is accepted")


def check_strengths(strengths: Sequence[float], maps: int) -> Sequence[float]:
    """Return the strengths of some maps."""
    if len(strengths) != maps or not all(0 <= each < np.inf for each in strengths):
        raise InputError(f"strength: a finite number of 0 or more for each of {maps} maps")
    return strengths


def colour_of(colour: ArrayLike) -> Plane:
    """Return a colour of the luminance of white."""
    tint = np.asarray(colour, dtype=np.float32)
    if tint.shape != (3,) or not np.isfinite(tint).all() or tint.min() < 0 or tint.max() == 0:
        raise InputError("colour: three finite numbers of 0 or more, not all 0, are accepted")
    return np.asarray(tint / np.float32(luminance(tint)))


@dataclass(frozen=True)
class Caustics:
    """Settings of caustics.

    Attributes
    ----------
    directions
        In how many directions symmetry is looked for, 1 to `MAX_DIRECTIONS`, for each map: few give
        simple and focused caustics, many complex ones.
    strengths
        The luminance that each map adds where it is brightest, 0 or more; 1 is the mean luminance
        in the quadrilateral.
    sharpness
        The power that a map is raised to, more than 0: 1 for the symmetry itself, more for thinner
        lines.
    colour
        Red, green and blue of the light, 0 or more; only their ratios count.
    texture
        0..1: how far the surface's own texture shows in the light that it reflects. 0 adds the same
        everywhere (eq. 7.2).

    Raises
    ------
    InputError
        If a value is out of its range, or there are not as many strengths as maps.
    """

    directions: tuple[int, ...] = (1, 20)
    strengths: tuple[float, ...] = (1.5, 2.5)
    sharpness: float = 3.0
    colour: tuple[float, float, float] = (1.0, 1.0, 1.0)
    texture: float = 1.0

    def __post_init__(self) -> None:
        checked_directions(self.directions)
        check_strengths(self.strengths, len(self.directions))
        check_sharpness(self.sharpness)
        colour_of(self.colour)
        check_texture(self.texture)


def _pair(directions: int) -> Caustics:
    """Return a simple map with one of more directions."""
    return Caustics((1, directions))


PRESETS: Final[Mapping[str, Caustics]] = MappingProxyType(
    {
        "mill": _pair(20),
        "can": Caustics((2,), (4.0,)),
        "horse": Caustics((4,), (4.0,)),
        "elephant": Caustics((20,), (4.0,)),
        "vase": _pair(12),
        "doll": _pair(12),
        "car": _pair(12),
        "phone": _pair(4),
        "sphere": Caustics((1,), (4.0,)),
        "skull": _pair(20),
        "vertebrae": _pair(20),
        "dolphin": _pair(20),
        "bull": _pair(20),
    }
)
"""Lopez-Moreno 2011, table 7.1: maps and directions of its objects. The scan has lost every 1, and
the table says nothing of strengths."""
