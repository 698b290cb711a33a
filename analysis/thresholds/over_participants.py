"""The interval of a threshold over participants, who differ alike at all levels."""

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats
from scipy.special import ndtr

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import CONFIDENCE, Estimate
from analysis.thresholds.bayesian_fit import ThresholdFit
from analysis.thresholds.sigmoid import WIDTH_IN_SIGMAS, distance_to

_LARGEST_CONDITION = 1e12


def participant_interval(
    fit: ThresholdFit, correct: ArrayLike, total: ArrayLike, share: float | None = None
) -> Estimate:
    """Return a fit's threshold with a 95 % interval that allows for differing participants.

    Parameters
    ----------
    fit
        The function fitted to the sums over participants.
    correct, total
        Right answers and all answers, shape (participants, levels), the levels being the fit's.
    share
        The share of right answers at the threshold, above the guess rate and below 1, or None for
        the mid-point.

    Returns
    -------
    Estimate
        NaN at both ends where there are fewer than two participants, where the threshold is not
        within the levels, or where the answers do not determine the function.

    Raises
    ------
    InputError
        If the counts are not those that were fitted, or the share is impossible.

    Notes
    -----
    Cluster-robust ("sandwich") standard error of the three free parameters (Liang and Zeger 1986,
    eq. 6) with participants as clusters, times ``m / (m - 1)`` for m participants, and the t
    distribution with m - 1 degrees of freedom. The fit's own credible interval takes answers as
    independent of who gave them and is too narrow where people differ.
    """
    correct, total = np.asarray(correct, float), np.asarray(total, float)
    sums = (tuple(correct.sum(axis=0)), tuple(total.sum(axis=0)))
    if correct.ndim != 2 or sums != (fit.correct, fit.total):
        raise InputError(
            f"correct, total: shapes {correct.shape} and {total.shape} given, (participants,"
            f" {len(fit.levels)}) with the sums that were fitted accepted"
        )
    participants = len(correct)
    threshold, direction = _threshold(fit, share)
    none = Estimate(threshold, np.nan, np.nan)
    if participants < 2 or fit.reached != "within" or not np.isfinite(threshold):
        return none
    rate, slopes = _rate_and_slopes(fit)
    weights = 1 / (rate * (1 - rate))
    scores = ((correct - total * rate) * weights) @ slopes
    scores -= scores.mean(axis=0)  # zero at the maximum of the likelihood; here nearly
    information = (slopes * (weights * total.sum(axis=0))[:, None]).T @ slopes
    if np.linalg.cond(information) > _LARGEST_CONDITION:
        return none
    bread = np.linalg.inv(information)
    covariance = bread @ (scores.T @ scores) @ bread * participants / (participants - 1)
    error = np.sqrt(direction @ covariance @ direction)
    reach = stats.t.ppf((1 + CONFIDENCE) / 2, participants - 1) * error
    return Estimate(threshold, float(threshold - reach), float(threshold + reach))


def _threshold(fit: ThresholdFit, share: float | None) -> tuple[float, Matrix]:
    """Return a threshold and its derivatives by mid-point, width and lapse rate."""
    if share is None:
        return fit.threshold.value, np.array([1.0, 0.0, 0.0])
    threshold = fit.threshold_at(share).threshold.value
    width, lapse_rate = fit.width.value, fit.lapse_rate.value
    far = float(distance_to(share, width, fit.guess_rate, lapse_rate))
    if not np.isfinite(far):
        return threshold, np.array([1.0, 0.0, 0.0])
    span = 1 - fit.guess_rate - lapse_rate
    sigma = width / WIDTH_IN_SIGMAS
    by_share = sigma / stats.norm.pdf(far / sigma)  # of the sigmoid's inverse
    return threshold, np.array([1.0, far / width, by_share * (share - fit.guess_rate) / span**2])


def _rate_and_slopes(fit: ThresholdFit) -> tuple[Matrix, Matrix]:
    """Return the rate at each level and its derivatives by threshold, width and lapse rate."""
    width, lapse_rate = fit.width.value, fit.lapse_rate.value
    scaled = (np.array(fit.levels) - fit.threshold.value) * WIDTH_IN_SIGMAS / width
    span = 1 - fit.guess_rate - lapse_rate
    density = span * stats.norm.pdf(scaled)
    rate = fit.guess_rate + span * ndtr(scaled)
    slopes = np.column_stack(
        [-density * WIDTH_IN_SIGMAS / width, -density * scaled / width, -ndtr(scaled)]
    )
    return rate, slopes
