"""Times per answer by level and condition."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, bootstrap_means, sum_by_participant
from analysis.estimates import seed_of, software_version


@dataclass(frozen=True)
class AnswerTimes:
    """Geometric mean times per answer with 95 % intervals.

    Attributes
    ----------
    table
        One row a cell: the columns `by`, `answers`, `mean_s`, `low_s`, `high_s` (geometric; no
        interval for a single participant).
    by
        The columns that make the cells.
    median_s
        The median over all answers.
    participants, n
        How many gave how many timed answers.
    resamples, seed, version
        Of the bootstrap, its generator, and Trompe.
    """

    table: pd.DataFrame
    by: tuple[str, ...]
    median_s: float
    participants: int
    n: int
    resamples: int
    seed: int | None
    version: str
    method: str = "geometric mean, expanded percentile bootstrap over participants"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def answer_times(
    table: pd.DataFrame,
    by: Sequence[str],
    generator: np.random.Generator,
    resamples: int = RESAMPLES,
) -> AnswerTimes:
    """Return the time per answer in each cell of a design.

    Parameters
    ----------
    table
        As from `analysis.trial_table`; controls count too: their answers take time.
    by
        The columns that make the cells, such as ``("level", "placement")``.
    generator, resamples
        As in `analysis.hit_rates`.

    Raises
    ------
    InputError
        If no answer has a time.

    Notes
    -----
    Times are skewed: their logarithms are averaged (Lopez-Moreno 2011, figure 2.4, shows plain
    means).
    """
    timed = table[table["answer"].notna() & table["reaction_time_s"].notna()]
    if timed.empty:
        raise InputError("table: no answer with a time")
    times_s = timed["reaction_time_s"].astype(float)
    sums = sum_by_participant(timed.assign(log_time=np.log(times_s)), "log_time", by)
    low, high = bootstrap_means(sums.totals, sums.counts, generator, resamples)
    cells = sums.cells.assign(
        answers=sums.counts.sum(axis=0).astype(int),
        mean_s=np.exp(sums.means),
        low_s=np.exp(low),
        high_s=np.exp(high),
    )
    return AnswerTimes(
        cells,
        tuple(by),
        float(times_s.median()),
        participants=len(sums.totals),
        n=len(timed),
        resamples=resamples,
        seed=seed_of(generator),
        version=software_version(),
    )
