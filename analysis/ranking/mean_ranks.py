"""Rankings of images: mean ranks with intervals, agreement, and which images differ."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats

from analysis.bootstrap import RESAMPLES, Matrix, bootstrap_means
from analysis.bounded_means import mean_interval
from analysis.estimates import CONFIDENCE, seed_of, software_version
from analysis.ranking.comparisons import ALPHA, PostHoc, RankComparisons, compare_ranks
from analysis.ranking.friedman import Concordance, friedman
from analysis.ranking.ranks import Rankings, check_ranks

MEAN_INTERVAL = "Wilson-type interval over participants"


@dataclass(frozen=True)
class RankSummary:
    """What participants' rankings of the same items say.

    Attributes
    ----------
    table
        One row an item, best first: `item`, `mean` (rank), `low`, `high` (95 % interval of
        `method`), `low_bootstrap`, `high_bootstrap` (resampled participants; missing without a
        generator), and the normal fit of `analysis.ranking.mean_ranks.normal_fit`.
    concordance
        Friedman's test and Kendall's W.
    comparisons
        All pairs of items, and groups of items that do not differ.
    participants, items
        How many ranked how many.
    tied
        Whether some participant gave items the same rank.
    resamples, seed, version
        Of the bootstrap, its generator, and Trompe.
    """

    table: pd.DataFrame
    concordance: Concordance
    comparisons: RankComparisons
    participants: int
    items: int
    tied: bool
    resamples: int
    seed: int | None
    version: str
    method: str = f"mean ranks, {MEAN_INTERVAL}"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def rank_summary(
    ranks: ArrayLike,
    items: Sequence[str] | None = None,
    *,
    ties: bool = False,
    posthoc: PostHoc = "nemenyi",
    alpha: float = ALPHA,
    generator: np.random.Generator | None = None,
    resamples: int = RESAMPLES,
) -> RankSummary:
    """Summarise complete rankings of k items by n participants.

    Parameters
    ----------
    ranks
        Shape (n, k), 1 = best, one row a participant; a data frame names its items by its columns.
    items
        The names of the items, if `ranks` does not name them; else they are numbered from 1.
    ties
        Whether a participant may give items the same rank; their mean is used.
    posthoc
        The test that makes the groups, see `analysis.compare_ranks`.
    alpha
        Its significance for the family of all pairs.
    generator
        Draws participants for bootstrap intervals of the mean ranks, which are left out without it.
    resamples
        How many times.

    Raises
    ------
    InputError
        If the rankings are not complete, or an argument is impossible.

    Notes
    -----
    The interval of a mean rank is of Wilson's type (see `analysis.bounded_means`): near the first
    and the last rank those of t and of the bootstrap are too narrow (measured by
    ``python -m benchmarks.ranking``).

    Examples
    --------
    >>> summary = rank_summary([[1, 2, 3], [1, 3, 2], [1, 2, 3], [2, 1, 3]], items=("a", "b", "c"))
    >>> summary.table["item"].tolist(), summary.concordance.w
    (['a', 'b', 'c'], 0.5625)
    """
    rankings = check_ranks(ranks, items, ties=ties)
    table = rankings.ranks
    return RankSummary(
        table=_item_table(rankings, generator, resamples),
        concordance=friedman(table, ties=True),
        comparisons=compare_ranks(rankings, posthoc, alpha),
        participants=len(table),
        items=table.shape[1],
        tied=rankings.tied,
        resamples=resamples if generator is not None else 0,
        seed=seed_of(generator) if generator is not None else None,
        version=software_version(),
    )


def normal_fit(ranks: Matrix) -> pd.DataFrame:
    """Return what a normal distribution fitted to each item's ranks says.

    Parameters
    ----------
    ranks
        Shape (n, k), ties averaged.

    Returns
    -------
    pandas.DataFrame
        One row an item: `mean`, `low_t`, `high_t`, `standard_deviation` (n - 1),
        `low_standard_deviation`, `high_standard_deviation`; 95 % intervals.

    Notes
    -----
    The form of Lopez-Moreno 2011, tables 7.4 and 7.5 and figure 7.14: t interval of the mean,
    chi-square interval of the standard deviation. Ranks are not normal: the first is too narrow for
    items nearly always first or last, the second may hold far more or less than 95 %.
    """
    participants = len(ranks)
    mean, deviation = ranks.mean(axis=0), ranks.std(axis=0, ddof=1)
    reach = stats.t.ppf((1 + CONFIDENCE) / 2, participants - 1) * deviation / np.sqrt(participants)
    squares = (participants - 1) * deviation**2
    tails = np.array([1 + CONFIDENCE, 1 - CONFIDENCE]) / 2
    upper, lower = np.asarray(stats.chi2.ppf(tails, participants - 1))
    return pd.DataFrame(
        {
            "mean": mean,
            "low_t": mean - reach,
            "high_t": mean + reach,
            "standard_deviation": deviation,
            "low_standard_deviation": np.sqrt(squares / upper),
            "high_standard_deviation": np.sqrt(squares / lower),
        }
    )


def _item_table(
    rankings: Rankings, generator: np.random.Generator | None, resamples: int
) -> pd.DataFrame:
    ranks = rankings.ranks
    participants, items = ranks.shape
    fit = normal_fit(ranks)
    error = fit["standard_deviation"].to_numpy() / np.sqrt(participants)
    low, high = mean_interval(fit["mean"].to_numpy(), error, participants, (1, items))
    table = pd.DataFrame(
        {"item": rankings.items, "mean": fit.pop("mean"), "low": low, "high": high}
    )
    if generator is not None:
        ends = bootstrap_means(ranks, np.ones_like(ranks), generator, resamples)
        table["low_bootstrap"], table["high_bootstrap"] = ends
    table = pd.concat([table, fit], axis=1)
    return table.sort_values("mean", kind="stable", ignore_index=True)
