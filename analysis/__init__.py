"""From answers to a verdict: statistics, figures and the report.

The names below are imported when they are first used: the statistics libraries take seconds to
load, and the command line must not wait for them.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analysis.chance import (
        ChanceLimit,
        largest_level_at_chance,
        largest_level_at_chance_by_participant,
    )
    from analysis.estimates import Estimate
    from analysis.over_participants import participant_interval
    from analysis.report import analyse
    from analysis.thresholds import ThresholdFit, fit_threshold
    from analysis.trials import trial_table

__all__ = [
    "ChanceLimit",
    "Estimate",
    "ThresholdFit",
    "analyse",
    "fit_threshold",
    "largest_level_at_chance",
    "largest_level_at_chance_by_participant",
    "participant_interval",
    "trial_table",
]

_HOMES = {
    "ChanceLimit": "chance",
    "Estimate": "estimates",
    "ThresholdFit": "thresholds",
    "analyse": "report",
    "fit_threshold": "thresholds",
    "largest_level_at_chance": "chance",
    "largest_level_at_chance_by_participant": "chance",
    "participant_interval": "over_participants",
    "trial_table": "trials",
}


if not TYPE_CHECKING:  # a type checker would take every misspelt name for an object

    def __getattr__(name: str) -> object:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
