"""What can be checked of printed means and percentages when the answers are not published.

Lopez-Moreno 2011 prints mean ranks (tables 7.4 and 7.5) and percentages (secs. 6.4.2, 7.5, 8.7)
without the answers. Some facts follow all the same: mean ranks of complete rankings have a known
sum, and the mean of n whole numbers is a multiple of 1 / n.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from algorithms.errors import InputError

_LARGEST_NUMBER = 1000


@dataclass(frozen=True)
class MeanRankCheck:
    """Whether printed mean ranks can come from complete rankings.

    Attributes
    ----------
    total, expected
        The sum of the printed means, and ``k (k + 1) / 2``.
    rounding
        How far rounding alone can move the sum.
    possible
        Whether the sum is as expected but for rounding.
    """

    total: float
    expected: float
    rounding: float
    possible: bool

    def __str__(self) -> str:
        verdict = "as complete rankings give" if self.possible else "complete rankings give"
        return f"the mean ranks sum to {self.total:.2f}, {verdict} {self.expected:.2f}"


def check_mean_ranks(means: Sequence[float], decimals: int) -> MeanRankCheck:
    """Check whether mean ranks add up as complete rankings, with or without ties, must.

    Parameters
    ----------
    means
        The mean rank of each item as printed, two or more.
    decimals
        How many decimals are printed, 0 or more.

    Raises
    ------
    InputError
        If there are fewer than two means or one cannot be a mean rank.

    Examples
    --------
    >>> print(check_mean_ranks([3.759, 1.931, 4.701, 2.931, 1.828], decimals=3))  # table 7.4
    the mean ranks sum to 15.15, complete rankings give 15.00
    """
    items = len(means)
    if items < 2 or not all(1 <= mean <= items for mean in means):
        raise InputError(f"means: {list(means)} given, two or more from 1 to {items} accepted")
    total, expected = float(sum(means)), items * (items + 1) / 2
    rounding = items * _half_unit(decimals)
    return MeanRankCheck(total, expected, rounding, abs(total - expected) <= rounding)


def possible_numbers(
    printed: Sequence[float], decimals: int, largest: int = _LARGEST_NUMBER
) -> list[int]:
    """Return the numbers of answers from which all the printed means can come.

    Parameters
    ----------
    printed
        Means of whole numbers, or shares (not percentages), over the same number of answers.
    decimals
        How many decimals are printed, 0 or more.
    largest
        The largest number of answers tried, 1 or more.

    Notes
    -----
    Brown and Heathers 2017 (the "GRIM test"): n answers allow the multiples of 1 / n only, rounded.

    Examples
    --------
    >>> possible_numbers([0.7059, 0.5294], decimals=4, largest=40)  # sec. 6.4.2, stated: 20 people
    [17, 34]
    """
    means = np.asarray(printed, dtype=float)
    if means.ndim != 1 or not len(means) or largest < 1:
        raise InputError("printed, largest: one mean or more, and 1 or more accepted")
    half = _half_unit(decimals)
    numbers = np.arange(1, largest + 1)
    nearest = np.rint(means * numbers[:, None]) / numbers[:, None]
    return [int(number) for number in numbers[(np.abs(nearest - means) <= half).all(axis=1)]]


def _half_unit(decimals: int) -> float:
    if decimals < 0:
        raise InputError(f"decimals: {decimals} given, 0 or more accepted")
    return float(0.5 * 10.0**-decimals * (1 + 1e-9))  # the edge itself may be printed
