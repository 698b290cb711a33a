"""Intervals and tests of a mean that has bounds, such as a share (0 to 1) or a rank (1 to k).

Near a bound the spread of a sample says little, and intervals of the form "mean plus or minus"
are too narrow there. Wilson's (1927) interval of a share is not; here it is used for any bounded
mean over participants, with the number of independent answers that would have the standard error
found (the "effective sample size") and the t distribution, as surveys do for shares in clustered
samples (Korn and Graubard 1998; Franco et al. 2019).
"""

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from analysis.bootstrap import Matrix
from analysis.estimates import CONFIDENCE

Flags = NDArray[np.bool_]


def mean_interval(
    mean: Matrix,
    standard_error: Matrix,
    participants: int,
    bounds: tuple[float, float] = (0.0, 1.0),
    confidence: float = CONFIDENCE,
) -> tuple[Matrix, Matrix]:
    """Return intervals of means over participants that lie between bounds.

    Parameters
    ----------
    mean, standard_error
        One entry a mean; the standard error over participants.
    participants
        How many; with fewer than two there is no interval (NaN).
    bounds
        The lowest and the highest value there can be.
    confidence
        Above 0 and below 1.

    Notes
    -----
    Where all participants agree (standard error 0) the interval is that of Clopper and Pearson
    (1934) for the share of participants who do, the others being anywhere within the bounds.
    """
    mean, standard_error = np.asarray(mean, float), np.asarray(standard_error, float)
    if participants < 2:
        return np.full(mean.shape, np.nan), np.full(mean.shape, np.nan)
    low, high = bounds
    share, error, alike = _scaled(mean, standard_error, bounds)
    reach = stats.t.ppf((1 + confidence) / 2, participants - 1)
    variance = share * (1 - share)
    size = np.divide((reach * error) ** 2, variance, out=np.zeros_like(share), where=~alike)
    centre = (share + size / 2) / (1 + size)
    half = np.sqrt(size * variance + size**2 / 4) / (1 + size)
    others = 1 - ((1 - confidence) / 2) ** (1 / participants)
    below = np.where(alike, share * (1 - others), centre - half)
    above = np.where(alike, share + others * (1 - share), centre + half)
    return low + (high - low) * below, low + (high - low) * above


def p_above(
    mean: Matrix,
    standard_error: Matrix,
    participants: int,
    value: float,
    bounds: tuple[float, float] = (0.0, 1.0),
) -> Matrix:
    """Return one-sided p-values of "the mean is not above a value", as `mean_interval` has it.

    An interval of confidence ``1 - 2 alpha`` lies above the value where this is below alpha.

    Parameters
    ----------
    mean, standard_error, participants, bounds
        As in `mean_interval`.
    value
        Within the bounds.
    """
    mean, standard_error = np.asarray(mean, float), np.asarray(standard_error, float)
    if participants < 2:
        return np.full(mean.shape, np.nan)
    share, error, alike = _scaled(mean, standard_error, bounds)
    at = (value - bounds[0]) / (bounds[1] - bounds[0])
    spread = error * np.sqrt(
        np.divide(at * (1 - at), share * (1 - share), out=np.ones_like(share), where=~alike)
    )
    distance = np.divide(share - at, spread, out=np.zeros_like(share), where=spread > 0)
    beyond = np.divide(at, share, out=np.ones_like(share), where=share > at)
    alone = np.where(share > at, beyond**participants, 1.0)
    return np.where(alike, alone, stats.t.sf(distance, participants - 1))


def ratio_of_sums(totals: Matrix, counts: Matrix) -> tuple[Matrix, Matrix]:
    """Return the mean over all answers and its standard error over participants.

    Parameters
    ----------
    totals, counts
        Shape (participants, cells), as in `analysis.bootstrap.Sums`.

    Returns
    -------
    mean, standard_error : numpy.ndarray
        Shape (cells,). The error is NaN for fewer than two participants.

    Notes
    -----
    Ratio estimator (Cochran 1977, sec. 2.11): the cluster-robust error of a generalised estimating
    equation with independence as working correlation, times ``sqrt(m / (m - 1))``.
    """
    answers = counts.sum(axis=0)
    mean = totals.sum(axis=0) / answers
    squares = ((totals - mean * counts) ** 2).sum(axis=0)
    participants = (counts > 0).sum(axis=0)
    scale = np.divide(
        participants, participants - 1.0, out=np.full(len(mean), np.nan), where=participants > 1
    )
    return mean, np.sqrt(scale * squares) / answers


def _scaled(
    mean: Matrix, standard_error: Matrix, bounds: tuple[float, float]
) -> tuple[Matrix, Matrix, Flags]:
    """Return means and errors for bounds 0 and 1, and where there is no spread."""
    span = bounds[1] - bounds[0]
    share = np.clip((mean - bounds[0]) / span, 0.0, 1.0)
    return share, standard_error / span, (standard_error < 1e-12 * span)
