"""A scale from paired comparisons: Bradley-Terry or Thurstone V, in just-objectionable differences.

One just-objectionable difference (JOD) is the distance at which 75 % prefer the better item. Only
differences have a meaning; the zero is the items' mean or an item of choice.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import seed_of, software_version
from analysis.paired.pair_data import item_names, pair_counts
from analysis.paired.scale_fit import (
    MODELS,
    Model,
    ModelName,
    check_finite,
    covariance,
    differences,
    fit_values,
)
from analysis.paired.scale_intervals import (
    FROM_RESAMPLES,
    INTERVALS,
    IntervalKind,
    interval_of_contrasts,
    resample_observers,
    sandwich,
)

RESAMPLES = 500
UNIT = "JOD: at a difference of 1, 75 % prefer the better item"


@dataclass(frozen=True)
class PairScale:
    """Items on a scale.

    Attributes
    ----------
    table
        One row an item: `item`, `jod` (its value), `low`, `high` (95 % interval), `fisher_error`
        (the standard error if answers were independent).
    differences
        One row a pair of items: `item_a`, `item_b`, `jod` (how far a is above b), `low`, `high`.
        What two items differ by is read here, not from the overlap of two intervals of `table`.
    anchor
        Where the zero is: `mean`, or the item's name.
    model, method, unit
        The model, how intervals were made, and what 1 means.
    prior
        Answers added to each pair, half of them to either item.
    deviance, freedom, fit_p_value
        The likelihood-ratio test of the model against free proportions, answers independent;
        NaN where the model is not less than those.
    n, observers
        The number of answers and of observers; observers is 1 where only sums were given.
    resamples, regularised
        Of the bootstrap; and how many of them have no finite scale of their own, so that a quarter
        of an answer was added there for either item of each compared pair.
    seed, version
        Of the generator, and Trompe.
    """

    table: pd.DataFrame
    differences: pd.DataFrame
    anchor: str
    model: str
    method: str
    prior: float
    deviance: float
    freedom: int
    fit_p_value: float
    n: float
    observers: int
    resamples: int
    regularised: int
    seed: int | None
    version: str
    unit: str = UNIT

    @property
    def over_observers(self) -> bool:
        """Whether the intervals allow for observers who differ."""
        return not self.method.endswith(INTERVALS["fisher"])

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def scale_pairs(
    wins: ArrayLike,
    *,
    model: ModelName = "bradley-terry",
    items: Sequence[str] | None = None,
    anchor: str = "mean",
    prior: float = 0.0,
    interval: IntervalKind | None = None,
    generator: np.random.Generator | None = None,
    resamples: int = RESAMPLES,
) -> PairScale:
    """Return the items' values on a scale of preference, with intervals over observers.

    Parameters
    ----------
    wins
        Win counts, shape (n, t, t) by observer or (t, t) in sum, t of 2 or more: how often the
        row's item was preferred to the column's; half a win each for a tie. Pairs may be missing.
    model
        `bradley-terry` or `thurstone` (case V), by maximum likelihood.
    items
        Their names; None: 1, 2, ...
    anchor
        What has value zero: `mean`, `first`, or an item's name.
    prior
        Answers added to each pair, half of them to either item; 0 or more. Some is needed where
        an item won or lost every comparison: without it such data are refused.
    interval
        One of `analysis.paired.scale_intervals.INTERVALS`. None: `bootstrap` with a generator, else
        `sandwich`; `fisher` for one observer or sums, where nothing is known of observers.
    generator
        Draws the observers of the bootstrap.
    resamples
        How many times, 2 or more.

    Raises
    ------
    InputError
        If an argument is impossible, items fall apart into sets that were never compared, or some
        items beat others every time so that no finite scale exists.

    Notes
    -----
    Bradley and Terry 1952, Biometrika 39; Thurstone 1927, Psychological Review 34; the unit as by
    Perez-Ortiz and Mantiuk 2017, arXiv:1712.03686. Observers are drawn whole, since their answers
    are not independent.

    Examples
    --------
    >>> scale_pairs([[0, 75], [25, 0]], anchor="first").table["jod"].round(3).tolist()
    [0.0, -1.0]
    """
    counts = pair_counts(wins)
    names = item_names(items, counts.shape[-1])
    zero = _anchor(anchor, names)
    kind = _interval(interval, len(counts), generator)
    check_settings(model, prior, resamples)
    pseudo = prior / 2 * (1 - np.eye(len(names)))
    pooled = counts.sum(axis=0) + pseudo
    check_finite(pooled, names)
    fit = _Fit(counts, pseudo, fit_values(pooled[None], MODELS[model])[0], MODELS[model])
    spread, regularised = _spread(kind, fit, generator, resamples)
    table, gaps = _tables(fit, kind, spread, names, zero)
    deviance, freedom = _deviance(fit)
    return PairScale(
        table=table,
        differences=gaps,
        anchor="mean" if zero is None else names[zero],
        model=fit.model.title,
        method=f"maximum likelihood{_prior_text(prior)}; {INTERVALS[kind]}",
        prior=prior,
        deviance=deviance,
        freedom=freedom,
        fit_p_value=float(stats.chi2.sf(deviance, freedom)) if freedom else math.nan,
        n=float(counts.sum()),
        observers=len(counts),
        resamples=resamples if kind in FROM_RESAMPLES else 0,
        regularised=regularised,
        seed=seed_of(generator) if generator is not None and kind in FROM_RESAMPLES else None,
        version=software_version(),
    )


@dataclass(frozen=True)
class _Fit:
    """Win counts (n, t, t), those added to their sum (t, t), and the values fitted (t,)."""

    counts: Matrix
    pseudo: Matrix
    estimates: Matrix
    model: Model

    @property
    def covariance(self) -> Matrix:
        """The inverse Fisher information, shape (t, t)."""
        return covariance(self.counts.sum(axis=0) + self.pseudo, self.estimates, self.model)


def _tables(
    fit: _Fit, kind: IntervalKind, spread: Matrix, names: tuple[str, ...], zero: int | None
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the tables of items and of pairs, in JOD."""

    def in_jod(contrasts: Matrix) -> dict[str, Matrix]:
        low, high = interval_of_contrasts(kind, contrasts, fit.estimates, spread, len(fit.counts))
        columns = {"jod": contrasts @ fit.estimates, "low": low, "high": high}
        return {name: column / fit.model.unit for name, column in columns.items()}

    every = np.eye(len(names))
    own = every - (every.mean(axis=0) if zero is None else every[zero])
    variance = np.einsum("ki,ij,kj->k", own, fit.covariance, own)
    table = pd.DataFrame({"item": names} | in_jod(own))
    table["fisher_error"] = np.sqrt(np.maximum(variance, 0)) / fit.model.unit
    first, second = np.triu_indices(len(names), k=1)
    pair = {"item_a": [names[k] for k in first], "item_b": [names[k] for k in second]}
    return table, pd.DataFrame(pair | in_jod(every[first] - every[second]))


