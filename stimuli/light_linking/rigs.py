"""Light rigs: which lights shine on a scene, in the project's frame."""

from typing import Final

import numpy as np

from algorithms.errors import InputError
from algorithms.light import Light

KEY_INTENSITY: Final = float(np.pi)
"""A white diffuse surface that faces the key light reflects radiance 1."""

AMBIENT: Final = (
    Light.from_direction((-1, 0, 1), intensity=KEY_INTENSITY / 4),
    Light(azimuth_deg=90, elevation_deg=0, intensity=KEY_INTENSITY / 4),
)
"""The two weak lights of chapter 2: halfway between +z and -x, and from +y (sec. 2.3)."""

CENTRE_ELEVATIONS_DEG: Final = {"front": 45.0, "back": -45.0, "front-back": 0.0}
"""Around which elevation the two key lights diverge, at azimuth 0: the thesis shows the quadrants
and names no angle (Lopez-Moreno 2011, fig. 2.2)."""


def diverging_keys(placement: str, divergence_deg: float, side: int) -> tuple[Light, Light]:
    """Return the light of most objects and the wrong one, turned apart about the vertical axis.

    Parameters
    ----------
    placement
        `front`, `back` or `front-back`.
    divergence_deg
        The angle between the two, 0 to 90; each of them moves by half of it.
    side
        +1 if the wrong light is the one turned towards the viewer, -1 if it is turned away.

    Raises
    ------
    InputError
        If an argument is not one of these.

    Examples
    --------
    >>> [light.elevation_deg for light in diverging_keys("front-back", 60, side=1)]
    [-30.0, 30.0]
    """
    if placement not in CENTRE_ELEVATIONS_DEG:
        names = ", ".join(CENTRE_ELEVATIONS_DEG)
        raise InputError(f"placement: {placement!r} given, {names} accepted")
    if not 0 <= divergence_deg <= 90:
        raise InputError(f"divergence_deg: {divergence_deg} given, 0 to 90 accepted")
    if side not in (-1, 1):
        raise InputError(f"side: {side} given, -1 or 1 accepted")
    centre_deg = CENTRE_ELEVATIONS_DEG[placement]
    key_deg, wrong_deg = (centre_deg + sign * side * divergence_deg / 2 for sign in (-1, 1))
    return Light(0, key_deg, KEY_INTENSITY), Light(0, wrong_deg, KEY_INTENSITY)
