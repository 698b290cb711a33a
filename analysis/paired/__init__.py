"""Paired comparison: consistency, agreement, score groups, scale and transitivity."""

from analysis.paired.every_result import PairedAnalysis, analyse_pairs

__all__ = ["PairedAnalysis", "analyse_pairs"]
