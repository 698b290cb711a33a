"""How often inserted objects are picked, against chance that differs from answer to answer."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, Matrix, rate_intervals, sum_by_participant
from analysis.estimates import seed_of, software_version
from analysis.multiplicity import holm
from analysis.thresholds.rate_tests import CLUSTER_TEST

EXACT_TEST = "exact Poisson-binomial"
MEASURES: Mapping[str, str] = {
    "any": "one or more of the inserted objects",
    "exact": "all inserted objects and no other",
}


@dataclass(frozen=True)
class PickRates:
    """Shares of answers that found the inserted objects, with 95 % intervals.

    Attributes
    ----------
    table
        One row a cell and measure: the columns `by`, `measure` (of `MEASURES`), `hits`, `answers`,
        `rate`, `low`, `high`, `interval` (how it was made), `chance` (the mean over the answers),
        `p_value` of "no more often than by chance" (one-sided), `p_holm` (corrected for the cells
        of the measure), `test`.
    objects
        One row an object that was inserted in some image: `object`, `inserted` (whether in the
        images of the row), then as `table`.
    by
        The columns that make the cells.
    participants, n
        How many gave how many answers to images with an inserted object.
    resamples, seed, version
        Of the bootstrap, its generator, and Trompe.
    """

    table: pd.DataFrame
    objects: pd.DataFrame
    by: tuple[str, ...]
    participants: int
    n: int
    resamples: int
    seed: int | None
    version: str
    method: str = "share of answers, expanded percentile bootstrap over participants"

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def pick_rates(
    table: pd.DataFrame,
    by: Sequence[str],
    objects: Mapping[int, str],
    generator: np.random.Generator,
    resamples: int = RESAMPLES,
) -> PickRates:
    """Return how often inserted objects are picked in each cell of a design, against chance.

    Parameters
    ----------
    table
        As from `analysis.answers.picks.pick_table`; controls and trials without an answer do not
        count.
    by
        The columns that make the cells, such as ``("level", "targets")``.
    objects
        The names of all labels that could be picked.
    generator
        Draws the participants of the bootstrap.
    resamples
        How many times.

    Raises
    ------
    InputError
        If no answered image has an inserted object.

    Notes
    -----
    Who picks two objects finds one more easily by chance, so each answer has a chance of its own.
    Where each participant answered a cell once, answers are independent: exact test of their sum.
    Else a score test over participants: the sum of their differences from chance, over the root of
    the sum of squares of these, as t with one degree of freedom fewer than participants.
    """
    scored = table[table["any"].notna()]
    if scored.empty:
        raise InputError("table: no answered image that has an inserted object")
    cells = [
        _against_chance(scored, measure, by, generator, resamples).assign(measure=measure)
        for measure in MEASURES
    ]
    rates = pd.concat(cells, ignore_index=True)
    front = [*by, "measure"]
    return PickRates(
        table=rates[[*front, *(name for name in rates if name not in front)]],
        objects=_against_chance(
            _by_object(scored, objects), "picked", ("object", "inserted"), generator, resamples
        ),
        by=tuple(by),
        participants=scored["participant"].nunique(),
        n=len(scored),
        resamples=resamples,
        seed=seed_of(generator),
        version=software_version(),
    )


def _by_object(scored: pd.DataFrame, objects: Mapping[int, str]) -> pd.DataFrame:
    """Return one row an answer and object that is inserted in some image."""
    ever = sorted({label for target in scored["target"] for label in target})
    rows = [
        {
            "participant": participant,
            "object": objects.get(label, str(label)),
            "inserted": label in target,
            "picked": label in answer,
            "chance_picked": len(answer) / len(objects),
        }
        for participant, target, answer in zip(
            scored["participant"], scored["target"], scored["answer"], strict=True
        )
        for label in ever
    ]
    return pd.DataFrame(rows)


def _against_chance(
    scored: pd.DataFrame,
    measure: str,
    by: Sequence[str],
    generator: np.random.Generator,
    resamples: int,
) -> pd.DataFrame:
    scored = scored.assign(**{measure: scored[measure].astype(float)})
    sums = sum_by_participant(scored, measure, by)
    expected = sum_by_participant(scored, f"chance_{measure}", by)
    low, high, intervals = rate_intervals(sums, generator, resamples)
    groups = scored.groupby(list(by), observed=True, sort=True)[f"chance_{measure}"]
    chances = [part.to_numpy(float) for _, part in groups]
    columns = zip(sums.totals.T, expected.totals.T, sums.counts.T, chances, strict=True)
    tests = [p_above_chance(*column) for column in columns]
    p_values = np.array([p_value for p_value, _ in tests])
    return sums.cells.assign(
        hits=sums.totals.sum(axis=0).astype(int),
        answers=sums.counts.sum(axis=0).astype(int),
        rate=sums.means,
        low=low,
        high=high,
        interval=intervals,
        chance=expected.means,
        p_value=p_values,
        p_holm=holm(p_values),
        test=[name for _, name in tests],
    )


def p_above_chance(
    hits: Matrix, expected: Matrix, answers: Matrix, chance: Matrix
) -> tuple[float, str]:
    """Return the one-sided p-value of "no more often than by chance", and the test.

    Parameters
    ----------
    hits, expected, answers
        Of each participant, shape (participants,): right answers, those expected by chance, and
        all.
    chance
        Of each answer.

    Notes
    -----
    As `pick_rates` says.
    """
    if answers.max() <= 1 or len(answers) == 1:
        return _at_least(int(hits.sum()), chance), EXACT_TEST
    beyond = hits - expected
    spread = float(np.sqrt(np.sum(beyond**2)))  # as if picks were found by chance alone
    score = float(beyond.sum()) / spread if spread > 0 else 0.0
    return float(stats.t.sf(score, np.count_nonzero(answers) - 1)), CLUSTER_TEST


def _at_least(hits: int, chance: Matrix) -> float:
    """Return how often so many or more of independent events of these probabilities happen."""
    counts = np.ones(1)
    for probability in chance:
        counts = np.convolve(counts, (1 - probability, probability))
    return float(min(1.0, counts[hits:].sum()))
