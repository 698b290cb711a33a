"""Groups of items whose scores do not differ significantly.

An item's score is how often it was preferred. Two items differ significantly when their scores
differ by the critical difference or more; a group is a run of items, in order of their scores,
none of which differ. Groups may overlap.
"""

import math
import string
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from scipy import stats

from algorithms.errors import InputError
from analysis.estimates import seed_of, software_version
from analysis.paired.item_permutations import (
    PERMUTATIONS,
    monte_carlo_p_value,
    observer_numbers,
    permuted_scores,
)
from analysis.paired.pair_data import Tournaments, item_names, tournaments
from analysis.paired.score_range import (
    RangeDistribution,
    critical_difference,
    exact_is_feasible,
    exact_range,
    simulated_range,
)

Critical = Literal["formula", "exact", "permuted"]
ALPHA = 0.05


@dataclass(frozen=True)
class ScoreGroups:
    """Scores, their groups, and the overall test.

    Attributes
    ----------
    table
        One row an item, best first: `item`, `score`, `groups` (a letter for each of its groups).
    groups
        The items of each group, best first.
    alpha
        The probability of splitting any items if all are alike.
    critical
        The difference from which on items differ significantly; None where even the largest
        possible one does not.
    criterion
        Where it is from: `formula`, `exact` or `permuted`.
    formula
        R_c of the large-sample formula, before rounding up.
    formula_size
        How often coins reach the rounded R_c: what alpha is in truth. NaN if not computed.
    exact_critical, null_method
        The critical difference of the range's distribution under coins, and how that was
        computed; None where it was not, or where no difference is rare enough.
    permuted_critical
        The same with items shuffled within observers, who may each be consistent; None without
        a generator, or where no difference is rare enough.
    largest_difference
        The largest possible difference of two scores, n (t - 1).
    range_p_value, permuted_range_p_value
        The probability of the observed range, by both.
    chi_square, freedom, p_value, permuted_p_value
        The overall test of equal scores (David's D), by both.
    n, observers
        The number of tournaments, and of those who made them.
    permutations, seed, version
        Of the shuffling, its generator, and Trompe.
    """

    table: pd.DataFrame
    groups: tuple[tuple[str, ...], ...]
    alpha: float
    critical: int | None
    criterion: Critical
    formula: float
    formula_size: float
    exact_critical: int | None
    null_method: str
    permuted_critical: int | None
    largest_difference: int
    range_p_value: float
    permuted_range_p_value: float
    chi_square: float
    freedom: int
    p_value: float
    permuted_p_value: float
    n: int
    observers: int
    permutations: int
    seed: int | None
    version: str
    method: str = "score differences against a critical range; overall: David's D"

    @property
    def remark(self) -> str:
        """What a reader has to know where no difference can be significant; else nothing."""
        if self.critical is not None:
            return ""
        needed = math.ceil(self.formula) if self.criterion == "formula" else "a larger one"
        return (
            f"The critical difference cannot be reached: {needed} is needed at"
            f" alpha = {self.alpha:g}, {self.largest_difference} is the largest possible"
            " difference of two scores."
        )

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def score_groups(
    wins: ArrayLike,
    alpha: float = ALPHA,
    *,
    items: Sequence[str] | None = None,
    observers: Sequence[object] | None = None,
    critical: Critical = "formula",
    generator: np.random.Generator | None = None,
    permutations: int = PERMUTATIONS,
) -> ScoreGroups:
    """Return groups of items whose scores do not differ significantly.

    Parameters
    ----------
    wins
        Shape (n, t, t) or (t, t), t of 2 or more: 1 where the row's item was preferred to the
        column's, 0 elsewhere; every pair exactly once.
    alpha
        The probability of splitting items that are all alike, above 0 and below 1.
    items
        Their names; None: 1, 2, ...
    observers
        Who made each of the n tournaments, where one observer made several (scores pooled over
        four conditions make n four times the number of people); only `permuted` allows for it.
    critical
        `formula`: the large-sample formula, rounded up. `exact`: the distribution of the range if
        every answer is a coin's (simulated where too large). `permuted`: the distribution with
        items shuffled within observers; where some items do differ it asks for more than needed.
    generator
        Shuffles and simulates; None: what needs it is left out.
    permutations
        How many shuffles, 1 or more.

    Raises
    ------
    InputError
        If an argument is impossible, or a pair is missing, repeated or tied.

    Notes
    -----
    David 1988, The Method of Paired Comparisons, ch. 3; Starks and David 1961, Biometrika 48, for
    the overall test; as in Lopez-Moreno 2011, eq. 7.4 and 7.5 and table 7.3. Formula and exact
    distribution take answers for coins. Observers who are consistent, but of tastes that have
    nothing in common, are not: their scores have up to (t + 1) / 3 times the variance, and items
    alike to the group are split far more often than alpha says. The permuted distribution holds
    alpha there too (`benchmarks/paired.py` measures both).

    Examples
    --------
    >>> order = [[0, 1, 1], [0, 0, 1], [0, 0, 0]]
    >>> score_groups([order] * 20, items=["a", "b", "c"]).groups
    (('a',), ('b',), ('c',))
    """
    choices = tournaments(wins)
    names = item_names(items, choices.shape[-1])
    check_options(alpha, critical)
    _check_generator(critical, len(names), len(choices), generator)
    null = _null(len(names), len(choices), generator)
    scores = choices.sum(axis=(0, 2))
    shuffled = _shuffled(choices, scores, observers, generator, permutations)
    formula = critical_difference(len(names), len(choices), alpha)
    largest = len(choices) * (len(names) - 1)
    rounded = math.ceil(formula)
    chosen = {
        "formula": rounded if rounded <= largest else None,
        "exact": null.critical(alpha) if null else None,
        "permuted": shuffled.range.critical(alpha) if shuffled else None,
    }
    table, groups = group_scores(scores.tolist(), names, chosen[critical])
    chi_square = david_chi_square(scores.tolist(), len(choices))
    spread = int(np.ptp(scores))
    return ScoreGroups(
        table=table,
        groups=groups,
        alpha=alpha,
        critical=chosen[critical],
        criterion=critical,
        formula=formula,
        formula_size=_size(null, rounded),
        exact_critical=chosen["exact"],
        null_method=null.method if null else "left out: too large, and no generator to simulate",
        permuted_critical=chosen["permuted"],
        largest_difference=largest,
        range_p_value=null.p_value(spread) if null else math.nan,
        permuted_range_p_value=shuffled.range.p_value(spread) if shuffled else math.nan,
        chi_square=chi_square,
        freedom=len(names) - 1,
        p_value=float(stats.chi2.sf(chi_square, len(names) - 1)),
        permuted_p_value=shuffled.p_value if shuffled else math.nan,
        n=len(choices),
        observers=int(observer_numbers(observers, len(choices)).max()) + 1,
        permutations=permutations if shuffled else 0,
        seed=seed_of(generator) if generator is not None else None,
        version=software_version(),
    )


