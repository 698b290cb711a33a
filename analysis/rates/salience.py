"""Salience: which objects are chosen for other reasons than the one asked about."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import RESAMPLES, rate_intervals, sum_by_participant
from analysis.estimates import seed_of, software_version
from analysis.multiplicity import holm
from analysis.rates.effects import odds_effects
from analysis.thresholds.rate_tests import rates_above


@dataclass(frozen=True)
class Salience:
    """Choices on control trials, where no object differs, and what becomes of them.

    Attributes
    ----------
    choices
        One row an object (within each cell of `by`): `object`, `chosen`, `answers`, `share`,
        `low`, `high`; for all control trials together also `p_value` of "no more often than
        others" (one-sided) and `p_holm`, corrected for the number of objects.
    most_salient
        The name of the object that was chosen most on all control trials.
    fall
        How often that object is chosen at each level where it is not the target: one row a
        level and `measure`. `share of answers` falls because others become noticeable;
        `share of misses` is its share among wrong answers. The level of the controls took part in
        choosing the object and is therefore biased upwards.
    trend
        Whether it falls: one row a measure with the odds ratio (`ratio`, `ratio_low`,
        `ratio_high`) for a step of the level (`contrast`), `F`, `df_denominator`, `p_value`,
        `p_holm`, and a `note` where there is none. Levels of the controls are not in it.
    chance
        The share of each object if all were alike.
    n
        The number of control answers.
    resamples, seed, version
        Of the bootstrap, its generator, and Trompe.
    """

    choices: pd.DataFrame
    most_salient: str
    fall: pd.DataFrame
    trend: pd.DataFrame
    chance: float
    n: int
    resamples: int
    seed: int | None
    version: str
    method: str = "share of choices, expanded percentile bootstrap over participants"

    def to_frame(self) -> pd.DataFrame:
        """Return the choices on control trials."""
        return self.choices.copy()


def object_salience(
    table: pd.DataFrame,
    objects: Mapping[int, str],
    by: Sequence[str],
    generator: np.random.Generator,
    resamples: int = RESAMPLES,
) -> Salience:
    """Return how often each object is chosen where there is no right answer.

    Parameters
    ----------
    table
        As from `analysis.trial_table`.
    objects
        The objects' names by label.
    by
        Columns that split the control trials further (such as ``("placement",)``), or none.
    generator, resamples
        As in `analysis.hit_rates`.

    Raises
    ------
    InputError
        If there is no answered control trial.

    Notes
    -----
    Lopez-Moreno 2011, sec. 2.3.1 and figure 2.5. The trend is that of a logistic regression on the
    level (`analysis.odds_effects`).
    """
    answered = table[table["answer"].notna()]
    controls = answered[answered["control"]]
    if controls.empty:
        raise InputError("table: no answered control trial, so nothing is known of salience")
    overall = _choices(controls, objects, (), generator, resamples, chance=1 / len(objects))
    most_salient = str(overall["object"].iloc[int(overall["share"].argmax())])
    label = {name: key for key, name in objects.items()}[most_salient]
    split = _choices(controls, objects, by, generator, resamples) if by else None
    measures = _measures(answered, label)
    return Salience(
        choices=overall if split is None else pd.concat([overall, split], ignore_index=True),
        most_salient=most_salient,
        fall=pd.concat(
            [
                _shares(trials, ["level"], generator, resamples).assign(measure=measure)
                for measure, trials in measures.items()
            ],
            ignore_index=True,
        ),
        trend=_trend(measures),
        chance=1 / len(objects),
        n=len(controls),
        resamples=resamples,
        seed=seed_of(generator),
        version=software_version(),
    )


def _choices(
    controls: pd.DataFrame,
    objects: Mapping[int, str],
    by: Sequence[str],
    generator: np.random.Generator,
    resamples: int,
    chance: float | None = None,
) -> pd.DataFrame:
    asked = pd.concat(
        [
            controls.assign(object=name, chosen=controls["answer"] == label)
            for label, name in objects.items()
        ]
    )
    return _shares(asked, [*by, "object"], generator, resamples, chance)


def _measures(answered: pd.DataFrame, label: int) -> dict[str, pd.DataFrame]:
    """Return the answers among which an object that is not the target was chosen or not."""
    others = answered[answered["target"].fillna(0) != label]
    others = others.assign(chosen=others["answer"] == label)
    missed = others[~others["correct"].fillna(value=False).astype(bool)]
    return {"share of answers": others, "share of misses": missed}


def _trend(measures: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    rows: list[dict[Hashable, object]] = []
    for measure, trials in measures.items():
        try:
            effects = odds_effects(trials[~trials["control"]], "chosen", ["level"], measure)
        except InputError as error:  # too few answers for a trend: the rest stands
            rows.append({"measure": measure, "p_value": np.nan, "note": str(error)})
            continue
        rows.append({"measure": measure, **effects.to_frame().iloc[0].to_dict(), "note": ""})
    table = pd.DataFrame(rows)
    return table.assign(p_holm=holm(table["p_value"].to_numpy()))


def _shares(
    trials: pd.DataFrame,
    by: Sequence[str],
    generator: np.random.Generator,
    resamples: int,
    chance: float | None = None,
) -> pd.DataFrame:
    sums = sum_by_participant(trials, "chosen", by)
    low, high, intervals = rate_intervals(sums, generator, resamples)
    shares = sums.cells.assign(
        chosen=sums.totals.sum(axis=0).astype(int),
        answers=sums.counts.sum(axis=0).astype(int),
        share=sums.means,
        low=low,
        high=high,
        interval=intervals,
    )
    if chance is None:
        return shares
    p_values, tests = rates_above(sums, chance)
    return shares.assign(p_value=p_values, p_holm=holm(p_values), test=tests)
