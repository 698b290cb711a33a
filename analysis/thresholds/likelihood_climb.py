"""The climb to the maximum of many psychometric functions' likelihoods, all at once.

Parameters have shape (n, 3): threshold, logarithm of the width, lapse rate, with the levels
scaled to 0 to 1. One row is one data set; no loop runs over rows.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, xlog1py, xlogy

from analysis.thresholds.sigmoid import WIDTH_IN_SIGMAS, Floats

Chosen = NDArray[np.intp]

LARGEST_LAPSE_RATE = 0.5
LAPSE_POWER = 9  # of 1 - lapse rate: the density of Beta(1, 10), as in psignifit

_MOST_STEPS = 100
_FLAT = 1e-10  # what the slopes may still promise of the height
_TINY = 1e-12  # information where there is none
_ROUNDING = 1e-13  # of the height
_SMALLEST_DAMPING, _FIRST_DAMPING, _LARGEST_DAMPING = 1e-7, 1e-3, 1e8

_START_THRESHOLDS = np.linspace(-0.4, 1.4, 19)
_START_WIDTHS = np.geomspace(0.1, 2.5, 8)
_START_LAPSE_RATES = (0.005, 0.05, 0.15, 0.4)


@dataclass(frozen=True, eq=False)
class Problem:
    """Right answers and all answers, shape (n, l), at levels from 0 to 1, shape (l,)."""

    levels: Floats
    correct: Floats
    total: Floats
    guess_rate: float

    def part(self, chosen: Chosen) -> "Problem":
        """Return some of the data sets."""
        return Problem(self.levels, self.correct[chosen], self.total[chosen], self.guess_rate)

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """The least and the greatest value of each parameter."""
        narrowest = float(np.log(np.diff(self.levels).min()))
        return (
            np.array([-0.5, narrowest, 0.0]),
            np.array([1.5, np.log(3.0), LARGEST_LAPSE_RATE]),
        )

    def rate(self, parameters: Floats) -> tuple[Floats, Floats]:
        """Return the share of right answers, (n, l), and its derivatives, (n, 3, l)."""
        threshold, log_width, lapse_rate = (parameters[:, [k]] for k in range(3))
        per_level = WIDTH_IN_SIGMAS * np.exp(-log_width)
        scaled = (self.levels - threshold) * per_level
        span = 1 - self.guess_rate - lapse_rate
        normal = ndtr(scaled)
        density = span * np.exp(-(scaled**2) / 2) / np.sqrt(2 * np.pi)
        slopes = np.stack([-density * per_level, -density * scaled, -normal], axis=1)
        # A guess or lapse rate of 0 gives rates of 0 or 1: their logarithms stay finite.
        return np.clip(self.guess_rate + span * normal, 1e-12, 1 - 1e-12), slopes

    def evaluate(self, parameters: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the height, its slope and the expected information.

        The height is the logarithm of the likelihood times ``(1 - lapse rate) ** 9``.
        """
        rate, slopes = self.rate(parameters)
        variance, kept = rate * (1 - rate), 1 - parameters[:, 2]
        height = np.sum(xlogy(self.correct, rate) + xlog1py(self.total - self.correct, -rate), 1)
        residual = (self.correct - self.total * rate) / variance
        slope = (slopes @ residual[:, :, None])[:, :, 0]
        weighted = slopes * (self.total / variance)[:, None, :]
        information = weighted @ slopes.transpose(0, 2, 1)
        slope[:, 2] -= LAPSE_POWER / kept
        information[:, 2, 2] += LAPSE_POWER / kept**2
        return height + LAPSE_POWER * np.log(kept), slope, information

    def starts(self, bands: int) -> list[Floats]:
        """Return the best point of a coarse grid in each of some bands of widths, narrow first."""
        rows = np.log(_START_WIDTHS)
        found = []
        for widths in np.array_split(rows, bands):
            axes = np.meshgrid(_START_THRESHOLDS, widths, _START_LAPSE_RATES, indexing="ij")
            grid = np.column_stack([axis.ravel() for axis in axes])
            rate, _ = self.rate(grid)
            heights = self.correct @ np.log(rate).T
            heights += (self.total - self.correct) @ np.log1p(-rate).T
            best = np.argmax(heights + LAPSE_POWER * np.log1p(-grid[:, 2]), axis=1)
            found.append(np.clip(grid[best], *self.bounds))
        return found


@dataclass(eq=False)
class Climb:
    """Where each data set's climb has come to; `run` moves it to the nearest maximum."""

    problem: Problem
    parameters: Floats

    def __post_init__(self) -> None:
        self.height, self.slope, self.information = self.problem.evaluate(self.parameters)
        self.damping = np.full(len(self.parameters), _FIRST_DAMPING)

    def run(self) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Return parameters, heights, and whether a maximum was reached.

        Steps are those of Levenberg and Marquardt with the expected information; a parameter at
        its bound is held there while the slope points outwards.
        """
        for _ in range(_MOST_STEPS):
            slope = np.where(self._held(), 0.0, self.slope)
            diagonal = np.einsum("nii->ni", self.information)
            converged = np.sum(slope**2 / (diagonal + _TINY), axis=1) < _FLAT
            climbing = np.flatnonzero(~converged & (self.damping < _LARGEST_DAMPING))
            if not climbing.size:
                break
            self._move(climbing, slope[climbing])
        return self.parameters, self.height, converged

    def _held(self) -> NDArray[np.bool_]:
        low, high = self.problem.bounds
        at_low = (self.parameters <= low) & (self.slope < 0)
        return np.asarray(at_low | (self.parameters >= high) & (self.slope > 0))

    def _move(self, rows: Chosen, slope: Floats) -> None:
        """Take a step where it leads up, and damp the next one by how it kept its promise."""
        here, information = self.parameters[rows], self.information[rows]
        step = _damped_step(slope, information, self._held()[rows], self.damping[rows])
        there = np.clip(here + step, *self.problem.bounds)
        step = there - here
        curve = np.einsum("nij,nj->ni", information, step)
        promised = np.einsum("ni,ni->n", step, slope - curve / 2)
        height, new_slope, new_information = self.problem.part(rows).evaluate(there)
        gain = height - self.height[rows]
        up = gain >= -_ROUNDING * np.abs(height)
        taken = rows[up]
        self.parameters[taken], self.height[taken] = there[up], height[up]
        self.slope[taken], self.information[taken] = new_slope[up], new_information[up]
        kept = [~up, gain < promised / 4, gain < 0.75 * promised]
        damping = self.damping[rows] * np.select(kept, [8.0, 4.0, 1.0], 0.1)
        self.damping[rows] = np.maximum(damping, _SMALLEST_DAMPING)


def _damped_step(
    slope: Floats, information: Floats, held: NDArray[np.bool_], damping: Floats
) -> Floats:
    free = ~held
    matrix = information * (free[:, :, None] & free[:, None, :])
    diagonal = np.einsum("nii->ni", matrix)  # a view
    diagonal *= 1 + damping[:, None]
    diagonal += held + _TINY
    return np.asarray(np.linalg.solve(matrix, slope[:, :, None])[:, :, 0])
