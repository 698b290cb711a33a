"""A scale from rankings: the model of Plackett and Luce with intervals over participants.

Each rank is a choice among the items that are left, item i being chosen with a probability in
proportion to its worth. The log-likelihood depends on the rankings only through how often each
item was chosen and how often each set of items was left, so that all resamples of the bootstrap
are fitted together by Newton's method.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray
from scipy import stats
from scipy.sparse.csgraph import connected_components

from algorithms.errors import InputError
from analysis.bootstrap import PERCENTILES, RESAMPLES, Matrix
from analysis.estimates import CONFIDENCE, seed_of, software_version
from analysis.paired.scale_fit import has_maximum
from analysis.ranking.ranks import check_ranks

PSEUDO_RANKINGS = 0.5  # for resamples without a maximum, as in Turner et al. 2020
Flags = NDArray[np.bool_]

_ITERATIONS = 100
_TOLERANCE = 1e-9
_LARGEST_ARRAY = 2_000_000  # numbers
_LONGEST_STEP = 2.0  # in log worth: further away the quadratic is no guide


@dataclass(frozen=True)
class PlackettLuceScale:
    """The log worth of each item.

    Attributes
    ----------
    table
        One row an item, best first: `item`, `log_worth` (the mean over items is 0),
        `standard_error` (of the likelihood), `low`, `high` (95 % interval over participants, which
        does not need the model to be true), `low_bootstrap`, `high_bootstrap` (percentiles over
        resampled participants; missing without a generator), `first` (the probability of being
        ranked first).
    log_likelihood
        At the maximum, without pseudo-rankings.
    pseudo_rankings
        How many times each item was taken to beat, and to lose to, one more item.
    participants, items
        How many ranked how many.
    unbounded
        The share of resamples in which some items beat all others in every ranking, so that they
        have no maximum; they were fitted with half a pseudo-ranking.
    resamples, seed, version
        Of the bootstrap, its generator, and Trompe.
    """

    table: pd.DataFrame
    log_likelihood: float
    pseudo_rankings: float
    participants: int
    items: int
    unbounded: float
    resamples: int
    seed: int | None
    version: str
    method: str = "Plackett-Luce, maximum likelihood, cluster-robust interval over participants"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def plackett_luce(
    ranks: ArrayLike,
    items: Sequence[str] | None = None,
    *,
    pseudo_rankings: float = 0.0,
    generator: np.random.Generator | None = None,
    resamples: int = RESAMPLES,
) -> PlackettLuceScale:
    """Fit worths to complete rankings without ties.

    Parameters
    ----------
    ranks
        Shape (n, k), 1 = best, as in `analysis.rank_summary`.
    items
        The names of the items, if `ranks` does not name them.
    pseudo_rankings
        Above 0 for items that are ahead of all others in every ranking: their worth would be
        infinite. 0.5 is usual (Turner et al. 2020).
    generator
        Draws participants for bootstrap intervals, which are left out without it.
    resamples
        How many times.

    Raises
    ------
    InputError
        If the rankings are not complete, or have no finite maximum without pseudo-rankings.

    Notes
    -----
    Plackett 1975; Luce 1959. The maximum is finite and unique if no set of items beats all others
    in every ranking (Hunter 2004, assumption 1). Standard errors from the observed information,
    with the mean of the log worths fixed; intervals from the cluster-robust ("sandwich") ones with
    t (Liang and Zeger 1986), which hold what they promise with fewer participants than the
    bootstrap does (measured by ``python -m benchmarks.ranking``).
    """
    if not 0 <= pseudo_rankings < np.inf:
        raise InputError(f"pseudo_rankings: {pseudo_rankings} given, 0 or more accepted")
    rankings = check_ranks(ranks, items)
    choices = _choices(rankings.ranks)
    participants = np.ones((1, len(rankings.ranks)))
    if pseudo_rankings == 0:
        _check_maximum(rankings.ranks, rankings.items)
    worths, covariance = _fit(choices, participants, np.full(1, pseudo_rankings))
    reach = _reach(choices, worths[0], covariance[0])
    table = pd.DataFrame(
        {
            "item": rankings.items,
            "log_worth": worths[0],
            "standard_error": np.sqrt(np.diag(covariance[0])),
            "low": worths[0] - reach,
            "high": worths[0] + reach,
        }
    )
    unbounded = np.nan
    if generator is not None:
        ends, unbounded = _bootstrap(rankings.ranks, choices, pseudo_rankings, generator, resamples)
        table["low_bootstrap"], table["high_bootstrap"] = ends
    table["first"] = np.exp(worths[0]) / np.exp(worths[0]).sum()
    return PlackettLuceScale(
        table=table.sort_values("log_worth", ascending=False, ignore_index=True),
        log_likelihood=float(_log_likelihood(choices, participants, worths)[0]),
        pseudo_rankings=pseudo_rankings,
        participants=len(rankings.ranks),
        items=len(rankings.items),
        unbounded=unbounded,
        resamples=resamples if generator is not None else 0,
        seed=seed_of(generator) if generator is not None else None,
        version=software_version(),
    )


@dataclass(frozen=True)
class _Choices:
    """What each participant chose, and from what.

    Attributes
    ----------
    chosen
        Shape (n, k): 1 for each item but a participant's last.
    sets
        Shape (s, k): the different sets of items left at some choice, as 0 and 1.
    offered
        Shape (n, s): how often a participant chose from each set.
    """

    chosen: Matrix
    sets: Matrix
    offered: Matrix


def _choices(ranks: Matrix) -> _Choices:
    participants, items = ranks.shape
    left = ranks[:, None] >= np.arange(1, items)[:, None]  # (n, k - 1, k)
    sets, number = np.unique(left.reshape(-1, items), axis=0, return_inverse=True)
    offered = np.zeros((participants, len(sets)))
    offered[np.repeat(np.arange(participants), items - 1), number.ravel()] = 1
    return _Choices((ranks < items).astype(float), sets.astype(float), offered)


def _check_maximum(ranks: Matrix, items: tuple[str, ...]) -> None:
    beats: Flags = np.asarray((ranks[:, :, None] < ranks[:, None]).any(axis=0))
    parts, part = connected_components(beats, directed=True, connection="strong")
    if parts == 1:
        return
    ahead = next(
        group
        for group in (part == number for number in range(parts))
        if not beats[np.ix_(~group, group)].any()
    )
    names = ", ".join(name for name, is_ahead in zip(items, ahead, strict=True) if is_ahead)
    raise InputError(
        f"ranks: every ranking has {names} ahead of all other items, so that their worth has no"
        f" finite maximum; pseudo_rankings={PSEUDO_RANKINGS} accepted"
    )


def _reach(choices: _Choices, log_worths: Matrix, covariance: Matrix) -> Matrix:
    """Return half the length of the intervals over participants."""
    worth = np.exp(log_worths)
    shares = choices.sets * worth / (choices.sets @ worth)[:, None]
    scores = choices.chosen - choices.offered @ shares
    scores -= scores.mean(axis=0)
    participants = len(scores)
    robust = covariance @ (scores.T @ scores) @ covariance * participants / (participants - 1)
    t = stats.t.ppf((1 + CONFIDENCE) / 2, participants - 1)
    return np.asarray(t * np.sqrt(np.diag(robust)))


def _bootstrap(
    ranks: Matrix,
    choices: _Choices,
    pseudo_rankings: float,
    generator: np.random.Generator,
    resamples: int,
) -> tuple[Matrix, float]:
    """Return the ends of the intervals, shape (2, k), and the share of unbounded resamples."""
    if resamples < 1:
        raise InputError(f"resamples: {resamples} given, 1 or more accepted")
    participants = len(ranks)
    drawn = generator.multinomial(
        participants, np.full(participants, 1 / participants), size=resamples
    ).astype(float)
    beats = (ranks[:, :, None] < ranks[:, None]).astype(float)
    unbounded = ~has_maximum(np.tensordot(drawn, beats, axes=1))
    pseudo = np.where(unbounded, max(pseudo_rankings, PSEUDO_RANKINGS), pseudo_rankings)
    parts = 1 + resamples * choices.sets.size // _LARGEST_ARRAY
    worths = [
        _fit(choices, *part)[0]
        for part in zip(np.array_split(drawn, parts), np.array_split(pseudo, parts), strict=True)
    ]
    return np.percentile(np.concatenate(worths), PERCENTILES, axis=0), float(unbounded.mean())


def _log_likelihood(choices: _Choices, weights: Matrix, worths: Matrix) -> Matrix:
    sums = np.exp(worths) @ choices.sets.T
    chosen = (weights @ choices.chosen * worths).sum(axis=1)
    return np.asarray(chosen - (weights @ choices.offered * np.log(sums)).sum(axis=1))


def _fit(choices: _Choices, weights: Matrix, pseudo: Matrix) -> tuple[Matrix, Matrix]:
    """Maximise the likelihood of weighted participants, one fit a row of the weights.

    Returns
    -------
    log_worths, covariance
        Shape (fits, k) and (fits, k, k); log worths have mean 0.
    """
    chosen, offered = weights @ choices.chosen, weights @ choices.offered
    fits, items = chosen.shape
    worths = np.zeros((fits, items))
    level = np.full((items, items), 1 / items)
    # Without pseudo-rankings the likelihood does not change when all worths do.
    fixed = np.where(pseudo > 0, 0.0, 1.0)[:, None, None] * level
    for _ in range(_ITERATIONS):
        worth = np.exp(worths)
        shares = choices.sets * worth[:, None] / (worth @ choices.sets.T)[..., None]
        expected = np.einsum("fs,fsk->fk", offered, shares)
        against_mean = 1 / (1 + np.exp(-worths))
        slope = chosen - expected + pseudo[:, None] * (1 - 2 * against_mean)
        information = -np.einsum("fs,fsi,fsj->fij", offered, shares, shares, optimize=True)
        diagonal = expected + 2 * pseudo[:, None] * against_mean * (1 - against_mean)
        information[:, np.arange(items), np.arange(items)] += diagonal
        step = np.linalg.solve(information + fixed, slope[..., None])[..., 0]
        step *= np.minimum(1, _LONGEST_STEP / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
        worths = worths + step
        if np.abs(step).max() < _TOLERANCE:
            break
    else:
        raise RuntimeError(f"no maximum found in {_ITERATIONS} steps of Newton's method")
    centring = np.eye(items) - level
    covariance = centring @ np.linalg.inv(information + fixed) @ centring
    return worths @ centring, covariance
