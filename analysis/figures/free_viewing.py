"""The figures of a study of free viewing: looking times, by object, and heat maps."""

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from analysis.figures.gaze import dwell_ratios_figure, heat_map_figure
from analysis.figures.style import (
    CHANCE_COLOUR,
    SETTINGS,
    draw_rows,
    level_label,
    new_figure,
)
from analysis.report.tasks.free_viewing import FreeViewingAnalysis

MOST_MAPS = 6  # in a report; `GazeAnalysis.write` writes all
_HEIGHT_OF_ROW, _HEIGHT_OF_REST = 0.3, 1.35  # inches


@mpl.rc_context(SETTINGS)
def free_viewing_figures(analysis: FreeViewingAnalysis) -> dict[str, Figure]:
    """Return the figures of a report by name; heat maps of some images, from first to last."""
    gaze = analysis.gaze
    figures = {"objects": looked_at_figure(analysis)}
    if gaze.ratios is not None:
        figures["dwell-ratios"] = dwell_ratios_figure(
            {"odd object": gaze.ratios},
            gaze.level,
            level_label(analysis.study),
            simulated=analysis.simulated,
        )
    for name in mapped(analysis):
        heat = gaze.heat_maps[name]
        figures[f"heat-map-{name}"] = heat_map_figure(
            gaze.picture(name), heat, simulated=analysis.simulated
        )
    return figures


def mapped(analysis: FreeViewingAnalysis) -> list[str]:
    """Return the images whose heat maps are drawn: evenly spread over the set's order."""
    names = [one.id for one in analysis.stimuli.stimuli if one.id in analysis.gaze.heat_maps]
    chosen = np.linspace(0, len(names) - 1, min(MOST_MAPS, len(names)))
    return [names[round(place)] for place in chosen]


def looked_at_figure(analysis: FreeViewingAnalysis) -> Figure:
    """Return each object's share of the looking time, where it is the odd one and where not."""
    table = analysis.objects
    names = list(dict.fromkeys(table["object"]))
    height = _HEIGHT_OF_REST + _HEIGHT_OF_ROW * len(names)
    figure, (axes,) = new_figure(1, analysis.simulated, width=5.4, height=height)
    for number, (odd, label) in enumerate(((True, "odd one"), (False, "not odd"))):
        rows = table[table["odd"] == odd]
        places = np.array([names.index(name) for name in rows["object"]]) + 0.16 * (number - 0.5)
        draw_rows(axes, rows, ("share", "low", "high"), places, number, label)
    axes.axvline(
        1 / len(names),
        color=CHANCE_COLOUR,
        linestyle=(0, (4, 3)),
        linewidth=1,
        label="as long as the others",
    )
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.set_xlim(left=0)
    axes.grid(visible=False, axis="y")
    axes.set_xlabel("share of the time on all objects")
    figure.legend(loc="outside lower center", ncols=3)
    return figure
