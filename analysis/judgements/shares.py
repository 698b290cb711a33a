"""Shares of answers, with an interval that fits how they were given.

One answer a participant: answers are independent, and the binomial distribution holds. Several: a
participant's answers are alike, and participants are the sample.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats

from algorithms.errors import InputError
from analysis.bootstrap import Matrix, Sums
from analysis.bounded_means import mean_interval, ratio_of_sums
from analysis.estimates import CONFIDENCE, Estimate

Binomial = Literal["clopper-pearson", "wilson"]
_NAMES = {"clopper-pearson": "Clopper-Pearson", "wilson": "Wilson"}
_SCIPY_NAMES: dict[Binomial, Literal["exact", "wilson"]] = {
    "clopper-pearson": "exact",
    "wilson": "wilson",
}
OVER_PARTICIPANTS = "Wilson-type, over participants"


@dataclass(frozen=True)
class Answers:
    """How often each participant said yes, and how often each was asked.

    Attributes
    ----------
    yes, asked
        Shape (participants,); everybody was asked at least once.
    """

    yes: Matrix
    asked: Matrix

    @property
    def independent(self) -> bool:
        """Whether answers may be taken as independent: one a participant, or one participant."""
        return bool(np.all(self.asked == 1)) or len(self.asked) == 1

    @property
    def share(self) -> float:
        """The share of yes over all answers."""
        return float(self.yes.sum() / self.asked.sum())

    @property
    def standard_error(self) -> float:
        """Of the share, over participants."""
        _, error = ratio_of_sums(self.yes[:, None], self.asked[:, None])
        return float(error[0])


def check_answers(yes: ArrayLike, asked: ArrayLike | None = None) -> Answers:
    """Check counts by participant; participants who were never asked are left out.

    Parameters
    ----------
    yes
        Shape (participants,): how often each said yes, or chose the first of two.
    asked
        How often each was asked; once, if left out.

    Raises
    ------
    InputError
        If the counts are impossible or there is no answer.
    """
    counts = _whole("yes", yes)
    total = np.ones_like(counts) if asked is None else _whole("asked", asked)
    if counts.shape != total.shape:
        raise InputError(
            f"yes, asked: {counts.size} and {total.size} entries given, one a participant accepted"
        )
    if np.any(counts > total):
        raise InputError("yes: more than the participant was asked given")
    if not total.any():
        raise InputError("asked: no answer given, one or more accepted")
    return Answers(counts[total > 0], total[total > 0])


def share_interval(answers: Answers, binomial: Binomial = "wilson") -> tuple[Estimate, str]:
    """Return a share with its 95 % interval, and how the interval was made.

    Parameters
    ----------
    answers
        As from `check_answers`.
    binomial
        The interval of independent answers: `clopper-pearson` never holds less than it promises
        and agrees with the exact test; `wilson` holds 95 % on average (Brown et al. 2001).

    Raises
    ------
    InputError
        If `binomial` is neither.
    """
    if binomial not in _NAMES:
        raise InputError(f"binomial: {binomial!r} given, one of {list(_NAMES)} accepted")
    if answers.independent:
        test = stats.binomtest(int(answers.yes.sum()), int(answers.asked.sum()))
        ends = test.proportion_ci(CONFIDENCE, method=_SCIPY_NAMES[binomial])
        one = ", answers of one participant" if answers.asked.max() > 1 else ""
        return Estimate(answers.share, ends.low, ends.high), _NAMES[binomial] + one
    low, high = mean_interval(
        np.array([answers.share]), np.array([answers.standard_error]), len(answers.yes)
    )
    return Estimate(answers.share, float(low[0]), float(high[0])), OVER_PARTICIPANTS


def share_table(sums: Sums, binomial: Binomial = "wilson") -> pd.DataFrame:
    """Return the share of yes in each cell of a design.

    Parameters
    ----------
    sums
        Yes and answers by participant and cell.
    binomial
        As in `share_interval`.

    Returns
    -------
    pandas.DataFrame
        The columns of the cells, `yes`, `answers`, `participants`, `share`, `low`, `high`,
        `interval` (how it was made).
    """
    rows = []
    for yes, asked in zip(sums.totals.T, sums.counts.T, strict=True):
        answers = check_answers(yes, asked)
        estimate, interval = share_interval(answers, binomial)
        rows.append(
            {
                "yes": int(yes.sum()),
                "answers": int(asked.sum()),
                "participants": len(answers.asked),
                "share": estimate.value,
                "low": estimate.low,
                "high": estimate.high,
                "interval": interval,
            }
        )
    return pd.concat([sums.cells, pd.DataFrame(rows)], axis=1)


def _whole(name: str, values: ArrayLike) -> Matrix:
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: not a sequence of numbers") from None
    if array.ndim != 1 or not np.all((array >= 0) & (array % 1 == 0)):
        raise InputError(f"{name}: one whole number of 0 or more for each participant accepted")
    return array
