"""Figures of rankings, preferences, realism and gaze."""

from collections.abc import Callable

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from algorithms.errors import InputError
from analysis.figures.gaze import draw_heat_map, dwell_ratios_figure, heat_map_figure
from analysis.figures.preference import preferences_figure
from analysis.figures.ranking import mean_ranks_figure, worths_figure
from analysis.figures.realism import realism_figure
from analysis.figures.style import SIMULATED_TEXT, figure_bytes, new_figure
from analysis.gaze.heat_map import HeatMap, heat_map
from analysis.gaze.looking_times import DwellRatios, dwell_ratios
from analysis.judgements.preference_pairs import Preferences, preferences
from analysis.judgements.realism import Realism, realism
from analysis.ranking.mean_ranks import RankSummary, rank_summary
from analysis.ranking.plackett_luce import PlackettLuceScale, plackett_luce
from benchmarks.ranking import LOG_WORTHS, draw_rankings

NAMES = ("vase a", "vase b", "vase c", "vase d", "vase e")
RANKS = draw_rankings(LOG_WORTHS, 20, 1, np.random.default_rng(1))[0]
PICTURE = np.linspace(0, 1, 40 * 60 * 3).reshape(40, 60, 3)


def summary() -> RankSummary:
    return rank_summary(RANKS, NAMES)


def scale() -> PlackettLuceScale:
    return plackett_luce(RANKS, NAMES)


def preferred() -> Preferences:
    shares = {"halftone": 0.5, "multitone": 0.9, "colour relighting": 0.65}
    generator = np.random.default_rng(2)
    rows = [
        {"participant": number, "style": style, "chosen": choice}
        for number in range(80)
        for style, share in shares.items()
        for choice in generator.binomial(1, share, size=4)
    ]
    return preferences(pd.DataFrame(rows), ["style"], margin=0.1, names=("ours", "true depth"))


def judged(photographs: bool = True) -> Realism:
    generator = np.random.default_rng(3)
    rows = [
        {"participant": number, "method": method, "answer": answer, "truth": truth}
        for number in range(10)
        for method, rate, truth in (("camera", 0.8, 1), ("ours", 0.7, 0), ("artist", 0.3, 0))
        for answer in generator.binomial(1, rate, size=4)
    ]
    return realism(pd.DataFrame(rows), ["method"], photograph="truth" if photographs else None)


def heat() -> HeatMap:
    table = pd.DataFrame({"x_px": [20.0, 45.0], "y_px": [12.0, 30.0], "duration_s": [0.6, 0.2]})
    return heat_map(table, (40, 60), pixels_per_degree=4)


def ratios() -> DwellRatios:
    generator = np.random.default_rng(4)
    rows = [
        (f"p{person}", "s", level, level, 1, region, generator.gamma(4, 0.3) * factor)
        for person in range(6)
        for level in (10, 20, 30)
        for region, factor in ((1, level / 10), (2, 1.0), (3, 1.0))
    ]
    names = ["participant", "session", "trial_index", "level", "target", "region", "dwell_s"]
    return dwell_ratios(pd.DataFrame(rows, columns=names), ["level"])


FIGURES: dict[str, Callable[[bool], Figure]] = {
    "mean ranks": lambda simulated: mean_ranks_figure(summary(), simulated=simulated),
    "worths": lambda simulated: worths_figure(scale(), simulated=simulated),
    "preferences": lambda simulated: preferences_figure(preferred(), simulated=simulated),
    "realism": lambda simulated: realism_figure(judged(), simulated=simulated),
    "heat map": lambda simulated: heat_map_figure(PICTURE, heat(), simulated=simulated),
    "looking times": lambda simulated: dwell_ratios_figure(
        {"target": ratios()}, "level", "divergence (deg)", simulated=simulated
    ),
}


@pytest.mark.parametrize("name", FIGURES)
def test_figure_bears_the_mark_iff_simulated_and_is_the_same_twice(name: str) -> None:
    first, second = (figure_bytes(FIGURES[name](True), "svg") for _ in range(2))
    assert first == second
    assert b"<dc:date>" not in first
    assert FIGURES[name](True).get_suptitle() == SIMULATED_TEXT
    assert FIGURES[name](False).get_suptitle() == ""
    assert plt.get_fignums() == []


def test_mean_ranks_show_items_best_on_top_and_a_line_for_each_group() -> None:
    found = summary()
    (axes,) = mean_ranks_figure(found, simulated=True).axes
    assert [text.get_text() for text in axes.get_yticklabels()] == found.table["item"].tolist()
    low, high = axes.get_ylim()
    assert low > high
    lines = [line for line in axes.lines if line.get_clip_on() is False]
    assert len(lines) == len(found.comparisons.groups)
    place = {item: row for row, item in enumerate(found.table["item"])}
    for line, group in zip(lines, found.comparisons.groups, strict=True):
        ends = np.asarray(line.get_ydata(), dtype=float)
        assert [round(ends[0] + 0.25), round(ends[1] - 0.25)] == [place[group[0]], place[group[-1]]]


def test_preferences_are_coloured_by_outcome() -> None:
    found = preferred()
    figure = preferences_figure(found, simulated=True)
    (axes,) = figure.axes
    all_bars = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
    bars = {round(bar.get_x() + 0.3): bar for bar in all_bars if bar.get_width() < 1}
    heights = [bars[place].get_height() for place in range(3)]
    assert heights == pytest.approx([result.share.value for result in found.results])
    colours = {result.outcome: bars[k].get_facecolor() for k, result in enumerate(found.results)}
    assert len(colours) == len(set(colours.values())) >= 2
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "margin (10 percentage points)" in labels
    assert "one half" in labels


def test_realism_without_photographs_has_no_sensitivity() -> None:
    assert len(realism_figure(judged(), simulated=True).axes) == 2
    assert len(realism_figure(judged(photographs=False), simulated=True).axes) == 1


def test_heat_map_lies_over_its_picture() -> None:
    (axes, _) = heat_map_figure(PICTURE, heat(), simulated=True).axes
    picture, drawn = axes.images
    share = np.asarray(drawn.get_array())
    assert share.shape == np.asarray(picture.get_array()).shape == (40, 60)
    assert int(share.argmax()) == 12 * 60 + 20
    assert share.max() == 1
    _, (panel,) = new_figure(1, simulated=True)
    with pytest.raises(InputError, match=r"picture: \(20, 60\) pixels given, \(40, 60\) as the"):
        draw_heat_map(panel, PICTURE[:20], heat())


def test_heat_map_takes_bytes_and_grey() -> None:
    for picture in ((255 * PICTURE).astype(np.uint8), PICTURE[..., 0]):
        axes = heat_map_figure(picture, heat(), simulated=True).axes[0]
        grey = np.asarray(axes.images[0].get_array())
        assert 0 <= grey.min() < 0.01
        assert 0.98 < grey.max() <= 1


def test_looking_times_are_on_a_logarithmic_scale_around_one() -> None:
    (axes,) = dwell_ratios_figure({"target": ratios()}, "level", "x", simulated=True).axes
    assert axes.get_yscale() == "log"
    low, high = axes.get_ylim()
    assert low <= 0.5
    assert high >= 2
    assert 1.0 in axes.get_yticks()
