"""Gaze from its files to the report: what viewers were made to look at is found again."""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.report.page import Images, analyse, differences
from experiments.gaze import GAZE, Place, load_gaze, write_gaze
from experiments.planning.trials import Trial
from experiments.responses import Event, Session
from experiments.simulated.viewers import Viewer, simulate_viewing
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.comparison_studies import viewing_study
from tests.drawn_set import draw_set

ATTRACTION = 3.0


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Four images, two of them with an odd object."""
    return draw_set(tmp_path_factory.mktemp("viewed"), levels_deg=(0, 90), placements=("front",))


@pytest.fixture(scope="module")
def viewed(study: Study, few: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a store and the gaze of six viewers."""
    folder = tmp_path_factory.mktemp("gaze")
    viewing, viewer = viewing_study(study, 10), Viewer(ATTRACTION, pixels_per_degree=20)
    generator = np.random.default_rng(2)
    with Store.open(folder / "rows.sqlite") as store:
        simulate_viewing(viewing, few, store, viewer, 6, generator, folder / "lab")
    return folder


def test_the_odd_object_is_looked_at_as_much_longer_as_it_attracts(
    few: StimulusSet, viewed: Path, tmp_path: Path
) -> None:
    page = analyse(viewed / "rows.sqlite", tmp_path, stimuli=few.folder).read_text("utf-8")
    assert "SIMULATED" in page
    results = json.loads((tmp_path / "results.json").read_bytes())
    (row,) = results["ratios"]["table"]
    assert row["divergence_deg"] == 90
    assert row["ratio"] == pytest.approx(ATTRACTION, rel=0.3)
    objects = pd.read_csv(tmp_path / "tables" / "objects.csv").groupby("odd")["share"].mean()
    assert objects[True] == pytest.approx(ATTRACTION / (ATTRACTION + 7), abs=0.08)
    assert results["valid_share"] == pytest.approx(0.99, abs=0.01)
    assert len(list((tmp_path / "figures").glob("heat-map-*.svg"))) == 4
    assert differences(viewed / "rows.sqlite", tmp_path, Images(few.folder)) == []


def test_what_a_report_of_gaze_lacks_is_one_line(
    drawn_set: StimulusSet, viewed: Path, tmp_path: Path
) -> None:
    store = viewed / "rows.sqlite"
    with pytest.raises(InputError, match="stimuli: none given; the report of free-viewing"):
        analyse(store, tmp_path)
    with pytest.raises(InputError, match="another set than the one that was shown"):
        analyse(store, tmp_path, stimuli=drawn_set.folder)
    with Store.open(store, must_exist=True) as opened:
        events = opened.events()
    moved = viewed.parent / "moved"
    (viewed / "lab").rename(moved)
    try:
        with pytest.raises(InputError, match="is missing; --gaze FOLDER tells"):
            load_gaze(events)
        gaze, _ = load_gaze(events, [moved])
        assert gaze.groupby(["session", "trial_index"]).ngroups == 6 * 4
        one = next(moved.rglob("*.parquet"))
        kept = one.read_bytes()
        one.write_bytes(kept + b" ")
        with pytest.raises(InputError, match="altered since it was recorded"):
            load_gaze(events, [moved])
        one.write_bytes(kept)
    finally:
        moved.rename(viewed / "lab")


def written(folder: Path, session: Session, places: Sequence[Place]) -> pd.DataFrame:
    """What is read of four samples with images in these places."""
    samples = pd.DataFrame(
        {
            "time_s": [0.0, 0.01, 0.02, 0.03],
            "x_window_px": [10.0, 110.0, 250.0, 400.0],
            "y_window_px": [60.0, 60.0, 90.0, 90.0],
            "valid": [True, True, True, False],
        }
    )
    trial = Trial(3, "main", tuple(place.stimulus for place in places))
    detail = write_gaze(folder, session, trial, samples, places, degree_px=40)
    assert (detail["samples"], detail["valid_share"]) == (4, 0.75)
    gaze, degrees = load_gaze([Event(session.id, GAZE, detail, "")])
    assert degrees == {(session.id, 3): 40 / places[0].scale}
    return gaze


def test_samples_are_on_the_image_that_is_looked_at(viewed: Path, tmp_path: Path) -> None:
    with Store.open(viewed / "rows.sqlite", must_exist=True) as store:
        session = store.sessions()[0]
    left, right = Place("a", 100, 50, 100, 80, 0.5), Place("b", 240, 50, 100, 80, 0.5)
    one = written(tmp_path, session, [left])
    assert one["stimulus"].tolist() == ["a"] * 4  # beside it, too
    assert one["x_px"].tolist() == [-180, 20, 300, 600]
    assert one["y_px"].tolist() == [20, 20, 80, 80]
    both = written(tmp_path, session, [left, right])
    assert [name if isinstance(name, str) else None for name in both["stimulus"]] == [
        *(None, "a", "b", None)
    ]
    np.testing.assert_array_equal(both["x_px"], [np.nan, 20, 20, np.nan])


def test_other_tasks_and_impossible_viewers_are_refused(
    study: Study, few: StimulusSet, store: Store, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match="task: odd-one-out given, free-viewing accepted"):
        simulate_viewing(study, few, store, Viewer(), 1, np.random.default_rng(1), tmp_path)
    for name, value in (("attraction", -1.0), ("lost_share", 2.0), ("rate_hz", 0.0)):
        with pytest.raises(InputError, match=f"{name}: {value} given"):
            Viewer(**{name: value})
