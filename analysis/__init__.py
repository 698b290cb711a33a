"""From answers to a verdict: statistics, figures and the report."""

from analysis.chance import (
    ChanceLimit,
    largest_level_at_chance,
    largest_level_at_chance_by_participant,
)
from analysis.estimates import Estimate
from analysis.participant_interval import participant_interval
from analysis.thresholds import ThresholdFit, fit_threshold

__all__ = [
    "ChanceLimit",
    "Estimate",
    "ThresholdFit",
    "fit_threshold",
    "largest_level_at_chance",
    "largest_level_at_chance_by_participant",
    "participant_interval",
]
