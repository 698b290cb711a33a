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
    Percentile bootstrap of a ratio of sums (Efron and Tibshirani 1993, ch. 13), participants
    drawn with replacement; a resample without any answer in a cell says nothing about it.
    """
    if totals.shape != counts.shape or totals.ndim != 2:
        raise InputError(
            f"totals, counts: shapes {totals.shape} and {counts.shape} given,"
            " one shape (participants, cells) accepted"
        )
    if resamples < 1:
        raise InputError(f"resamples: {resamples} given, 1 or more accepted")
    participants, cells = totals.shape
    if participants < 2:
        return np.full(cells, np.nan), np.full(cells, np.nan)
    chosen = generator.multinomial(
        participants, np.full(participants, 1 / participants), size=resamples
    ).astype(float)
    drawn = chosen @ counts
    means = np.divide(chosen @ totals, drawn, out=np.full(drawn.shape, np.nan), where=drawn > 0)
    low, high = np.nanpercentile(means, PERCENTILES, axis=0)
    return low, high


def rate_intervals(
    sums: Sums, generator: np.random.Generator, resamples: int = RESAMPLES
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[str]]:
    """Return 95 % intervals of rates, and how each was made.

    Participants are resampled; where that cannot show any spread (all answers alike, or a single
    participant) the interval is that of Clopper and Pearson (1934) over the answers.

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
    """
    low, high = bootstrap_means(sums.totals, sums.counts, generator, resamples)
    methods = ["bootstrap over participants"] * len(low)
    for cell, (hits, answers) in enumerate(
        zip(sums.totals.sum(axis=0), sums.counts.sum(axis=0), strict=True)
    ):
        if np.isnan(low[cell]) or hits in (0, answers):
            exact = stats.binomtest(int(hits), int(answers)).proportion_ci(CONFIDENCE)
            low[cell], high[cell] = exact.low, exact.high
            methods[cell] = "Clopper-Pearson"
    return low, high, methods
