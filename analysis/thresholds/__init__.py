"""Thresholds: fitted, compared, over participants, and the largest level at chance."""

from analysis.thresholds.bayesian_fit import ThresholdFit, fit_threshold

__all__ = ["ThresholdFit", "fit_threshold"]
