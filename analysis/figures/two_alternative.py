"""The figures of a study of pairs."""

import matplotlib as mpl
from matplotlib.figure import Figure

from analysis.figures.paired_scale import paired_scale_figure
from analysis.figures.preference import preferences_figure
from analysis.figures.score_groups import score_groups_figure
from analysis.figures.style import SETTINGS
from analysis.report.tasks.two_alternative import TwoAlternativeAnalysis

MOST_DRAWN = 12  # pairs in one figure; the table has all


@mpl.rc_context(SETTINGS)
def two_alternative_figures(analysis: TwoAlternativeAnalysis) -> dict[str, Figure]:
    """Return every figure that a study's answers allow, by name."""
    figures = {}
    if analysis.overall.scale is not None:
        figures["scale"] = paired_scale_figure(analysis.overall.scale, simulated=analysis.simulated)
    groups = {
        group.label: group.results.groups
        for group in analysis.groups
        if group.results.groups is not None
    }
    if groups:
        figures["score-groups"] = score_groups_figure(groups, simulated=analysis.simulated)
    if len(analysis.preferences.results) <= MOST_DRAWN:
        figures["preferences"] = preferences_figure(
            analysis.preferences, simulated=analysis.simulated
        )
    return figures
