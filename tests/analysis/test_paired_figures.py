import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from analysis.figures.paired_scale import paired_scale_figure
from analysis.figures.score_groups import score_groups_figure
from analysis.figures.style import SETTINGS, SIMULATED_TEXT, figure_bytes
from analysis.paired.scaling import PairScale, scale_pairs
from analysis.paired.score_groups import ScoreGroups, score_groups
from tests.analysis.published_pairs import TASTE

ITEMS = ["phase symmetry", "photon mapping", "silhouette", "nothing"]


@pytest.fixture(scope="module")
def scale() -> PairScale:
    return scale_pairs(TASTE, items=ITEMS, anchor="silhouette")


@pytest.fixture(scope="module")
def groups() -> ScoreGroups:
    return score_groups([np.triu(np.ones((4, 4), dtype=int), k=1)] * 6, items=ITEMS)


def test_scale_has_the_best_on_top_and_its_anchor_at_zero(scale: PairScale) -> None:
    figure = paired_scale_figure(scale, simulated=False)
    (axes,) = figure.axes
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels == ["phase symmetry", "silhouette", "photon mapping", "nothing"]
    marks = axes.get_lines()[1]
    np.testing.assert_allclose(np.asarray(marks.get_xdata()), np.sort(scale.table["jod"]))
    assert axes.get_xlabel().startswith("JOD above silhouette (1 JOD: 75 %")
    assert axes.get_title(loc="left") == "Bradley-Terry, 95 % intervals over answers"


def test_scale_over_observers_says_so(groups: ScoreGroups) -> None:
    wins = np.stack(
        [np.triu(np.ones((3, 3), dtype=int), k=1)] * 3 + [np.eye(3, dtype=int)[[2, 0, 1]]]
    )
    title = paired_scale_figure(scale_pairs(wins), simulated=False).axes[0].get_title(loc="left")
    assert title == "Bradley-Terry, 95 % intervals over 4 observers"
    assert groups.n == 6


def test_groups_have_a_line_each_over_their_items(groups: ScoreGroups) -> None:
    figure = score_groups_figure({"bull": groups, "skull": groups}, simulated=False)
    (axes,) = figure.axes
    ends = [tuple(np.round(np.asarray(line.get_xdata()), 2)) for line in axes.get_lines()]
    assert ends == [(-0.38, 1.38), (0.62, 2.38), (1.62, 3.38)] * 2
    texts = [text.get_text() for text in axes.texts]
    assert texts.count("18") == 2
    assert {"bull", "skull", "photon\nmapping"} <= set(texts)
    assert figure.get_supxlabel().endswith("Smallest significant difference: 10 (alpha = 0.05).")


def test_groups_name_the_condition_where_needs_differ(groups: ScoreGroups) -> None:
    few = score_groups([np.triu(np.ones((4, 4), dtype=int), k=1)] * 2, items=ITEMS)
    three = score_groups([np.triu(np.ones((4, 4), dtype=int), k=1)] * 3, items=ITEMS)
    legend = score_groups_figure(
        {"all": groups, "three": three, "two": few}, simulated=False
    ).get_supxlabel()
    flat = " ".join(legend.split())
    assert "all: 10 (alpha = 0.05), three: 7 (alpha = 0.05)" in flat
    assert few.critical == 6
    assert "two: 6" in flat


def test_a_difference_out_of_reach_is_under_the_figure() -> None:
    result = score_groups([[0, 1, 1], [0, 0, 1], [0, 0, 0]])
    legend = score_groups_figure({"one": result}, simulated=False).get_supxlabel()
    assert "one: The critical difference cannot be reached" in legend


@pytest.mark.parametrize("simulated", [False, True])
def test_both_bear_the_mark_iff_simulated_and_never_change(
    scale: PairScale, groups: ScoreGroups, *, simulated: bool
) -> None:
    def draw() -> list[Figure]:
        with mpl.rc_context(SETTINGS):
            return [
                paired_scale_figure(scale, simulated=simulated),
                score_groups_figure({"bull": groups}, simulated=simulated),
            ]

    for one, other in zip(draw(), draw(), strict=True):
        assert one.get_suptitle() == (SIMULATED_TEXT if simulated else "")
        assert figure_bytes(one, "svg") == figure_bytes(other, "svg")