def group_scores(
    scores: Sequence[float], items: Sequence[str], critical: float | None
) -> tuple[pd.DataFrame, tuple[tuple[str, ...], ...]]:
    """Return items by falling score, and the maximal runs with a range below the critical one.

    Parameters
    ----------
    scores, items
        One entry an item.
    critical
        The difference from which on two items differ; None: none do.

    Returns
    -------
    table : pandas.DataFrame
        `item`, `score` and `groups`, the letters of an item's groups.
    groups : tuple of tuple of str
        The items of each group.
    """
    order = np.argsort(-np.asarray(scores), kind="stable")
    ranked = np.asarray(scores)[order]
    runs: list[tuple[int, int]] = []
    for start, best in enumerate(ranked):
        alike = ranked[start:] > best - (math.inf if critical is None else critical)
        end = start + int(alike.sum())
        if not runs or end > runs[-1][1]:
            runs.append((start, end))
    names = [str(items[k]) for k in order]
    letters = [
        "".join(_letter(number) for number, (a, b) in enumerate(runs) if a <= place < b)
        for place in range(len(names))
    ]
    table = pd.DataFrame({"item": names, "score": ranked, "groups": letters})
    return table, tuple(tuple(names[start:end]) for start, end in runs)


def david_chi_square(scores: Sequence[int], observers: int) -> float:
    """Return David's D, chi-square with t - 1 degrees of freedom if every answer is a coin's."""
    items = len(scores)
    expected = observers * (items - 1) / 2
    return 4 * sum((score - expected) ** 2 for score in scores) / (observers * items)


