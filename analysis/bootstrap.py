"""Intervals by resampling participants: they, not their answers, are the sample of a study."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import stats

from algorithms.errors import InputError
from analysis.estimates import CONFIDENCE

RESAMPLES = 2000
PERCENTILES = (50 * (1 - CONFIDENCE), 50 * (1 + CONFIDENCE))

OVER_PARTICIPANTS = "bootstrap over participants"
EXACT = "Clopper-Pearson"
EXACT_OVER_PARTICIPANTS = "Clopper-Pearson over participants"

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class Sums:
    """Sums and counts of a quantity for each participant and cell of a design.

    Attributes
    ----------
    cells
        One row a cell: the factor levels that make it.
    totals, counts
        Shape (participants, cells): the sum of the quantity and how many answers went into it.
    """

    cells: pd.DataFrame
    totals: Matrix
    counts: Matrix

    @property
    def means(self) -> NDArray[np.float64]:
        """The mean over all answers of each cell, shape (cells,)."""
        return np.asarray(self.totals.sum(axis=0) / self.counts.sum(axis=0), dtype=float)


def sum_by_participant(table: pd.DataFrame, quantity: str, by: Sequence[str]) -> Sums:
    """Sum a column over the answers of each participant in each cell.

    Parameters
    ----------
    table
        One row an answer, with `participant`, `quantity` and the columns `by`; rows where the
        quantity is missing are left out.
    quantity
        A numeric or boolean column.
    by
        The columns that make the cells; only cells with an answer are kept.
    """
    valid = table[table[quantity].notna()]
    valid = valid.assign(**{quantity: valid[quantity].astype(float)})

    def aggregate(how: Literal["sum", "count"]) -> pd.DataFrame:
        return valid.pivot_table(
            values=quantity,
            index=list(by),
            columns="participant",
            aggfunc=how,
            fill_value=0,
            observed=True,
        )

    totals, counts = aggregate("sum"), aggregate("count")
    return Sums(
        totals.index.to_frame(index=False),
        totals.to_numpy(float).T,
        counts.to_numpy(float).T,
    )


def bootstrap_means(
    totals: Matrix, counts: Matrix, generator: np.random.Generator, resamples: int = RESAMPLES
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return 95 % percentile intervals of the means by resampling participants.

    Parameters
    ----------
    totals, counts
        Shape (participants, cells), as in `Sums`.
    generator
        Draws the participants.
    resamples
        How many times; 1 or more.

    Returns
    -------
    low, high : numpy.ndarray
        Shape (cells,). NaN for fewer than two participants, where nothing can be resampled.

    Notes
    -----
    Expanded percentile bootstrap (`expanded_percentiles`) of a ratio of sums, participants drawn
    with replacement; a resample without any answer in a cell says nothing about it.
    """
    if totals.shape != counts.shape or totals.ndim != 2:
        raise InputError(
            f"totals, counts: shapes {totals.shape} and {counts.shape} given,"
            " one shape (participants, cells) accepted"
        )
    participants, cells = totals.shape
    chosen = resample(participants, generator, resamples)
    if participants < 2:
        return np.full(cells, np.nan), np.full(cells, np.nan)
    drawn = chosen @ counts
    means = np.divide(chosen @ totals, drawn, out=np.full(drawn.shape, np.nan), where=drawn > 0)
    low, high = np.nanpercentile(means, expanded_percentiles(participants), axis=0)
    return low, high


def resample(participants: int, generator: np.random.Generator, resamples: int) -> Matrix:
    """Draw participants with replacement and return how often each was drawn.

    Parameters
    ----------
    participants
        How many there are, and how many a resample has; 1 or more.
    generator
        Draws them.
    resamples
        How many times, 1 or more.

    Returns
    -------
    numpy.ndarray
        Shape (resamples, participants): times a row of sums gives those of a resample.
    """
    if resamples < 1:
        raise InputError(f"resamples: {resamples} given, 1 or more accepted")
    even = np.full(participants, 1 / participants)
    return generator.multinomial(participants, even, size=resamples).astype(float)


def expanded_percentiles(participants: float) -> tuple[float, float]:
    """Return the percentiles of resamples between which a 95 % interval lies.

    Parameters
    ----------
    participants
        How many were resampled, more than one; the degrees of freedom plus one where groups were.

    Notes
    -----
    Resamples scatter too little, by ``sqrt((m - 1) / m)`` for m participants, and have the tails
    of the normal where those of t with m - 1 degrees of freedom are due. Both are made up for by
    reaching farther out than to the 2.5 % and 97.5 % points (Hesterberg 2015, The American
    Statistician 69(4), "expanded percentile interval").

    >>> [round(end, 2) for end in expanded_percentiles(10)]
    [0.86, 99.14]
    """
    reach = stats.t.ppf((1 + CONFIDENCE) / 2, participants - 1)
    tail = stats.norm.sf(reach * np.sqrt(participants / (participants - 1)))
    return float(100 * tail), float(100 * (1 - tail))


def expanded_p_value(beyond: float, participants: float) -> float:
    """Return the two-sided p-value that agrees with an expanded percentile interval.

    Parameters
    ----------
    beyond
        The share of resamples at or beyond the value that is tested, above 0.
    participants
        How many were resampled, more than one; the degrees of freedom plus one where groups were.

    Returns
    -------
    float
        One minus the confidence at which the interval just reaches that value; at most 1.
    """
    reach = stats.norm.isf(min(beyond, 0.5)) * np.sqrt((participants - 1) / participants)
    return float(2 * stats.t.sf(reach, participants - 1))


def rate_intervals(
    sums: Sums, generator: np.random.Generator, resamples: int = RESAMPLES
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[str]]:
    """Return 95 % intervals of rates, and how each was made.

    Parameters
    ----------
    sums
        Hits and answers by participant and cell.
    generator, resamples
        As in `bootstrap_means`.

    Returns
    -------
    low, high, methods
        One entry a cell.

    Notes
    -----
    Where each participant answered at most once the answers are independent, and the interval is
    the exact one of Clopper and Pearson (1934); likewise for a single participant, of whom the
    interval then speaks. Else participants are resampled. If all answers are alike that shows no
    spread, and the exact interval over participants stands in, as if each had answered once: it
    is the widest that the answers allow.
    """
    low, high = bootstrap_means(sums.totals, sums.counts, generator, resamples)
    methods = [OVER_PARTICIPANTS] * len(low)
    for cell, (hits, answers) in enumerate(zip(sums.totals.T, sums.counts.T, strict=True)):
        asked = int(np.count_nonzero(answers))
        if answers.max() <= 1 or len(answers) == 1:
            right, total, methods[cell] = hits.sum(), answers.sum(), EXACT
        elif hits.sum() in (0, answers.sum()):
            right, total, methods[cell] = asked * (hits.sum() > 0), asked, EXACT_OVER_PARTICIPANTS
        else:
            continue
        exact = stats.binomtest(int(right), int(total)).proportion_ci(CONFIDENCE)
        low[cell], high[cell] = exact.low, exact.high
    return low, high, methods
