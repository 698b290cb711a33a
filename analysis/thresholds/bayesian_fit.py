"""The threshold as the mid-point of a fitted psychometric function."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import pandas as pd
import psignifit
from numpy.typing import ArrayLike, NDArray
from psignifit.sigmoids import Gaussian
from scipy.special import ndtr

from algorithms.errors import InputError
from analysis.estimates import CONFIDENCE, INSIDE, Estimate, software_version
from analysis.thresholds.counts import LevelCounts, level_counts
from analysis.thresholds.posterior import Posterior
from analysis.thresholds.priors import default_priors
from analysis.thresholds.sigmoid import (
    WIDTH_ALPHA,
    WIDTH_IN_SIGMAS,
    check_share,
    distance_to,
    rate_at,
    slope_at_threshold,
)
from analysis.thresholds.stated_threshold import StatedThreshold, place

# psignifit's default (40, 40, 20, 20) takes twice as long, for intervals whose ends move by less
# than 1 % of their length (benchmarks/recovery.py --grids).
GRID_STEPS = {"threshold": 40, "width": 30, "lambda": 15, "eta": 12}
# The grid resolves the posterior when tightening would not shrink it below this share.
TIGHT_ENOUGH = 0.6


@dataclass(frozen=True)
class ThresholdFit:
    """A psychometric function fitted to the answers at several levels.

    The function is ``guess_rate + (1 - guess_rate - lapse_rate) F(level)`` with F a cumulative
    normal whose mid-point is the threshold and whose 5 % and 95 % points lie `width` apart.

    Attributes
    ----------
    threshold, width
        In the unit of the levels, with 95 % credible intervals; an end of the threshold's interval
        beyond the levels tested is infinite, and so is a threshold that they do not bracket.
    slope
        The rise at the threshold, as a share of right answers a unit of the levels.
    lapse_rate, overdispersion
        The share of wrong answers however large the level, and the standard deviation of the
        rate at a level beyond binomial scatter (0 to 1, psignifit's eta).
    guess_rate
        The share of right answers by chance: fixed by the task.
    correct_at_threshold
        The share of right answers at the threshold.
    reached
        Whether the threshold lies `within` the levels tested, `above` or `below` them.
    levels, correct, total
        What was fitted, one entry a level.
    n
        The number of answers.
    definition, method, version
        What is meant by threshold here, how it was computed, and by which Trompe.
    posterior
        What other results are computed from; in no table.
    """

    threshold: Estimate
    width: Estimate
    slope: Estimate
    lapse_rate: Estimate
    overdispersion: Estimate
    guess_rate: float
    correct_at_threshold: float
    reached: str
    levels: tuple[float, ...]
    correct: tuple[int, ...]
    total: tuple[int, ...]
    n: int
    definition: str = "mid-point of a psychometric function"
    method: str = "psignifit, cumulative normal, beta-binomial, posterior means"
    version: str = ""
    posterior: Posterior | None = field(default=None, repr=False, compare=False, metadata=INSIDE)

    def rate(self, levels: ArrayLike) -> NDArray[np.float64]:
        """Return the fitted share of right answers at some levels.

        Where the threshold is not bracketed by the levels there is no curve: all NaN.
        """
        at = np.asarray(levels, float)
        if self.reached != "within":
            return np.full(at.shape, np.nan)
        return rate_at(
            at, self.threshold.value, self.width.value, self.guess_rate, self.lapse_rate.value
        )

    def threshold_at(self, correct: float) -> StatedThreshold:
        """Return the level at which a stated share of the answers is right.

        Parameters
        ----------
        correct
            The share, above the guess rate and below 1: 0.75 for 75 %.

        Returns
        -------
        StatedThreshold
            Where the curve of `rate` has that share, with the 95 % credible interval.

        Raises
        ------
        InputError
            If the share is impossible, or the fit has lost its posterior.
        """
        check_share(correct, self.guess_rate)
        if self.posterior is None:
            raise InputError("threshold_at: a fit as `fit_threshold` returns it accepted")
        far = distance_to(correct, self.width.value, self.guess_rate, self.lapse_rate.value)
        value, reached = place(self.threshold.value + float(far), self.levels)
        return StatedThreshold(
            Estimate(value, *self.posterior.level_of(correct).interval),
            correct,
            reached,
            self.guess_rate,
            self.n,
            self.method,
            self.version,
        )

    def to_frame(self) -> pd.DataFrame:
        """Return one row: the estimates with their intervals, and what they mean."""
        return pd.DataFrame([self.row()])

    def row(self) -> dict[str, Any]:
        """Return that row by column."""
        row: dict[str, Any] = {}
        for name, value in vars(self).items():
            if isinstance(value, Estimate):
                row |= value.columns(name)
            elif not isinstance(value, tuple | Posterior):
                row[name] = value
        return row


def fit_threshold(
    levels: ArrayLike,
    correct: ArrayLike,
    total: ArrayLike,
    guess_rate: float,
    *,
    grid_steps: Mapping[str, int] = GRID_STEPS,
) -> ThresholdFit:
    """Fit a psychometric function and return the threshold at its mid-point.

    Parameters
    ----------
    levels
        Stimulus levels, shape (n,); at least two different ones. Levels that occur more than once
        are pooled.
    correct, total
        Right answers and all answers at each level, shape (n,), whole numbers.
    guess_rate
        The share of right answers by chance, 0 to 0.5; it is fixed.
    grid_steps
        The number of grid points for each of psignifit's parameters `threshold`, `width`, `lambda`
        and `eta`, 3 or more.

    Returns
    -------
    ThresholdFit
        Estimates with 95 % credible intervals.

    Raises
    ------
    InputError
        If shapes, counts or rates are impossible.

    Notes
    -----
    Bayesian inference on a grid with a beta-binomial likelihood and psignifit's priors (Schuett,
    Harmeling, Macke and Wichmann 2016): threshold uniform over the levels with a cosine fall over
    half their range on either side, width from the smallest step to three times the range, lapse
    rate and overdispersion Beta(1, 10). Estimates are posterior means, intervals the 2.5 % and
    97.5 % points of the marginals.

    The overdispersion covers scatter of the rates about the curve. What differs between
    participants alike at all levels it does not see: `analysis.participant_interval` does.

    Examples
    --------
    >>> fit = fit_threshold([10, 20, 30, 40, 50], [5, 16, 29, 38, 39], [40] * 5, 1 / 8)
    >>> fit.reached
    'within'
    """
    counts = level_counts(levels, correct, total, guess_rate)
    if set(grid_steps) != set(GRID_STEPS) or min(grid_steps.values()) < 3:
        raise InputError(
            f"grid_steps: {dict(grid_steps)} given, 3 or more for each of {', '.join(GRID_STEPS)}"
            " accepted"
        )
    result = _fit(counts, guess_rate, grid_steps)
    estimates = {name: _estimate(result, name) for name in GRID_STEPS}
    threshold, reached = _within_levels(estimates["threshold"], counts)
    posterior = _posterior(result, counts, guess_rate)
    slope = slope_at_threshold(estimates["width"].value, guess_rate, estimates["lambda"].value)
    return ThresholdFit(
        threshold=threshold,
        width=estimates["width"],
        slope=Estimate(float(slope), *posterior.slope().interval),
        lapse_rate=estimates["lambda"],
        overdispersion=estimates["eta"],
        guess_rate=guess_rate,
        correct_at_threshold=(1 + guess_rate - estimates["lambda"].value) / 2,
        reached=reached,
        **asdict(counts),
        n=sum(counts.total),
        version=software_version(),
        posterior=posterior,
    )


class _CumulativeNormal(Gaussian):  # type: ignore[misc]  # psignifit has no types
    """psignifit's own function, evaluated three times as fast as through scipy.stats."""

    def _value(
        self,
        stimulus_level: NDArray[np.float64],
        threshold: NDArray[np.float64],
        width: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        return np.asarray(ndtr((stimulus_level - threshold) * WIDTH_IN_SIGMAS / width))


def _fit(counts: LevelCounts, guess_rate: float, grid_steps: Mapping[str, int]) -> psignifit.Result:
    """Run psignifit, again within tighter bounds until its grid resolves the posterior.

    By itself psignifit tightens the grid once, from a coarse first one. Where the posterior is
    narrower than that one's steps no grid point fits, and only overdispersed functions seem
    possible: the overdispersion 0 is dropped, and from some hundred answers a level on the
    intervals stop shrinking. So its own tightening is off (`max_bound_value`) and done here.
    """
    data = np.column_stack([counts.levels, counts.correct, counts.total]).astype(float)
    bounds = {"gamma": (guess_rate, guess_rate)}
    while True:
        # Its climb to the posterior's mode, which is not used here, leaves the range of rates.
        with np.errstate(invalid="ignore"):
            result = psignifit.psignifit(
                data,
                sigmoid=_CumulativeNormal(),
                experiment_type="yes/no",  # equal bounds fix any guess rate without warning
                bounds=bounds,
                priors=default_priors(counts.levels),
                grid_steps=dict(grid_steps),
                steps_moving_bounds=dict.fromkeys(GRID_STEPS, 3),
                max_bound_value=0.0,
                width_alpha=WIDTH_ALPHA,
                # What it would warn of (few trials, a posterior cut off) is in the intervals: they
                # are infinite where the levels set no bound.
                verbose=False,
                debug=True,  # it returns the joint posterior
            )
        tighter = {name: _relevant_range(result, name) for name in GRID_STEPS}
        if all(
            np.ptp(tighter[name]) > TIGHT_ENOUGH * np.ptp(result.parameter_values[name])
            for name in GRID_STEPS
        ):
            return result
        bounds |= tighter


def _relevant_range(result: psignifit.Result, name: str) -> tuple[float, float]:
    """Return the part of a parameter's grid within 6 standard deviations of the mean."""
    values, density = result.parameter_values[name], result.marginal_posterior_values[name]
    weights = density / density.sum()
    mean = float(weights @ values)
    reach = 6 * float(np.sqrt(weights @ (values - mean) ** 2))
    step = values[1] - values[0]
    reach = max(reach, 2 * step)
    # The overdispersion 0 is the binomial case, never to be cut off.
    low = 0.0 if name == "eta" else max(values[0], mean - reach)
    return float(low), float(min(values[-1], mean + reach))


def _estimate(result: psignifit.Result, name: str) -> Estimate:
    """Return a posterior mean with the 2.5 % and 97.5 % points of its marginal.

    The points come from the integral of the density. psignifit 4.3 interpolates the running sum
    of the masses at the grid points instead, which puts both ends half a step too low.
    """
    values, density = result.parameter_values[name], result.marginal_posterior_values[name]
    steps = np.diff(values) * (density[1:] + density[:-1]) / 2
    integral = np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum()
    low, high = np.interp([(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], integral, values)
    return Estimate(float(result.parameter_estimate_mean[name]), float(low), float(high))


def _posterior(result: psignifit.Result, counts: LevelCounts, guess_rate: float) -> Posterior:
    names = sorted(result.parameter_values)  # eta, gamma, lambda, threshold, width
    mass = np.asarray(result.debug["posteriors"]).sum(
        axis=(names.index("eta"), names.index("gamma"))
    )
    values = result.parameter_values
    return Posterior(
        values["threshold"],
        values["width"],
        values["lambda"],
        np.moveaxis(mass, 0, 2),
        guess_rate,
        counts.levels,
    )


def _within_levels(threshold: Estimate, counts: LevelCounts) -> tuple[Estimate, str]:
    """Replace by infinity what lies beyond the levels tested: there the prior speaks, not data."""
    value, reached = place(threshold.value, counts.levels)
    low, high = (place(end, counts.levels)[0] for end in (threshold.low, threshold.high))
    return Estimate(value, low, high), reached