def check_settings(model: str, prior: float, resamples: int = RESAMPLES) -> None:
    """Refuse an unknown model, a negative prior, and fewer than two resamples."""
    if model not in MODELS:
        raise InputError(f"model: {model!r} given, one of {', '.join(MODELS)} accepted")
    if not 0 <= prior < math.inf:
        raise InputError(f"prior: {prior} given, 0 or more accepted")
    if resamples < 2:
        raise InputError(f"resamples: {resamples} given, 2 or more accepted")


def _anchor(anchor: str, names: tuple[str, ...]) -> int | None:
    if anchor in names:
        return names.index(anchor)
    if anchor not in ("mean", "first"):
        raise InputError(f"anchor: {anchor!r} given, mean, first or one of {list(names)} accepted")
    return None if anchor == "mean" else 0


def _interval(
    kind: IntervalKind | None, observers: int, generator: np.random.Generator | None
) -> IntervalKind:
    if kind is None:
        if observers < 2:
            return "fisher"
        return "sandwich" if generator is None else "bootstrap"
    if kind not in get_args(IntervalKind):
        raise InputError(f"interval: {kind!r} given, one of {', '.join(INTERVALS)} accepted")
    if kind != "fisher" and observers < 2:
        raise InputError(
            f"interval: {kind!r} needs the wins of two observers or more, (observers, items,"
            " items); for sums fisher accepted"
        )
    if kind in FROM_RESAMPLES and generator is None:
        raise InputError(f"generator: needed to draw observers for the interval {kind!r}")
    return kind


def _spread(
    kind: IntervalKind, fit: _Fit, generator: np.random.Generator | None, resamples: int
) -> tuple[Matrix, int]:
    """Return what an interval is made of, and how many resamples were regularised."""
    if kind in FROM_RESAMPLES and generator is not None:
        drawn = resample_observers(fit.counts, fit.pseudo, fit.model, generator, resamples)
        return drawn.estimates, drawn.regularised
    if kind == "sandwich":
        return sandwich(fit.counts, fit.pseudo, fit.estimates, fit.model), 0
    return fit.covariance, 0


def _deviance(fit: _Fit) -> tuple[float, int]:
    """Return twice the gain of free proportions over the model, and its degrees of freedom."""
    counts = fit.counts.sum(axis=0)
    answers = counts + counts.T
    share = np.divide(counts, answers, out=np.ones_like(counts), where=counts > 0)
    gain = counts * (np.log(share) - fit.model.log_probability(differences(fit.estimates)))
    pairs = int(np.count_nonzero(np.triu(answers)))
    return float(2 * gain.sum()), pairs - (len(counts) - 1)


def _prior_text(prior: float) -> str:
    return f" with {prior:g} answers added to each pair" if prior else ""
