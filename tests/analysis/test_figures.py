from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest

from analysis.figures.style import SIMULATED_TEXT, figure_bytes
from analysis.report.study_analysis import StudyAnalysis, analyse_study
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import responses_of, rows_of, sessions_of

ALWAYS = ["hit-effects", "hit-rates", "psychometric", "salience", "thresholds", "time-effects"]
NAMES = [*ALWAYS, "times"]


@pytest.fixture(scope="module")
def analysis(study: Study, drawn_set: StimulusSet) -> StudyAnalysis:
    rows = rows_of(study, drawn_set, 8, seed=1)
    return analyse_study(study, drawn_set, sessions_of(rows), responses_of(rows), seed=1)


def test_every_figure_bears_the_mark_iff_simulated(analysis: StudyAnalysis) -> None:
    people = replace(analysis, flow=replace(analysis.flow, who="people"))
    assert sorted(analysis.figures()) == sorted([*NAMES, "threshold-differences"])
    for name, figure in analysis.figures().items():
        assert figure.get_suptitle() == SIMULATED_TEXT, name
    for name, figure in people.figures().items():
        assert figure.get_suptitle() == "", name


def test_svg_is_deterministic_and_dateless(analysis: StudyAnalysis) -> None:
    first, second = analysis.figures(), analysis.figures()
    for name in NAMES:
        drawn = figure_bytes(first[name], "svg")
        # Whether or not another format was drawn before.
        figure_bytes(second[name], "png")
        assert figure_bytes(second[name], "svg") == drawn
        assert b"<dc:date>" not in drawn


def test_drawing_leaves_pyplot_alone(analysis: StudyAnalysis) -> None:
    analysis.figures()
    assert plt.get_fignums() == []


def test_psychometric_panels_show_chance_and_the_definition(
    analysis: StudyAnalysis, study: Study
) -> None:
    axes = analysis.figures()["psychometric"].axes
    assert [one.get_title() for one in axes] == ["all", "front", "back", "front-back"]
    for one in axes:
        legend = one.get_legend()
        assert legend is not None
        texts = [text.get_text() for text in legend.get_texts()]
        assert any(text.startswith("mid-point") for text in texts)
        assert "chance (12.5 %)" in texts
        chance = next(line for line in one.lines if line.get_label() == "chance (12.5 %)")
        assert np.unique(np.asarray(chance.get_ydata())) == study.guess_rate


def test_the_two_kinds_of_threshold_have_panels_of_their_own(analysis: StudyAnalysis) -> None:
    titles = [axes.get_title() for axes in analysis.figures()["thresholds"].axes]
    assert titles == ["Mid-point of the function", "Largest level at chance"]


def test_figures_without_conditions(study: Study, drawn_set: StimulusSet) -> None:
    part = study.stimuli.model_copy(update={"conditions": ()})
    plain = study.model_copy(update={"stimuli": part})
    rows = rows_of(plain, drawn_set, 4, seed=1)
    result = analyse_study(plain, drawn_set, sessions_of(rows), responses_of(rows), seed=1)
    figures = result.figures()
    assert sorted(figures) == NAMES
    assert len(figures["hit-rates"].axes) == 1
    for figure in figures.values():
        assert figure_bytes(figure, "png").startswith(b"\x89PNG")
