"""How far estimated lights are from the true ones."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.optimize import linear_sum_assignment

from algorithms.errors import InputError
from algorithms.light import Light, angle_between_deg

WEAK: Final = 0.15
"""An extra light weaker than this, as a share of the strongest estimated one, does no harm."""


@dataclass(frozen=True)
class LightError:
    """The errors of estimated lights, each assigned to the true one that it stands for.

    Attributes
    ----------
    estimated, true
        The places of the lights that are assigned to each other, in both lists.
    angle_deg
        Of each pair, the great-circle angle, 0..180.
    azimuth_deg, elevation_deg
        Of each pair, the absolute differences; of azimuths the shorter way around, 0..180. Near the
        viewing axis the azimuth's means little.
    missed
        How many true lights have no estimated one.
    extra
        How many estimated lights have no true one.
    strong_extra
        How many of these have 15 % or more of the strongest one's intensity.
    """

    estimated: tuple[int, ...]
    true: tuple[int, ...]
    angle_deg: tuple[float, ...]
    azimuth_deg: tuple[float, ...]
    elevation_deg: tuple[float, ...]
    missed: int
    extra: int
    strong_extra: int

    @property
    def number_is_right(self) -> bool:
        """Whether no light is missed and extra ones are weak."""
        return self.missed == 0 and self.strong_extra == 0


def light_error(estimated: Sequence[Light], truth: Sequence[Light]) -> LightError:
    """Compare estimated lights with the true ones.

    Parameters
    ----------
    estimated
        None or more.
    truth
        One or more.

    Returns
    -------
    The errors under the assignment, one to one, with the smallest sum of great-circle angles.

    Raises
    ------
    InputError
        If there is no true light.

    Examples
    --------
    >>> light_error([Light(350, 0), Light(90, 0)], [Light(10, 0)]).azimuth_deg
    (20.0,)
    """
    if not truth:
        raise InputError("truth: one light or more is accepted")
    angles = np.array([[angle_between_deg(light, true) for true in truth] for light in estimated])
    ours, theirs = linear_sum_assignment(angles.reshape(len(estimated), len(truth)))
    pairs = [(estimated[i], truth[j]) for i, j in zip(ours.tolist(), theirs.tolist(), strict=True)]
    strongest = max((light.intensity for light in estimated), default=0.0)
    extra = [light for i, light in enumerate(estimated) if i not in ours]
    return LightError(
        tuple(ours.tolist()),
        tuple(theirs.tolist()),
        tuple(angle_between_deg(light, true) for light, true in pairs),
        tuple(azimuth_error_deg(light, true) for light, true in pairs),
        tuple(abs(light.elevation_deg - true.elevation_deg) for light, true in pairs),
        len(truth) - len(pairs),
        len(extra),
        sum(light.intensity >= WEAK * strongest for light in extra),
    )


def azimuth_error_deg(first: Light, second: Light) -> float:
    """Return the difference of two azimuths, the shorter way around, 0..180 degrees."""
    return abs((first.azimuth_deg - second.azimuth_deg + 180) % 360 - 180)
