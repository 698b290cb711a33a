"""The results in plain sentences; what programs answered is never told of people."""

import math

from analysis.estimates import Estimate
from analysis.naming import level_name
from analysis.rates.effect_sentences import dependence_sentence, difference_sentences
from analysis.report.tasks.odd_one_out import OddOneOutAnalysis
from analysis.thresholds.by_condition import GroupThreshold
from analysis.thresholds.chance import ChanceLimit


def verdict(analysis: OddOneOutAnalysis) -> list[str]:
    """Return what a study found, a sentence or two for each result.

    Parameters
    ----------
    analysis
        Of people's answers or of simulated ones: the sentences say which.
    """
    who = "Simulated observers, not people," if analysis.simulated else "People"
    unit = analysis.study.stimuli.level_unit
    name = level_name(analysis.study)
    sentences = [_mid_point(who, name, unit, analysis.overall)]
    for condition in analysis.study.stimuli.conditions:
        groups = [g for g in analysis.thresholds if tuple(g.conditions) == (condition,)]
        values = "; ".join(f"{g.label} {in_levels(g.fit.threshold, unit)}" for g in groups)
        sentences.append(f"By {condition} that mid-point is: {values}.")
    for each in analysis.differences:
        sentences += difference_sentences(each, unit)
    if analysis.overall.at_chance is not None:
        sentences.append(_chance(analysis.overall.at_chance, unit))
    sentences += [
        dependence_sentence(effects, {"level": name})
        for effects in (analysis.hit_effects, analysis.time_effects)
        if effects is not None
    ]
    if analysis.salience is not None:
        choices = analysis.salience.choices
        first = choices.loc[choices["share"].iloc[: len(analysis.stimuli.objects)].argmax()]
        sentences.append(
            f"Where no object differs, object {first['object']} is chosen most often:"
            f" {100 * first['share']:.1f} % of the answers, 95 % interval"
            f" {100 * first['low']:.1f} to {100 * first['high']:.1f} %;"
            f" {100 * analysis.salience.chance:.1f} % if all objects were alike."
        )
    if analysis.times is not None:
        sentences.append(f"The median answer took {analysis.times.median_s:.1f} s.")
    return sentences


def in_levels(estimate: Estimate, unit: str) -> str:
    """Return an estimate with its interval; ends that the levels do not bound are named so.

    >>> in_levels(Estimate(14.1, -math.inf, 21.1), "deg")
    '14.1 deg [below the levels tested, 21.1]'
    """
    if not math.isfinite(estimate.value):
        return f"{'above' if estimate.value > 0 else 'below'} the levels tested"
    low = f"{estimate.low:.1f}" if math.isfinite(estimate.low) else "below the levels tested"
    high = f"{estimate.high:.1f}" if math.isfinite(estimate.high) else "above the levels tested"
    return f"{estimate.value:.1f} {unit}".rstrip() + f" [{low}, {high}]"


def _mid_point(who: str, name: str, unit: str, group: GroupThreshold) -> str:
    fit = group.fit
    if fit.reached != "within":
        side = "largest" if fit.reached == "above" else "smallest"
        edge = max(fit.levels) if fit.reached == "above" else min(fit.levels)
        return (
            f"{who} reach no mid-point within the levels tested: it lies {fit.reached} the {side}"
            f" {name}, {edge:g} {unit}."
        )
    return (
        f"{who} notice a {name} of {in_levels(fit.threshold, unit)} half of the time beyond"
        f" chance: there {100 * fit.correct_at_threshold:.0f} % of the answers are right, where"
        f" guessing gives {100 * fit.guess_rate:.1f} %.{_over_participants(group, unit)}"
    )


def _over_participants(group: GroupThreshold, unit: str) -> str:
    wide = group.over_participants
    if not math.isfinite(wide.low):
        return ""
    return (
        f" The interval that allows for differences between participants is {wide.low:.1f} to"
        f" {wide.high:.1f} {unit}."
    )


def _chance(limit: ChanceLimit, unit: str) -> str:
    how = f"{limit.test} test, one-sided, alpha {limit.alpha:g}, {limit.n} answers in all"
    if math.isnan(limit.level):
        return (
            f"Even at the smallest level tested, {limit.levels[0]:g} {unit}, answers are better"
            f" than guessing ({how})."
        )
    rest = (
        " That is the largest level tested, so the limit may lie higher."
        if limit.at_largest_level
        else ""
    )
    return (
        f"The largest level whose answers cannot be told from guessing is {limit.level:g} {unit}"
        f" ({how}).{rest} With more answers a smaller level can be told: this is not a mid-point"
        " and must not be compared with one."
    )
