"""Psychometric functions by penalised maximum likelihood, many at once.

psignifit takes a tenth of a second a fit: too slow to resample observers thousands of times.
Here the fits climb together, as arrays (`analysis.likelihood_climb`).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analysis.thresholds.counts import count_rows
from analysis.thresholds.likelihood_climb import Climb, Problem
from analysis.thresholds.sigmoid import Floats, distance_to, slope_at_threshold, within_levels

METHOD = "penalised maximum likelihood, cumulative normal, lapse rate penalised as by Beta(1, 10)"

# Widths, from narrow to wide, from which the climb begins: there can be two maxima, such as a steep
# and a flat function, or a high lapse rate and a threshold far up.
_STARTS = 3
_FITS_AT_ONCE = 2_000  # keeps the arrays of a climb in the cache


@dataclass(frozen=True, eq=False)
class LikelihoodFits:
    """Psychometric functions fitted to many data sets at the same levels.

    Attributes
    ----------
    threshold
        Mid-points, shape (n,); infinite where they lie beyond the levels.
    width
        From the 5 % to the 95 % point, shape (n,).
    lapse_rate
        Shape (n,), 0 to 0.5.
    log_likelihood
        With its penalty, up to a constant of the data, shape (n,).
    converged
        Whether the climb ended at a maximum, shape (n,).
    guess_rate
        Fixed by the task.
    levels
        Shape (l,).
    method
        How the functions were fitted.
    """

    threshold: Floats
    width: Floats
    lapse_rate: Floats
    log_likelihood: Floats
    converged: NDArray[np.bool_]
    guess_rate: float
    levels: Floats
    method: str = METHOD

    @property
    def slope(self) -> Floats:
        """The rise of the function at its mid-point, in right answers a unit, shape (n,)."""
        return slope_at_threshold(self.width, self.guess_rate, self.lapse_rate)

    def thresholds_at(self, correct: float | None = None) -> Floats:
        """Return the levels at which a share of the answers is right, shape (n,).

        Parameters
        ----------
        correct
            Above the guess rate and below 1, or None for the mid-points.

        Returns
        -------
        numpy.ndarray
            Infinite where the level lies beyond those tested or the share is never reached.
        """
        if correct is None:
            return self.threshold
        far = distance_to(correct, self.width, self.guess_rate, self.lapse_rate)
        return within_levels(self.threshold + far, self.levels)


def maximum_likelihood(
    levels: ArrayLike, correct: ArrayLike, total: ArrayLike, guess_rate: float
) -> LikelihoodFits:
    """Fit a psychometric function to each of many data sets.

    Parameters
    ----------
    levels
        Different levels in rising order, shape (l,), two or more.
    correct, total
        Right answers and all answers, shape (n, l), whole numbers; 0 answers are allowed.
    guess_rate
        The share of right answers by chance, 0 to 0.5; it is fixed.

    Raises
    ------
    InputError
        If shapes, counts or rates are impossible.

    Notes
    -----
    The function is that of `analysis.fit_threshold` without overdispersion:
    ``g + (1 - g - lapse) F(level)`` with F a cumulative normal. The likelihood is multiplied by
    ``(1 - lapse) ** 9``, psignifit's prior of the lapse rate, which is bounded by 0 and 0.5; the
    threshold may lie half the range beyond the levels, the width between the smallest step and
    three times the range.
    """
    at, right, answers = count_rows(levels, correct, total, guess_rate)
    lowest, span = at[0], at[-1] - at[0]
    scaled = (at - lowest) / span
    parts = [
        _highest(Problem(scaled, right[some], answers[some], guess_rate))
        for some in np.array_split(np.arange(len(right)), len(right) // _FITS_AT_ONCE + 1)
    ]
    parameters, heights, converged = (np.concatenate(part) for part in zip(*parts, strict=True))
    return LikelihoodFits(
        threshold=within_levels(lowest + span * parameters[:, 0], at),
        width=span * np.exp(parameters[:, 1]),
        lapse_rate=parameters[:, 2],
        log_likelihood=heights,
        converged=converged,
        guess_rate=guess_rate,
        levels=at,
    )


def _highest(problem: Problem) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Climb from each start and keep the highest maximum."""
    ends = [Climb(problem, start).run() for start in problem.starts(_STARTS)]
    parameters, heights, converged = (np.stack(some) for some in zip(*ends, strict=True))
    best, rows = np.argmax(heights, axis=0), np.arange(heights.shape[1])
    return parameters[best, rows], heights[best, rows], converged[best, rows]
