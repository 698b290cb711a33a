"""The priors of psignifit's fit (Schuett et al. 2016, sec. 2.3), evaluated faster.

psignifit asks for them at every step of its climb to the posterior's mode; through `scipy.stats`
they take most of the time of a fit. Same densities, up to a constant, in closed form.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
Prior = Callable[[Values], Values]

_BETA = 10  # Beta(1, 10): small rates are likelier


def default_priors(levels: Sequence[float]) -> dict[str, Prior]:
    """Return the priors of threshold, width, lapse rate (`lambda`) and overdispersion (`eta`).

    Parameters
    ----------
    levels
        The different stimulus levels in rising order, two or more.

    Returns
    -------
    dict
        Densities by psignifit's names, not normalised: of the threshold, even over the levels with
        a cosine fall to 0 over half their range on either side; of the width, even from twice the
        smallest step to the range, with cosine falls to 0 at the smallest step and at three times
        the range; of the two rates, Beta(1, 10).
    """
    lowest, highest = levels[0], levels[-1]
    span, step = highest - lowest, float(np.diff(levels).min())

    def threshold(values: Values) -> Values:
        outside = np.maximum(np.maximum(lowest - values, values - highest), 0)
        return _cosine_fall(outside / (span / 2))

    def width(values: Values) -> Values:
        below = np.maximum(2 * step - values, 0) / step
        above = np.maximum(values - span, 0) / (2 * span)
        return _cosine_fall(below) * _cosine_fall(above)

    return {"threshold": threshold, "width": width, "lambda": _beta, "eta": _beta}


def _cosine_fall(distance: Values) -> Values:
    """Fall from 1 at distance 0 to 0 at distance 1 and beyond."""
    return (1 + np.cos(np.pi * np.minimum(distance, 1))) / 2


def _beta(values: Values) -> Values:
    inside = (values >= 0) & (values <= 1)
    return np.where(inside, (1 - np.clip(values, 0, 1)) ** (_BETA - 1), 0.0)
