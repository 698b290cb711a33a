"""Hit rates: the share of right answers by level and condition."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, rate_intervals, sum_by_participant
from analysis.estimates import seed_of, software_version
from analysis.multiplicity import holm
from analysis.thresholds.rate_tests import rates_above


@dataclass(frozen=True)
class HitRates:
    """Shares of right answers with 95 % intervals.

    Attributes
    ----------
    table
        One row a cell: the columns `by`, `hits`, `answers`, `rate`, `low`, `high`, `interval`
        (how it was made); `p_value` of "no better than guessing" (one-sided), `p_holm`
        (corrected for the number of cells), `test`.
    by
        The columns that make the cells.
    guess_rate
        The share of right answers by chance.
    participants, n
        How many gave how many answers.
    resamples, seed, version
        Of the bootstrap, its generator, and Trompe.
    """

    table: pd.DataFrame
    by: tuple[str, ...]
    guess_rate: float
    participants: int
    n: int
    resamples: int
    seed: int | None
    version: str
    method: str = "share of right answers, expanded percentile bootstrap over participants"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def hit_rates(
    table: pd.DataFrame,
    by: Sequence[str],
    guess_rate: float,
    generator: np.random.Generator,
    resamples: int = RESAMPLES,
) -> HitRates:
    """Return hit rates in each cell of a design, against chance.

    Parameters
    ----------
    table
        As from `analysis.trial_table`; controls and trials without an answer do not count.
    by
        The columns that make the cells, such as ``("level", "placement", "material")``.
    guess_rate
        The share of right answers by chance, 0 to 1.
    generator
        Draws the participants of the bootstrap.
    resamples
        How many times.

    Raises
    ------
    InputError
        If no trial has a right answer to compare with, or an argument is impossible.

    Notes
    -----
    Where each participant answered a cell once, answers are independent: exact binomial test and
    Clopper and Pearson's interval. Else participants are the sample: bootstrap interval and a test
    over them (`analysis.rate_tests`).
    """
    if not 0 <= guess_rate < 1:
        raise InputError(f"guess_rate: {guess_rate} given, 0 or more and below 1 accepted")
    scored = table[table["correct"].notna()]
    if scored.empty:
        raise InputError("table: no answered trial that has a right answer")
    sums = sum_by_participant(scored, "correct", by)
    low, high, intervals = rate_intervals(sums, generator, resamples)
    p_values, tests = rates_above(sums, guess_rate)
    rates = sums.cells.assign(
        hits=sums.totals.sum(axis=0).astype(int),
        answers=sums.counts.sum(axis=0).astype(int),
        rate=sums.means,
        low=low,
        high=high,
        interval=intervals,
        p_value=p_values,
        p_holm=holm(p_values),
        test=tests,
    )
    return HitRates(
        rates,
        tuple(by),
        guess_rate,
        participants=len(sums.totals),
        n=len(scored),
        resamples=resamples,
        seed=seed_of(generator),
        version=software_version(),
    )
