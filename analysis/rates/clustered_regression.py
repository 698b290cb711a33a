"""Regression on answers that come in clusters, one cluster a participant.

A generalised estimating equation with independence as working correlation (Liang and Zeger 1986):
the coefficients are those of a generalised linear model, and their covariance is robust to any
dependence among the answers of a participant. With few participants the plain robust covariance
is too small; here it is the bias-reduced one of Bell and McCaffrey (2002), and tests refer to t
and F with the degrees of freedom that the design leaves (Pustejovsky and Tipton 2018).
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.special import expit

from algorithms.errors import InputError
from analysis.estimates import CONFIDENCE, Estimate

Floats = NDArray[np.float64]
Kind = Literal["binomial", "normal"]

METHOD = (
    "generalised estimating equation, independence as working correlation, participants as"
    " clusters, bias-reduced covariance (CR2), Satterthwaite's degrees of freedom"
)
_LARGEST_COEFFICIENT = 15.0  # of columns from 0 to 1; a larger one grows without end
_LOST = 1e-3  # share of a covariance's expectation that no other participant vouches for
_MOST_STEPS = 100
_FLAT = 1e-9  # gain of the logarithm of the likelihood in the last step


_NO_VARIANCE = 1e-14


@dataclass(frozen=True)
class WaldTest:
    """A test that some combinations of coefficients are all zero.

    Attributes
    ----------
    statistic
        F.
    df, df_denominator
        Its degrees of freedom; where the latter would not be positive there is no test (NaN).
    p_value
        The probability of as large an F.
    """

    statistic: float
    df: int
    df_denominator: float
    p_value: float


@dataclass(frozen=True, eq=False)
class ClusteredRegression:
    """A fitted regression.

    Attributes
    ----------
    coefficients
        Shape (p,).
    covariance
        Bias-reduced, shape (p, p).
    clusters, n
        How many participants gave how many answers.
    whitening
        The inverse root of the information, shape (p, p).
    shares
        The share of each cluster in the whitened information, shape (clusters, p, p); they sum to
        the identity.
    adjustment
        What takes the bias out of each cluster's score, shape (clusters, p, p).
    """

    coefficients: Floats
    covariance: Floats
    clusters: int
    n: int
    whitening: Floats
    shares: Floats
    adjustment: Floats

    def estimate(self, value: float, slopes: Floats) -> tuple[Estimate, float]:
        """Return a quantity with its 95 % interval, and the interval's degrees of freedom.

        Parameters
        ----------
        value
            The quantity at the coefficients.
        slopes
            Its derivatives by the coefficients, shape (p,); for a coefficient itself a unit vector.

        Returns
        -------
        tuple
            No interval (NaN) and 0 where too few participants tell of the quantity.
        """
        variance = float(slopes @ self.covariance @ slopes)
        # With as few participants as coefficients the covariance may say nothing of a quantity.
        error = math.sqrt(variance) if variance > _NO_VARIANCE else math.nan
        df = self._degrees_of_freedom(slopes[None])
        reach = float(stats.t.ppf((1 + CONFIDENCE) / 2, df)) * error
        return Estimate(value, value - reach, value + reach), df

    def test(self, combinations: Floats) -> WaldTest:
        """Test that combinations of the coefficients, shape (q, p), are all zero.

        Notes
        -----
        The approximate Hotelling test of Pustejovsky and Tipton 2018, sec. 3.2.
        """
        q = len(combinations)
        found = combinations @ self.coefficients
        spread = combinations @ self.covariance @ combinations.T
        df = self._degrees_of_freedom(combinations) - q + 1
        if df <= 0:
            return WaldTest(float("nan"), q, df, float("nan"))
        squared = float(found @ np.linalg.solve(spread, found))
        statistic = squared * df / (q * (df + q - 1))
        return WaldTest(statistic, q, df, float(stats.f.sf(statistic, q, df)))

    def _degrees_of_freedom(self, combinations: Floats) -> float:
        """Return those of the covariance of combinations, were answers independent.

        Pustejovsky and Tipton 2018, eq. 16: q (q + 1) over the summed variances of the entries of
        the covariance, standardised to the identity. For one combination they are Satterthwaite's.
        """
        whitened = self.whitening @ combinations.T
        root = np.linalg.cholesky(whitened.T @ whitened)
        standard = np.linalg.solve(root, whitened.T).T  # (p, q)
        weights = self.adjustment @ standard  # (clusters, p, q)
        own = self.shares @ weights
        # The covariance of clusters i and k for combinations s and t is own[i, :, s] . weights[i,
        # :, t] where i = k, less own[i, :, s] . own[k, :, t] because the fit took part of it.
        alone = np.einsum("ips,ipt->ist", weights, own)
        fitted = np.einsum("ips,ipt->ist", own, own)
        expected = alone.sum(axis=0) - fitted.sum(axis=0)
        if not np.allclose(expected, np.eye(len(expected)), atol=_LOST):
            return 0.0  # some participants alone determine the combinations: no spread is left
        joint = np.einsum("ips,irt->prst", own, own, optimize=True)
        spread = np.einsum("iss,itt->", alone, alone) - 2 * np.einsum("iss,itt->", alone, fitted)
        spread += np.einsum("ist,ist->", alone, alone) - 2 * np.einsum("ist,ist->", alone, fitted)
        spread += np.sum(joint**2) + np.einsum("prst,rpst->", joint, joint)
        q = len(combinations)
        return float(q * (q + 1) / spread)


def clustered_regression(
    design: Floats, response: Floats, cluster: NDArray[np.intp], kind: Kind
) -> ClusteredRegression:
    """Fit a logistic or a linear regression to clustered answers.

    Parameters
    ----------
    design
        Shape (n, p), of full rank.
    response
        0 or 1 for `binomial`, any number for `normal`; shape (n,).
    cluster
        The number of each answer's participant, 0 to m - 1, shape (n,); m is 2 or more.
    kind
        What is regressed: the logarithm of the odds, or the response itself.

    Raises
    ------
    InputError
        If the answers determine no coefficients because a combination of columns separates them.
    """
    coefficients, mean = _coefficients(design, response, kind)
    weights = mean * (1 - mean) if kind == "binomial" else np.ones_like(mean)
    clusters = int(cluster.max()) + 1
    information, scores = _cluster_sums(design, weights, response - mean, cluster, clusters)
    size, axes = np.linalg.eigh(information.sum(axis=0))
    whitening = (axes / np.sqrt(size)) @ axes.T
    shares = whitening @ information @ whitening
    share, directions = np.linalg.eigh(shares)
    left = 1 - share  # nothing is left where one cluster alone determines a direction
    root = np.where(left > 1e-9, left, np.inf) ** -0.5
    adjustment = (directions * root[:, None, :]) @ directions.transpose(0, 2, 1)
    adjusted = np.einsum("iab,ib->ia", adjustment, scores @ whitening) @ whitening
    return ClusteredRegression(
        coefficients=coefficients,
        covariance=adjusted.T @ adjusted,
        clusters=clusters,
        n=len(response),
        whitening=whitening,
        shares=shares,
        adjustment=adjustment,
    )


def _coefficients(design: Floats, response: Floats, kind: Kind) -> tuple[Floats, Floats]:
    if kind == "normal":
        found = np.asarray(np.linalg.solve(design.T @ design, design.T @ response))
        return found, np.asarray(design @ found)
    # Newton's steps. statsmodels finds the same, with an SVD of all rows a step: twenty times as
    # long for 100,000 answers.
    found, height = np.zeros(design.shape[1]), -np.inf
    step = np.zeros_like(found)
    for _ in range(_MOST_STEPS):
        odds = design @ (found + step)
        reached = float(response @ odds - np.logaddexp(0, odds).sum())
        if reached < height:
            step = step / 2
            continue
        found, gain, height = found + step, reached - height, reached
        mean = expit(odds)
        if gain < _FLAT or np.abs(found).max() > _LARGEST_COEFFICIENT:
            break
        information = (design * (mean * (1 - mean))[:, None]).T @ design
        step = np.asarray(np.linalg.solve(information, design.T @ (response - mean)))
    if np.abs(found).max() > _LARGEST_COEFFICIENT:
        raise InputError("factors: they separate right from wrong answers, so that no odds exist")
    return found, mean


def _cluster_sums(
    design: Floats, weights: Floats, residuals: Floats, cluster: NDArray[np.intp], clusters: int
) -> tuple[Floats, Floats]:
    """Return each cluster's information, shape (clusters, p, p), and score, (clusters, p)."""
    columns = design.shape[1]
    information = np.empty((clusters, columns, columns))
    scores = np.empty((clusters, columns))
    for a in range(columns):
        scores[:, a] = np.bincount(cluster, design[:, a] * residuals, clusters)
        weighted = design[:, a] * weights
        for b in range(a + 1):
            sums = np.bincount(cluster, weighted * design[:, b], clusters)
            information[:, a, b] = information[:, b, a] = sums
    return information, scores
