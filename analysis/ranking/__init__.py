"""Rankings: mean ranks, concordance, groups of items and the Plackett-Luce scale."""

from analysis.ranking.mean_ranks import RankSummary, rank_summary

__all__ = ["RankSummary", "rank_summary"]
