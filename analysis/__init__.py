"""From answers to a verdict: statistics, figures and the report.

The names below are imported when they are first used: the statistics libraries take seconds to
load, and the command line must not wait for them.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analysis.answers.exclusions import Flow, exclude
    from analysis.answers.trials import trial_table
    from analysis.errors import LightError, light_error
    from analysis.estimates import Estimate, to_json
    from analysis.gaze.fixations import (
        Fixations,
        fixations_by_dispersion,
        fixations_by_velocity,
    )
    from analysis.gaze.heat_map import HeatMap, heat_map
    from analysis.gaze.looking_times import DwellRatios, dwell_ratios, dwell_times, saccades
    from analysis.gaze.over_set import GazeAnalysis, analyse_gaze
    from analysis.gaze.samples import image_coordinates, pixels_per_degree
    from analysis.judgements.detection import Sensitivity, sensitivity
    from analysis.judgements.preference import Preference, preference
    from analysis.judgements.preference_pairs import Preferences, item_preferences, preferences
    from analysis.judgements.realism import Realism, realism
    from analysis.multiplicity import Family, family, holm
    from analysis.paired.agreement import Agreement, agreement, agreement_over
    from analysis.paired.agreement_table import AgreementTable, agreement_table
    from analysis.paired.consistency import (
        Consistency,
        GroupConsistency,
        consistency,
        group_consistency,
    )
    from analysis.paired.every_result import PairedAnalysis, analyse_pairs
    from analysis.paired.scaling import PairScale, scale_pairs
    from analysis.paired.score_groups import ScoreGroups, score_groups
    from analysis.paired.transitivity import Transitivity, transitivity
    from analysis.ranking.comparisons import RankComparisons, compare_ranks
    from analysis.ranking.friedman import Concordance, concordance
    from analysis.ranking.mean_ranks import RankSummary, rank_summary
    from analysis.ranking.plackett_luce import PlackettLuceScale, plackett_luce
    from analysis.rates.effects import Effects, hit_effects, time_effects
    from analysis.rates.hits import HitRates, hit_rates
    from analysis.rates.salience import Salience, object_salience
    from analysis.rates.times import AnswerTimes, answer_times
    from analysis.report.page import analyse
    from analysis.thresholds.bayesian_fit import ThresholdFit, fit_threshold
    from analysis.thresholds.by_condition import GroupThreshold, group_thresholds
    from analysis.thresholds.chance import (
        ChanceLimit,
        largest_level_at_chance,
        largest_level_at_chance_by_participant,
    )
    from analysis.thresholds.condition_differences import (
        ConditionDifferences,
        condition_differences,
    )
    from analysis.thresholds.maximum_likelihood import LikelihoodFits, maximum_likelihood
    from analysis.thresholds.observer_bootstrap import ObserverFit, fit_observers
    from analysis.thresholds.over_participants import participant_interval
    from analysis.thresholds.threshold_difference import (
        ThresholdDifference,
        threshold_difference,
    )

__all__ = [
    "Agreement",
    "AgreementTable",
    "AnswerTimes",
    "ChanceLimit",
    "Concordance",
    "ConditionDifferences",
    "Consistency",
    "DwellRatios",
    "Effects",
    "Estimate",
    "Family",
    "Fixations",
    "Flow",
    "GazeAnalysis",
    "GroupConsistency",
    "GroupThreshold",
    "HeatMap",
    "HitRates",
    "LightError",
    "LikelihoodFits",
    "ObserverFit",
    "PairScale",
    "PairedAnalysis",
    "PlackettLuceScale",
    "Preference",
    "Preferences",
    "RankComparisons",
    "RankSummary",
    "Realism",
    "Salience",
    "ScoreGroups",
    "Sensitivity",
    "ThresholdDifference",
    "ThresholdFit",
    "Transitivity",
    "agreement",
    "agreement_over",
    "agreement_table",
    "analyse",
    "analyse_gaze",
    "analyse_pairs",
    "answer_times",
    "compare_ranks",
    "concordance",
    "condition_differences",
    "consistency",
    "dwell_ratios",
    "dwell_times",
    "exclude",
    "family",
    "fit_observers",
    "fit_threshold",
    "fixations_by_dispersion",
    "fixations_by_velocity",
    "group_consistency",
    "group_thresholds",
    "heat_map",
    "hit_effects",
    "hit_rates",
    "holm",
    "image_coordinates",
    "item_preferences",
    "largest_level_at_chance",
    "largest_level_at_chance_by_participant",
    "light_error",
    "maximum_likelihood",
    "object_salience",
    "participant_interval",
    "pixels_per_degree",
    "plackett_luce",
    "preference",
    "preferences",
    "rank_summary",
    "realism",
    "saccades",
    "scale_pairs",
    "score_groups",
    "sensitivity",
    "threshold_difference",
    "time_effects",
    "to_json",
    "transitivity",
    "trial_table",
]

_NAMES_OF = {
    "answers.exclusions": ("Flow", "exclude"),
    "answers.trials": ("trial_table",),
    "errors": ("LightError", "light_error"),
    "estimates": ("Estimate", "to_json"),
    "gaze.fixations": ("Fixations", "fixations_by_dispersion", "fixations_by_velocity"),
    "gaze.heat_map": ("HeatMap", "heat_map"),
    "gaze.looking_times": ("DwellRatios", "dwell_ratios", "dwell_times", "saccades"),
    "gaze.over_set": ("GazeAnalysis", "analyse_gaze"),
    "gaze.samples": ("image_coordinates", "pixels_per_degree"),
    "judgements.detection": ("Sensitivity", "sensitivity"),
    "judgements.preference": ("Preference", "preference"),
    "judgements.preference_pairs": ("Preferences", "item_preferences", "preferences"),
    "judgements.realism": ("Realism", "realism"),
    "multiplicity": ("Family", "family", "holm"),
    "paired.agreement": ("Agreement", "agreement", "agreement_over"),
    "paired.agreement_table": ("AgreementTable", "agreement_table"),
    "paired.consistency": (
        "Consistency",
        "GroupConsistency",
        "consistency",
        "group_consistency",
    ),
    "paired.every_result": ("PairedAnalysis", "analyse_pairs"),
    "paired.scaling": ("PairScale", "scale_pairs"),
    "paired.score_groups": ("ScoreGroups", "score_groups"),
    "paired.transitivity": ("Transitivity", "transitivity"),
    "ranking.comparisons": ("RankComparisons", "compare_ranks"),
    "ranking.friedman": ("Concordance", "concordance"),
    "ranking.mean_ranks": ("RankSummary", "rank_summary"),
    "ranking.plackett_luce": ("PlackettLuceScale", "plackett_luce"),
    "rates.effects": ("Effects", "hit_effects", "time_effects"),
    "rates.hits": ("HitRates", "hit_rates"),
    "rates.salience": ("Salience", "object_salience"),
    "rates.times": ("AnswerTimes", "answer_times"),
    "report.page": ("analyse",),
    "thresholds.bayesian_fit": ("ThresholdFit", "fit_threshold"),
    "thresholds.by_condition": ("GroupThreshold", "group_thresholds"),
    "thresholds.chance": (
        "ChanceLimit",
        "largest_level_at_chance",
        "largest_level_at_chance_by_participant",
    ),
    "thresholds.condition_differences": ("ConditionDifferences", "condition_differences"),
    "thresholds.maximum_likelihood": ("LikelihoodFits", "maximum_likelihood"),
    "thresholds.observer_bootstrap": ("ObserverFit", "fit_observers"),
    "thresholds.over_participants": ("participant_interval",),
    "thresholds.threshold_difference": ("ThresholdDifference", "threshold_difference"),
}
_HOMES = {name: home for home, names in _NAMES_OF.items() for name in names}


if not TYPE_CHECKING:  # a type checker would take every misspelt name for an object

    def __getattr__(name: str) -> object:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
