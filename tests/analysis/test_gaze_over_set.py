"""Gaze over a set: a known looking time is found again, from raw samples to figures and files."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.gaze.over_set import GazeAnalysis, analyse_gaze
from stimuli.manifest import StimulusSet
from tests.drawn_set import draw_set

PIXELS_PER_DEGREE = 12.0
RATE_HZ = 250
STAY_S, ON_TARGET_S = 0.4, 1.2
CENTRES_PX = [(40 + 80 * column, 45 + 90 * row) for row in range(2) for column in range(4)]


@pytest.fixture(scope="module")
def small_set(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    return draw_set(tmp_path_factory.mktemp("set"), levels_deg=(0, 30), placements=("front",))


@pytest.fixture(scope="module")
def looked(small_set: StimulusSet) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Raw gaze of people who look at each object once, and at the odd one three times as long."""
    generator = np.random.default_rng(3)
    samples, trials = [], []
    for participant in ("p1", "p2", "p3"):
        for number, stimulus in enumerate(small_set.with_role("main")):
            key = (participant, "1", number)
            trials.append((*key, stimulus.id))
            position = np.concatenate(
                [
                    np.tile(centre, (round(RATE_HZ * seconds), 1))
                    for label, centre in enumerate(CENTRES_PX, start=1)
                    for seconds in [ON_TARGET_S if label == stimulus.answer else STAY_S]
                ]
            ).astype(float)
            position += generator.normal(0, 0.03 * PIXELS_PER_DEGREE, position.shape)
            time_s = np.arange(len(position)) / RATE_HZ
            own = pd.DataFrame({"time_s": time_s, "x_px": position[:, 0], "y_px": position[:, 1]})
            samples.append(
                own.assign(participant=participant, session="1", trial_index=number, valid=True)
            )
    columns = ["participant", "session", "trial_index", "stimulus"]
    return pd.concat(samples, ignore_index=True), pd.DataFrame(trials, columns=columns)


@pytest.fixture(scope="module")
def found(looked: tuple[pd.DataFrame, pd.DataFrame], small_set: StimulusSet) -> GazeAnalysis:
    return analyse_gaze(*looked, small_set, PIXELS_PER_DEGREE, "divergence_deg", simulated=True)


def test_the_time_on_the_target_is_found_again(found: GazeAnalysis) -> None:
    # Recovery: three times as long, but for what the jumps between objects take of each stay.
    assert found.ratios is not None
    table = found.ratios.table
    assert table["divergence_deg"].tolist() == [30]  # controls have no target
    assert table["ratio"].iloc[0] == pytest.approx(ON_TARGET_S / STAY_S, rel=0.08)
    assert table["participants"].tolist() == [3]
    controls = found.dwell[found.dwell["divergence_deg"] == 0]
    assert controls["dwell_s"].to_numpy() == pytest.approx(STAY_S, abs=0.05)
    assert len(controls) == 3 * 2 * len(CENTRES_PX)


def test_files_say_simulated_and_hold_what_was_computed(
    found: GazeAnalysis, small_set: StimulusSet, tmp_path: Path
) -> None:
    results = json.loads(found.write(tmp_path).read_text())
    assert results["fixations"]["method"] == "I-VT"
    assert results["simulated"] is True
    ratios = pd.read_csv(tmp_path / "tables" / "dwell-ratios.csv")
    assert ratios["ratio"].iloc[0] == pytest.approx(results["ratios"]["table"][0]["ratio"])
    for path in (tmp_path / "tables").glob("*.csv"):
        assert pd.read_csv(path)["simulated"].all()
    names = {path.stem for path in (tmp_path / "figures").glob("*.png")}
    assert names == {
        "dwell-ratios",
        *(f"heat-map-{stimulus.id}" for stimulus in small_set.with_role("main")),
    }
    for figure in found.figures().values():
        assert "SIMULATED" in figure.get_suptitle()


def test_the_other_algorithm_agrees(
    looked: tuple[pd.DataFrame, pd.DataFrame], small_set: StimulusSet, found: GazeAnalysis
) -> None:
    # Another implementation: by dispersion instead of velocity.
    other = analyse_gaze(
        *looked, small_set, PIXELS_PER_DEGREE, "divergence_deg", method="dispersion"
    )
    assert other.ratios is not None
    assert found.ratios is not None
    ratio = other.ratios.table["ratio"].iloc[0]
    assert ratio == pytest.approx(found.ratios.table["ratio"].iloc[0], rel=0.1)


def test_refuses(looked: tuple[pd.DataFrame, pd.DataFrame], small_set: StimulusSet) -> None:
    samples, trials = looked
    known = (small_set, PIXELS_PER_DEGREE)
    with pytest.raises(InputError, match="trials: the column stimulus is missing"):
        analyse_gaze(samples, trials.drop(columns="stimulus"), *known, "divergence_deg")
    with pytest.raises(InputError, match="level: the set divergence has no factor 'angle'"):
        analyse_gaze(samples, trials, *known, "angle")
    with pytest.raises(InputError, match="trials: stimulus 'none' is not in the set divergence"):
        analyse_gaze(samples, trials.assign(stimulus="none"), *known, "divergence_deg")
    with pytest.raises(InputError, match="method: 'both' given, velocity or dispersion accepted"):
        analyse_gaze(samples, trials, *known, "divergence_deg", method="both")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="gaze: the column valid is missing"):
        analyse_gaze(samples.drop(columns="valid"), trials, *known, "divergence_deg")
