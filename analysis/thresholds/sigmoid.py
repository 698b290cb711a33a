"""The psychometric function of every fit: a cumulative normal between guess and lapse rate.

``guess_rate + (1 - guess_rate - lapse_rate) F(level)``, where F is one half at the threshold and
its 5 % and 95 % points lie a width apart (Schuett, Harmeling, Macke and Wichmann 2016, eq. 1).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri

from algorithms.errors import InputError

Floats = NDArray[np.float64]

WIDTH_ALPHA = 0.05
WIDTH_IN_SIGMAS = float(ndtri(1 - WIDTH_ALPHA) - ndtri(WIDTH_ALPHA))


def rate_at(
    levels: ArrayLike,
    threshold: ArrayLike,
    width: ArrayLike,
    guess_rate: float,
    lapse_rate: ArrayLike,
) -> Floats:
    """Return the share of right answers; all arguments are broadcast."""
    scaled = (np.asarray(levels) - threshold) * WIDTH_IN_SIGMAS / np.asarray(width)
    return np.asarray(guess_rate + (1 - guess_rate - np.asarray(lapse_rate)) * ndtr(scaled))


def slope_at_threshold(width: ArrayLike, guess_rate: float, lapse_rate: ArrayLike) -> Floats:
    """Return the function's rise at its mid-point, as a share of right answers a unit of level."""
    span = 1 - guess_rate - np.asarray(lapse_rate)
    return np.asarray(span * WIDTH_IN_SIGMAS / (np.asarray(width) * np.sqrt(2 * np.pi)))


def distance_to(
    correct: float, width: ArrayLike, guess_rate: float, lapse_rate: ArrayLike
) -> Floats:
    """Return how far beyond the threshold a share of the answers is right.

    Infinite where the lapse rate keeps the function below that share.

    >>> round(float(distance_to(0.95, 30, 0.0, 0.0)), 3)
    15.0
    """
    share = (correct - guess_rate) / (1 - guess_rate - np.asarray(lapse_rate))
    return np.asarray(ndtri(np.minimum(share, 1.0)) * np.asarray(width) / WIDTH_IN_SIGMAS)


def check_share(correct: float, guess_rate: float) -> None:
    """Refuse a share of right answers that no level between guessing and certainty can have.

    Raises
    ------
    InputError
        Naming the shares that are accepted.
    """
    if not guess_rate < correct < 1:
        raise InputError(
            f"correct: {correct} given, above the guess rate of {guess_rate:g} and below 1 accepted"
        )


def within_levels(values: ArrayLike, levels: ArrayLike) -> Floats:
    """Replace by infinity what lies beyond the levels tested: answers say nothing of it."""
    value, tested = np.asarray(values, float), np.asarray(levels)
    above = np.where(value > tested.max(), np.inf, value)
    return np.where(value < tested.min(), -np.inf, above)
