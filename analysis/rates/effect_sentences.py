"""Effects of factors and differences of thresholds in plain sentences."""

import math
from collections.abc import Mapping, Sequence

import pandas as pd

from analysis.naming import p_text
from analysis.rates.effects import TIME, Effects
from analysis.thresholds.condition_differences import ConditionDifferences

_ALPHA = 0.05
_NOTHING_FOUND = "No difference can be told; that does not show there is none."


def effect_sentences(
    effects: Effects, names: Mapping[str, str] | None = None, units: Mapping[str, str] | None = None
) -> list[str]:
    """Return what each factor does, and what could not be told.

    Parameters
    ----------
    effects
        As from `analysis.hit_effects` or `analysis.time_effects`.
    names
        Factors in words, such as `divergence` for `level`; else underscores become spaces.
    units
        Of numeric factors, such as `deg`.

    Returns
    -------
    list
        Such as `Hit rate by artistic background: yes against no +15.2 percentage points [8.1,
        22.3], odds times 1.92 [1.41, 2.62]; F(1, 22.4) = 14.10, p = 0.001, 0.004 by Holm's
        correction for 6 factors.`
    """
    words = names or {}
    sentences = []
    for test in effects.tests.to_dict("records"):
        factor = str(test["factor"])
        rows = effects.contrasts[effects.contrasts["factor"] == factor]
        unit = (units or {}).get(factor, "")
        contrasts = "; ".join(_contrast(effects, row, unit) for _, row in rows.iterrows())
        name = words.get(factor, factor.replace("_", " "))
        sentences.append(
            f"{effects.quantity.capitalize()} by {name}: {contrasts};"
            f" {_test(test, effects.family.size)}"
        )
    for factor, why in effects.left_out.items():
        name = words.get(factor, factor.replace("_", " "))
        sentences.append(f"{effects.quantity.capitalize()} by {name}: {why}.")
    return sentences


def dependence_sentence(effects: Effects, names: Mapping[str, str] | None = None) -> str:
    """Return in one sentence which factors matter by Holm's correction, and which cannot be told.

    Parameters
    ----------
    effects, names
        As in `effect_sentences`.

    Returns
    -------
    str
        Such as `Hit rate depends on divergence and placement (p < 0.05 by Holm's correction for 3
        factors); no effect of material is found, which does not show that there is none.`
    """
    words = names or {}
    found: list[str] = []
    not_found: list[str] = []
    tests = effects.tests.dropna(subset="p_holm")
    for factor, p_holm in zip(tests["factor"], tests["p_holm"], strict=True):
        told = found if p_holm < _ALPHA else not_found
        told.append(words.get(str(factor), str(factor).replace("_", " ")))
    how = f"(p < {_ALPHA:g} by Holm's correction for {effects.family.size} factors)"
    quantity = effects.quantity.capitalize()
    if tests.empty:
        return f"{quantity}: too few participants to test what it depends on."
    depends = f"{quantity} depends on {_listed(found)} {how}" if found else ""
    if not not_found:
        return f"{depends}."
    none = f"no effect of {_listed(not_found)} is found, which does not show that there is none."
    return f"{depends}; {none}" if found else f"{quantity}: {none}"


def _listed(words: Sequence[str]) -> str:
    *most, last = words
    return f"{', '.join(most)} and {last}" if most else last


def difference_sentences(found: ConditionDifferences, unit: str = "") -> list[str]:
    """Return how far the thresholds of each two values of a condition differ, and what is left out.

    Parameters
    ----------
    found
        As from `analysis.condition_differences`.
    unit
        Of the levels.

    Returns
    -------
    list
        Such as `Threshold by placement: front - back +6.3 deg [2.9, 9.6], p < 0.001, 0.002 by
        Holm's correction for 3 pairs.`
    """
    start = f"Threshold by {found.condition.replace('_', ' ')}:"
    sentences = []
    for row in found.to_frame().to_dict("records"):
        value = float(row["difference"])
        if math.isnan(value):
            text = "a threshold lies beyond the levels tested, so that there is no difference"
            sentences.append(f"{start} {row['pair']}: {text}.")
            continue
        low, high = (_end(float(row[f"difference_{end}"])) for end in ("low", "high"))
        text = f"{value:+.1f} {unit}".rstrip() + f" [{low}, {high}]"
        sentences.append(
            f"{start} {row['pair']} {text},"
            f" {_p_values(float(row['p_value']), float(row['p_holm']), found.family.size, 'pairs')}"
        )
    return sentences + [f"{start} {pair}: {why}." for pair, why in found.left_out.items()]


def _end(value: float) -> str:
    return f"{value:.1f}" if math.isfinite(value) else "no bound"


def _p_values(raw: float, corrected: float, size: int, what: str) -> str:
    text = f"p {p_text(raw)}"
    if size > 1:
        text += f", {p_text(corrected).removeprefix('= ')} by Holm's correction for {size} {what}"
    return text + ("." if corrected < _ALPHA else f". {_NOTHING_FOUND}")


def _contrast(effects: Effects, row: pd.Series, unit: str) -> str:
    per = str(row["contrast"])
    label = f"{per} {unit}" if unit and per.startswith("per ") else per
    ratio = f"{row['ratio']:.2f}{_interval(row, 'ratio', 1, '.2f')}"
    if effects.quantity == TIME:
        return f"{label} times {ratio}"
    points = f"{100 * row['difference']:+.1f} percentage points"
    return f"{label} {points}{_interval(row, 'difference', 100, '.1f')}, odds times {ratio}"


def _interval(row: pd.Series, name: str, scale: float, form: str) -> str:
    low, high = scale * float(row[f"{name}_low"]), scale * float(row[f"{name}_high"])
    return "" if math.isnan(low) else f" [{low:{form}}, {high:{form}}]"


def _test(test: Mapping[object, object], size: int) -> str:
    statistic, df, denominator, raw, corrected = (
        float(str(test[name])) for name in ("F", "df", "df_denominator", "p_value", "p_holm")
    )
    if math.isnan(raw):
        return "too few participants for a test."
    text = f"F({df:.0f}, {denominator:.1f}) = {statistic:.2f}"
    return f"{text}, {_p_values(raw, corrected, size, 'factors')}"