def underlined(result: ScoreGroups) -> str:
    """Return items and scores in a line, best first, and a line under each group (as table 7.3)."""
    cells = [f"{row.item} ({row.score})" for row in result.table.itertuples()]
    starts = np.cumsum([0, *(len(cell) + 2 for cell in cells)])
    lines = ["  ".join(cells)]
    place = {item: k for k, item in enumerate(result.table["item"])}
    for group in result.groups:
        first, last = place[group[0]], place[group[-1]]
        left, right = int(starts[first]), int(starts[last]) + len(cells[last])
        lines.append(" " * left + "─" * (right - left))
    return "\n".join(lines + ([result.remark] if result.remark else []))


def underlined_table(results: Mapping[str, ScoreGroups]) -> str:
    """Return the groups of several conditions, each under its name (the form of table 7.3)."""
    return "\n\n".join(f"{name}\n{underlined(result)}" for name, result in results.items())


@dataclass(frozen=True)
class _Shuffled:
    """With items shuffled within observers: the range, and the p-value of the overall test."""

    range: RangeDistribution
    p_value: float


def _shuffled(
    choices: Tournaments,
    scores: ArrayLike,
    observers: Sequence[object] | None,
    generator: np.random.Generator | None,
    permutations: int,
) -> _Shuffled | None:
    if generator is None:
        return None
    size = len(choices) * (choices.shape[-1] - 1) + 1
    squares = int((np.asarray(scores) ** 2).sum())
    counted, as_far = np.zeros(size), 0
    for drawn in permuted_scores(choices, generator, permutations, observers):
        counted += np.bincount(np.ptp(drawn, axis=1), minlength=size)
        as_far += int(((drawn**2).sum(axis=1) >= squares).sum())
    tail = np.cumsum(counted[::-1])[::-1] / permutations
    distribution = RangeDistribution(tail, f"permuted, {permutations} times", permutations)
    return _Shuffled(distribution, monte_carlo_p_value(as_far, permutations))


def _null(
    items: int, observers: int, generator: np.random.Generator | None
) -> RangeDistribution | None:
    if exact_is_feasible(items, observers):
        return exact_range(items, observers)
    return None if generator is None else simulated_range(items, observers, generator)


def _size(null: RangeDistribution | None, difference: int) -> float:
    if null is None:
        return math.nan
    return float(null.tail[difference]) if difference < len(null.tail) else 0.0


def check_options(alpha: float, critical: str) -> None:
    """Refuse an alpha that is no probability, and an unknown criterion."""
    if not 0 < alpha < 1:
        raise InputError(f"alpha: {alpha} given, above 0 and below 1 accepted")
    if critical not in ("formula", "exact", "permuted"):
        raise InputError(f"critical: {critical!r} given, formula, exact or permuted accepted")


def _check_generator(
    critical: Critical, items: int, observers: int, generator: np.random.Generator | None
) -> None:
    exact = critical == "exact" and exact_is_feasible(items, observers)
    if critical != "formula" and not exact and generator is None:
        raise InputError(f"generator: needed for critical={critical!r}, a numpy Generator accepted")


def _letter(number: int) -> str:
    return string.ascii_letters[number % len(string.ascii_letters)]
