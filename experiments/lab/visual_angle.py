"""How many pixels wide an image is that a study wants so many degrees wide."""

import math

from algorithms.errors import InputError
from experiments.study_parts import Display


def image_width_px(
    display: Display, pixels_per_cm: float | None, distance_cm: float | None
) -> int | None:
    """Return the width that a study wants its images to have in the window.

    Parameters
    ----------
    display
        What the study says.
    pixels_per_cm, distance_cm
        Of the monitor; None where they are not known.

    Returns
    -------
    Pixels, 1 or more; None where the study leaves the size to the window.

    Raises
    ------
    InputError
        If the study says degrees, and size or distance of the monitor are not known.

    Examples
    --------
    >>> image_width_px(Display(width_deg=90), pixels_per_cm=10, distance_cm=60)
    1200
    """
    if display.width_deg is None:
        return display.width_px
    if not pixels_per_cm or not distance_cm:
        raise InputError(
            "display.width_deg: needs the monitor's width and distance; name with --monitor one"
            " that has them in PsychoPy's Monitor Center"
        )
    width_cm = 2 * distance_cm * math.tan(math.radians(display.width_deg) / 2)
    return max(1, round(width_cm * pixels_per_cm))
