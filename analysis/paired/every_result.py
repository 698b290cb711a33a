"""A paired comparison from its table of answers: every result that the answers allow.

The methods have a module each, which can be used alone on arrays: consistency, agreement,
score_groups, scaling, transitivity.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.paired.agreement import Agreement, agreement_over
from analysis.paired.consistency import GroupConsistency, group_consistency
from analysis.paired.item_permutations import enough_permutations
from analysis.paired.pair_data import Tournaments, complete_tournaments, pair_data
from analysis.paired.scale_fit import ModelName
from analysis.paired.scaling import PairScale, check_settings, scale_pairs
from analysis.paired.score_groups import ALPHA, Critical, ScoreGroups, check_options, score_groups
from analysis.paired.transitivity import Transitivity, transitivity

Result = TypeVar("Result")


@dataclass(frozen=True)
class PairedAnalysis:
    """Everything about one set of items.

    Attributes
    ----------
    items, participants
        Their names.
    answers, unanswered
        How many rows have an answer, and how many have none.
    incomplete
        Participants who miss a pair, repeated or tied one: they are in `scale` and `transitivity`
        only.
    consistency, agreement, groups, scale, transitivity
        None where the answers do not allow it.
    left_out
        Why, by the name of the result.
    """

    items: tuple[str, ...]
    participants: tuple[str, ...]
    answers: int
    unanswered: int
    incomplete: tuple[str, ...]
    consistency: GroupConsistency | None
    agreement: Agreement | None
    groups: ScoreGroups | None
    scale: PairScale | None
    transitivity: Transitivity | None
    left_out: dict[str, str]


def analyse_pairs(
    table: pd.DataFrame,
    generator: np.random.Generator,
    *,
    within: Sequence[str] = (),
    items: Sequence[str] | None = None,
    tie: str | None = None,
    alpha: float = ALPHA,
    critical: Critical = "formula",
    model: ModelName = "bradley-terry",
    prior: float = 0.0,
) -> PairedAnalysis:
    """Return consistency, agreement, score groups, scale and transitivity of a table of answers.

    Parameters
    ----------
    table
        One row an answer: `participant`, `item_a`, `item_b`, `chosen` and the columns `within`.
    generator
        Of every random draw.
    within
        The columns that split a participant's answers into sets of all pairs, such as ``["angle"]``
        or ``["repetition"]``. Scores and scale pool them; a participant's sets stay together.
    items, tie
        As in `analysis.paired.pair_data.pair_data`.
    alpha, critical
        As in `analysis.score_groups`.
    model, prior
        As in `analysis.scale_pairs`.

    Raises
    ------
    InputError
        If the table or an option is impossible. What only one result cannot do with is no error:
        that result is left out and `left_out` says why.
    """
    check_settings(model, prior)
    check_options(alpha, critical)
    data = pair_data(table, items=items, tie=tie)
    conditions, incomplete = complete_tournaments(table, within, items=data.items, tie=tie)
    people = [name for name in data.participants if name not in incomplete] * len(conditions)
    for_agreement, for_groups, for_scale = generator.spawn(3)
    left_out: dict[str, str] = {}

    def attempt(name: str, compute: Callable[[], Result]) -> Result | None:
        try:
            return compute()
        except InputError as error:
            left_out[name] = str(error)
            return None

    def complete() -> list[Tournaments]:
        if not people:
            raise InputError("table: no participant compared every pair once without a tie")
        return conditions

    permutations = enough_permutations(np.concatenate(conditions))

    def groups() -> ScoreGroups:
        return score_groups(
            np.concatenate(complete()),
            alpha,
            permutations=permutations,
            items=data.items,
            observers=people,
            critical=critical,
            generator=for_groups,
        )

    def scale() -> PairScale:
        return scale_pairs(
            data.wins, model=model, items=data.items, prior=prior, generator=for_scale
        )

    return PairedAnalysis(
        items=data.items,
        participants=data.participants,
        answers=len(table) - data.unanswered,
        unanswered=data.unanswered,
        incomplete=incomplete,
        consistency=attempt(
            "consistency", lambda: group_consistency(np.concatenate(complete()), people)
        ),
        agreement=attempt(
            "agreement", lambda: agreement_over(complete(), for_agreement, permutations)
        ),
        groups=attempt("groups", groups),
        scale=attempt("scale", scale),
        transitivity=attempt("transitivity", lambda: transitivity(data.wins, data.items)),
        left_out=left_out,
    )
