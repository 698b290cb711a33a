"""What psignifit's fit knows besides its estimates: the joint posterior of the function."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analysis.estimates import CONFIDENCE
from analysis.thresholds.sigmoid import Floats, distance_to, slope_at_threshold

_POINTS = 1000  # at which a distribution is tabulated


@dataclass(frozen=True, eq=False)
class Distribution:
    """The distribution of one number, by its cumulative probabilities.

    Attributes
    ----------
    values
        Rising, shape (n,).
    cumulative
        The probability of at most each value, shape (n,), linear in between. What it begins above
        0 by is the probability of minus infinity, what it ends below 1 by that of infinity.
    """

    values: Floats
    cumulative: Floats

    @property
    def interval(self) -> tuple[float, float]:
        """The ends of the central 95 %."""
        low, high = self.quantile((1 - CONFIDENCE) / 2), self.quantile((1 + CONFIDENCE) / 2)
        return low, high

    def quantile(self, probability: float) -> float:
        """Return the value that is not exceeded with a probability."""
        return float(np.interp(probability, self.cumulative, self.values, -np.inf, np.inf))

    def below(self, value: float) -> float:
        """Return the probability of at most a finite value."""
        return float(np.interp(value, self.values, self.cumulative))

    def minus(self, other: "Distribution") -> "Distribution":
        """Return the distribution of the difference to an independent number.

        If both are infinite in the same direction nothing is known of the difference: half of
        that probability goes to either end.
        """
        places = (other.values[1:] + other.values[:-1]) / 2
        masses = np.diff(other.cumulative)
        low, high = self.values[0] - other.values[-1], self.values[-1] - other.values[0]
        values = np.linspace(low, high, _POINTS)
        least, most = self.cumulative[0], self.cumulative[-1]
        other_low, other_high = other.cumulative[0], 1 - other.cumulative[-1]
        unknown = least * other_low + (1 - most) * other_high
        # Minus infinity: the first is, or the second is infinite, and not both in one direction.
        lost = least * (1 - other_low) + (most - least) * other_high + unknown / 2
        shares = np.interp(values[:, None] + places, self.values, self.cumulative - least)
        return Distribution(values, lost + shares @ masses)


@dataclass(frozen=True, eq=False)
class Posterior:
    """The posterior of threshold, width and lapse rate on psignifit's grid.

    Attributes
    ----------
    thresholds, widths, lapse_rates
        The grid's values, shapes (t,), (w,) and (l,).
    mass
        The probability of each grid point, shape (t, w, l), summing to 1; the overdispersion is
        integrated out.
    guess_rate
        Fixed by the task.
    levels
        Those tested.
    """

    thresholds: Floats
    widths: Floats
    lapse_rates: Floats
    mass: Floats
    guess_rate: float
    levels: Sequence[float]

    def level_of(self, correct: float | None = None) -> Distribution:
        """Return the distribution of the level at which a share of the answers is right.

        Parameters
        ----------
        correct
            The share, or None for the mid-point.

        Returns
        -------
        Distribution
            Infinite beyond the levels tested, and where the share is never reached.
        """
        if correct is None:
            masses = self.mass.sum(axis=(1, 2))[:, None]
            shifts = np.zeros(1)
        else:  # each width and lapse rate shifts the threshold by a constant
            far = distance_to(correct, self.widths[:, None], self.guess_rate, self.lapse_rates)
            reached = np.isfinite(far)
            shifts, masses = far[reached], self.mass[:, reached]
        values = np.linspace(min(self.levels), max(self.levels), _POINTS)
        total = np.zeros(_POINTS)
        for shift, cumulative in zip(shifts, _running_integral(masses).T, strict=True):
            total += np.interp(values - shift, self.thresholds, cumulative)
        return Distribution(values, total)

    def slope(self) -> Distribution:
        """Return the distribution of the slope at the mid-point."""
        slopes = slope_at_threshold(self.widths[:, None], self.guess_rate, self.lapse_rates)
        order = np.argsort(slopes, axis=None)
        masses = self.mass.sum(axis=0).ravel()[order]
        return Distribution(slopes.ravel()[order], np.cumsum(masses) - masses / 2)


def _running_integral(masses: Floats) -> Floats:
    """Return the running integral of densities along the first axis, from their grid masses.

    The masses at both ends stand for half a step, so the density there is twice the mass a step.
    """
    density = masses.copy()
    density[[0, -1]] *= 2
    steps = (density[1:] + density[:-1]) / 2
    return np.vstack([np.zeros(masses.shape[1]), np.cumsum(steps, axis=0)])
