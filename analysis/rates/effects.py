"""What right answers and times depend on: the images' factors and the participants' own."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.special import expit

from algorithms.errors import InputError
from analysis.estimates import Estimate, software_version
from analysis.multiplicity import Family, family
from analysis.rates.clustered_regression import (
    METHOD,
    ClusteredRegression,
    Floats,
    Kind,
    clustered_regression,
)
from analysis.rates.factors import Design, Factor, check_factors, design_of, varies_within

HIT_RATE, TIME = "hit rate", "time per answer"


@dataclass(frozen=True)
class Effects:
    """The effect of each factor, all others held equal.

    Attributes
    ----------
    quantity
        Of what: `hit rate`, `time per answer`, or what `odds_effects` was told.
    tests
        One row a factor: `factor`, `varies` (`within` or `between` participants), `F`, `df`,
        `df_denominator`, `p_value`, `p_holm`, `participants` and `answers` that tell of it.
    contrasts
        One row for each value against the factor's reference, or for a step up of a numeric one:
        `factor`, `contrast` (in words), `ratio` (of odds or of times), `difference` (of rates;
        not for times), each with `_low` and `_high`, and `df` of their t. Intervals are of
        single contrasts.
    family
        The tests of all factors, with Holm's correction.
    left_out
        By factor: why it, or some participants, are not in the results.
    participants, n
        How many gave how many answers.
    method, version
        How, and by which Trompe.
    """

    quantity: str
    tests: pd.DataFrame
    contrasts: pd.DataFrame
    family: Family
    left_out: Mapping[str, str]
    participants: int
    n: int
    method: str
    version: str

    def to_frame(self) -> pd.DataFrame:
        """Return the contrasts, each with the test of its factor."""
        return self.contrasts.merge(self.tests.drop(columns=["df"]), on="factor", how="left")


def hit_effects(table: pd.DataFrame, factors: Sequence[str]) -> Effects:
    """Return how the hit rate depends on factors.

    Parameters
    ----------
    table
        As from `analysis.trial_table`, with the participants' own factors joined where they count
        (`analysis.answers.participants.join_demographics`); controls and trials without an answer
        do not count.
    factors
        Columns of the table. Numbers are linear in the logarithm of the odds; anything else is a
        category, the first (of a pandas categorical) or smallest being the reference.

    Raises
    ------
    InputError
        If nothing is scored, all answers are alike, a factor is unknown, there are fewer than two
        participants, or no factor can be estimated.

    Notes
    -----
    Logistic regression with main effects as a generalised estimating equation over participants:
    see `analysis.clustered_regression`. Independence is the working correlation because an
    exchangeable one, which weighs rare errors at large levels heavily, can fail to converge; the
    covariance is robust to either. The difference of hit rates is the mean over the answers of
    what the model expects if all had the one value or all the other.
    """
    _check_columns(table, ("participant", "correct"))
    scored = table[table["correct"].notna()]
    if scored.empty:
        raise InputError("table: no answered trial that has a right answer")
    return odds_effects(scored, "correct", factors, HIT_RATE)


def odds_effects(
    table: pd.DataFrame, response: str, factors: Sequence[str], quantity: str
) -> Effects:
    """Return how the rate of anything that is true or false of an answer depends on factors.

    Parameters
    ----------
    table
        One row an answer, with `participant`, the factors and the response.
    response
        A column of true and false, none of them missing.
    factors
        As in `hit_effects`.
    quantity
        What the rate is of, in words.

    Raises
    ------
    InputError
        As `hit_effects`.
    """
    _check_columns(table, ("participant", response))
    true = table[response].astype(float)
    if true.nunique() < 2:
        raise InputError(f"table: all {len(true)} answers are alike in {response}: no effect shows")
    return _effects(quantity, table.assign(**{response: true}), factors, response, "binomial")


def time_effects(table: pd.DataFrame, factors: Sequence[str]) -> Effects:
    """Return how the time per answer depends on factors.

    Parameters
    ----------
    table, factors
        As in `hit_effects`; controls count too.

    Raises
    ------
    InputError
        As `hit_effects`, and if no answer has a time.

    Notes
    -----
    Linear regression of the time's logarithm, otherwise as `hit_effects`: effects are ratios of
    geometric means.
    """
    _check_columns(table, ("participant", "answer", "reaction_time_s"))
    timed = table[table["answer"].notna() & table["reaction_time_s"].notna()]
    if timed.empty:
        raise InputError("table: no answer with a time")
    if (timed["reaction_time_s"] <= 0).any():
        raise InputError("reaction_time_s: 0 or less given, more than 0 accepted")
    logarithms = timed["reaction_time_s"].astype(float).map(np.log)
    if logarithms.nunique() < 2:
        raise InputError(f"table: all {len(timed)} answers took equally long: no effect shows")
    return _effects(TIME, timed.assign(log_time=logarithms), factors, "log_time", "normal")


def _check_columns(table: pd.DataFrame, names: Sequence[str]) -> None:
    for name in names:
        if name not in table.columns:
            raise InputError(f"table: the column {name} is missing")


def _effects(
    quantity: str, rows: pd.DataFrame, names: Sequence[str], response: str, kind: Kind
) -> Effects:
    fits = _fits(rows, names, response, kind)
    tests = pd.DataFrame([_test(*one) for one in fits.found])
    p_values = dict(zip(tests["factor"], tests["p_value"], strict=True))
    together = family(f"{quantity} by factor", p_values)
    contrasts = [
        _contrast(factor, column, design, fit, kind)
        for factor, design, fit in fits.found
        for column in factor.columns
    ]
    return Effects(
        quantity,
        tests.assign(p_holm=together.table["p_holm"]),
        pd.DataFrame(contrasts),
        together,
        fits.left_out,
        participants=int(tests["participants"].max()),
        n=int(tests["answers"].max()),
        method=f"{'logistic' if kind == 'binomial' else 'log-linear'} regression, {METHOD}",
        version=software_version(),
    )


@dataclass(frozen=True, eq=False)
class _Fits:
    """Each factor with the regression that tells of it."""

    found: list[tuple[Factor, Design, ClusteredRegression]]
    left_out: dict[str, str]


def _fits(rows: pd.DataFrame, names: Sequence[str], response: str, kind: Kind) -> _Fits:
    """Fit what varies within participants to all of them, the rest to those who are known.

    What participants are is the same for all answers of one, so that it takes nothing from the
    effects within; but it can be unknown, and then only the effects between must do without them.
    """
    check_factors(rows, names)
    within = [name for name in names if varies_within(rows, name)]
    between = [name for name in names if name not in within]
    parts = [(part, told) for part, told in ((within, within), (names, between)) if told]
    fits = _Fits([], {})
    for factors, told in parts:
        try:
            design = design_of(rows, factors, response, kind == "binomial")
            answers = design.rows[response].to_numpy(float)
            fit = clustered_regression(design.matrix, answers, design.cluster, kind)
        except InputError as error:
            if len(parts) == 1:
                raise
            fits.left_out.update(dict.fromkeys(told, str(error)))
            continue
        fits.found.extend((one, design, fit) for one in design.factors if one.name in told)
        fits.left_out.update(
            {name: design.left_out[name] for name in told if name in design.left_out}
        )
    if not fits.found:
        raise InputError(f"factors: {'; '.join(sorted(set(fits.left_out.values())))}")
    order = list(names)
    fits.found.sort(key=lambda one: order.index(one[0].name))
    return fits


def _test(factor: Factor, design: Design, fit: ClusteredRegression) -> dict[str, object]:
    found = fit.test(np.eye(len(fit.coefficients))[list(factor.columns)])
    return {
        "factor": factor.name,
        "varies": "within" if factor.within else "between",
        "F": found.statistic,
        "df": found.df,
        "df_denominator": found.df_denominator,
        "p_value": found.p_value,
        "participants": fit.clusters,
        "answers": len(design.rows),
    }


def _contrast(
    factor: Factor, column: int, design: Design, fit: ClusteredRegression, kind: Kind
) -> dict[str, object]:
    if factor.numeric:
        low, high = (float(str(end)) for end in factor.kinds)
        size, contrast = factor.step / (high - low), f"per {factor.step:g}"
    else:
        value = factor.kinds[column - factor.first + 1]
        size, contrast = 1.0, f"{value} against {factor.kinds[0]}"
    slopes = size * np.eye(len(fit.coefficients))[column]
    logarithm, df = fit.estimate(float(slopes @ fit.coefficients), slopes)
    ratio = Estimate(*(float(np.exp(end)) for end in vars(logarithm).values()))
    row: dict[str, object] = {"factor": factor.name, "contrast": contrast}
    row |= ratio.columns("ratio")
    if kind == "binomial":
        row |= _difference(factor, slopes, design, fit).columns("difference")
    return row | {"df": df}


def _difference(
    factor: Factor, change: Floats, design: Design, fit: ClusteredRegression
) -> Estimate:
    """Return the mean difference of hit rates that a change of a factor's columns makes.

    From the reference for a category, from where each answer is for a number.
    """
    before = design.matrix.copy()
    if not factor.numeric:
        before[:, list(factor.columns)] = 0.0
    log_odds = before @ fit.coefficients
    lower, higher = expit(log_odds), expit(log_odds + change @ fit.coefficients)
    slopes = (higher * (1 - higher) - lower * (1 - lower)) @ before / len(before)
    slopes += float(np.mean(higher * (1 - higher))) * change
    found, _ = fit.estimate(float(np.mean(higher - lower)), slopes)
    return replace(found, low=max(found.low, -1.0), high=min(found.high, 1.0))
