"""The psychometric function that observers follow, and that adaptive designs assume."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr, ndtri

_WIDTH_IN_DEVIATIONS = ndtri(0.95) - ndtri(0.05)

Floats = NDArray[np.float64]


def psychometric_function(
    level: ArrayLike,
    threshold: ArrayLike,
    width: ArrayLike,
    guess_rate: float,
    lapse_rate: ArrayLike,
) -> Floats:
    """Return the probability of a right answer: g + (1 - g - l) F(level).

    Parameters
    ----------
    level, threshold, width
        In the same unit, the width from F = 5 % to F = 95 %; with the lapse rate they are
        broadcast against each other.
    guess_rate, lapse_rate
        The lower asymptote, and the distance of the upper one from 1.
    """
    return guess_rate + (1 - guess_rate - np.asarray(lapse_rate)) * sigmoid(level, threshold, width)


def sigmoid(level: ArrayLike, threshold: ArrayLike, width: ArrayLike) -> Floats:
    """Return the cumulative normal that is one half at the threshold; arguments as above."""
    distance = np.asarray(level, np.float64) - np.asarray(threshold, np.float64)
    below: Floats = ndtr(_WIDTH_IN_DEVIATIONS * distance / np.asarray(width, np.float64))
    return below
