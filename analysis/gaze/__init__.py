"""Gaze: fixations from raw samples, heat maps, and time on each region."""

from analysis.gaze.looking_times import DwellRatios, dwell_ratios, dwell_times, saccades

__all__ = ["DwellRatios", "dwell_ratios", "dwell_times", "saccades"]
