"""Intervals of a scale's values: over observers by bootstrap or sandwich, or over answers."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import stats

from analysis.bootstrap import PERCENTILES, Matrix
from analysis.estimates import CONFIDENCE
from analysis.paired.scale_fit import Model, covariance, fit_values, has_maximum, score

IntervalKind = Literal["bootstrap", "percentile", "basic", "sandwich", "fisher"]
FROM_RESAMPLES: tuple[IntervalKind, ...] = ("bootstrap", "percentile", "basic")
INTERVALS: dict[IntervalKind, str] = {
    "bootstrap": "observer bootstrap: its standard error, Student's t",
    "percentile": "observer bootstrap: percentiles",
    "basic": "observer bootstrap: percentiles reflected",
    "sandwich": "cluster-robust over observers, Student's t",
    "fisher": "Fisher information, answers taken as independent",
}
# Of 1/2, 1/4 and 1/10 the one whose intervals hold the truth 95 times in 100 also where few
# observers nearly all prefer one item: with 1/2 they are too short there, with 1/10 too long.
_ADDED_WHERE_UNBOUNDED = 0.25
_NO_SPREAD = 1e-8


@dataclass(frozen=True)
class Resamples:
    """A scale fitted again to observers drawn with replacement.

    Attributes
    ----------
    estimates
        Shape (resamples, t), with mean zero.
    regularised
        How many resamples have no finite scale of their own: a quarter of an answer was added
        there for either item of each compared pair.
    """

    estimates: Matrix
    regularised: int


def resample_observers(
    counts: Matrix, pseudo: Matrix, model: Model, generator: np.random.Generator, resamples: int
) -> Resamples:
    """Fit a scale to observers drawn with replacement.

    Parameters
    ----------
    counts
        Win counts by observer, shape (n, t, t).
    pseudo
        Win counts added to each resample, shape (t, t).
    model
        One of `MODELS`.
    generator, resamples
        Draws the observers, so many times.
    """
    observers, items = counts.shape[:2]
    chosen = generator.multinomial(
        observers, np.full(observers, 1 / observers), size=resamples
    ).astype(float)
    pooled = (chosen @ counts.reshape(observers, -1)).reshape(-1, items, items) + pseudo
    unbounded = ~has_maximum(pooled)
    total = counts.sum(axis=0)
    pooled[unbounded] += _ADDED_WHERE_UNBOUNDED * (total + total.T > 0)
    return Resamples(fit_values(pooled, model), int(unbounded.sum()))


def interval_of_contrasts(
    kind: IntervalKind,
    contrasts: Matrix,
    values: Matrix,
    spread: Matrix,
    observers: int,
) -> tuple[Matrix, Matrix]:
    """Return the 95 % intervals of contrasts of values; NaN where observers show no spread.

    Parameters
    ----------
    kind
        Which; `spread` must be what it needs.
    contrasts
        Shape (k, t); rows sum to zero.
    values
        The estimates, shape (t,).
    spread
        The resampled values (m, t) where the kind is one of `FROM_RESAMPLES`, else the values'
        covariance (t, t).
    observers
        How many.

    Notes
    -----
    Efron and Tibshirani 1993, ch. 12 and 13. `benchmarks/paired.py` counts how often each kind
    holds the truth: `bootstrap` and `sandwich` 93 to 99 times in 100 from 8 observers on,
    `percentile` and `basic` less often with few observers, and `fisher` with any number of
    observers who differ.
    """
    estimate = contrasts @ values
    if kind in FROM_RESAMPLES:
        drawn = spread @ contrasts.T
        low, high = np.percentile(drawn, PERCENTILES, axis=0)
        if kind == "percentile":
            return low, high
        if kind == "basic":
            return 2 * estimate - high, 2 * estimate - low
        error = drawn.std(axis=0, ddof=1)
    else:
        variance = np.einsum("ki,ij,kj->k", contrasts, spread, contrasts)
        error = np.sqrt(np.maximum(variance, 0))
    error[(error < _NO_SPREAD) & contrasts.any(axis=1)] = np.nan
    upper = (1 + CONFIDENCE) / 2
    reach = error * (
        stats.norm.ppf(upper) if kind == "fisher" else stats.t.ppf(upper, observers - 1)
    )
    return estimate - reach, estimate + reach


def sandwich(counts: Matrix, pseudo: Matrix, values: Matrix, model: Model) -> Matrix:
    """Return the cluster-robust covariance of values, observers as clusters, shape (t, t).

    Liang and Zeger 1986, eq. 6, times n / (n - 1) for n observers.
    """
    observers = len(counts)
    bread = covariance(counts.sum(axis=0) + pseudo, values, model)
    scores = score(counts, values, model)
    scores -= scores.mean(axis=0)
    return np.asarray(bread @ (scores.T @ scores) @ bread * observers / (observers - 1))
