from typing import Any

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.gaze.fixations import Fixations
from analysis.gaze.heat_map import heat_map
from analysis.gaze.looking_times import dwell_ratios, dwell_times, saccades
from benchmarks.gaze import IMAGE_DEG, METHODS, PIXELS_PER_DEGREE, scan_path

REGIONS = np.zeros((60, 100), dtype=np.uint8)
REGIONS[10:30, 10:30], REGIONS[10:30, 40:60], REGIONS[10:30, 70:90] = 1, 2, 3
PLACES = {0: (5.0, 5.0), 1: (20.0, 20.0), 2: (50.0, 20.0), 3: (80.0, 20.0), -1: (120.0, 20.0)}


def fixations_on(visited: dict[tuple[str, int], list[tuple[int, float]]]) -> Fixations:
    """Fixations on regions, one after the other with 50 ms between: (region, seconds) by trial."""
    rows, trials = [], []
    for (participant, trial), stays in visited.items():
        time_s = 10.0
        for region, duration_s in stays:
            x_px, y_px = PLACES[region]
            rows.append(
                (participant, "s", trial, time_s, time_s + duration_s, duration_s, x_px, y_px)
            )
            time_s += duration_s + 0.05
        trials.append((participant, "s", trial, 9.5, time_s, 1000, 1.0))
    key = ["participant", "session", "trial_index"]
    names = ["start_s", "end_s", "duration_s", "x_px", "y_px"]
    counts = ["start_s", "end_s", "samples", "valid_share"]
    return Fixations(
        pd.DataFrame(rows, columns=[*key, *names]),
        pd.DataFrame(trials, columns=[*key, *counts]),
        pixels_per_degree=10,
        method="known",
        settings={},
        version="",
    )


def trials_of(fixations: Fixations, **columns: float) -> pd.DataFrame:
    key = fixations.trials[["participant", "session", "trial_index"]]
    return key.assign(stimulus="image", **columns)


def test_heat_map_is_a_gaussian_at_each_fixation_weighted_by_duration() -> None:
    # Theory: far apart, the heights are as the durations; the width is sigma.
    table = pd.DataFrame({"x_px": [50.5, 150.5], "y_px": [60.5, 60.5], "duration_s": [0.3, 0.9]})
    found = heat_map(table, (120, 200), pixels_per_degree=8, sigma_deg=1.5)
    assert found.density.sum() == pytest.approx(1, abs=1e-5)
    assert found.density[60, 150] == pytest.approx(3 * found.density[60, 50], rel=1e-5)
    peak = 0.75 / (2 * np.pi * 12**2)
    assert found.density[60, 150] == pytest.approx(peak, rel=1e-3)
    assert found.density[60, 162] == pytest.approx(peak * np.exp(-0.5), rel=1e-3)
    assert found.duration_s == pytest.approx(1.2)
    assert (found.fixations, found.outside) == (2, 0)


def test_heat_map_leaves_out_fixations_beside_the_image() -> None:
    table = pd.DataFrame({"x_px": [5.0, -1.0, 30.0], "y_px": [5.0] * 3, "duration_s": [1.0] * 3})
    found = heat_map(table, (20, 20), pixels_per_degree=2)
    assert (found.fixations, found.outside) == (1, 2)
    assert found.density.sum() == pytest.approx(1, abs=1e-5)


def test_dwell_times_count_stays_and_visits() -> None:
    stays = [(0, 0.2), (1, 0.3), (1, 0.1), (2, 0.5), (1, 0.4), (-1, 0.3)]
    fixations = fixations_on({("p1", 0): stays})
    found = dwell_times(fixations, trials_of(fixations, target=2), {"image": REGIONS})
    found = found.set_index("region")
    assert found["dwell_s"].tolist() == pytest.approx([0.8, 0.5, 0])
    assert found["share"].tolist() == pytest.approx([8 / 13, 5 / 13, 0])
    assert found["fixations"].tolist() == [3, 1, 0]
    assert found["visits"].tolist() == [2, 1, 0]
    first = found["first_fixation_s"].tolist()
    assert first[:2] == pytest.approx([0.5 + 0.25, 0.5 + 0.75])  # the trial began at 9.5 s
    assert np.isnan(first[2])


def test_first_fixation_counts_from_the_onset_where_it_is_known() -> None:
    fixations = fixations_on({("p1", 0): [(1, 0.3)]})
    trials = trials_of(fixations, onset_s=9.9)
    found = dwell_times(fixations, trials, {"image": REGIONS})
    assert found["first_fixation_s"].iloc[0] == pytest.approx(0.1)


def test_a_trial_without_a_look_at_any_region_is_kept() -> None:
    fixations = fixations_on({("p1", 0): [(1, 0.3)], ("p1", 1): []})
    found = dwell_times(fixations, trials_of(fixations), {"image": REGIONS})
    assert len(found) == 6
    assert (found.loc[found["trial_index"] == 1, "dwell_s"] == 0).all()
    assert found.loc[found["trial_index"] == 1, "share"].isna().all()


def test_each_stimulus_has_its_own_regions() -> None:
    fixations = fixations_on({("p1", 0): [(1, 0.3)], ("p1", 1): [(1, 0.3)]})
    trials = trials_of(fixations).assign(stimulus=["image", "other"])
    other = np.where(REGIONS == 1, 7, 0).astype(np.uint8)
    found = dwell_times(fixations, trials, {"image": REGIONS, "other": other})
    assert found["region"].tolist() == [1, 2, 3, 7]
    assert found["dwell_s"].tolist() == pytest.approx([0.3, 0, 0, 0.3])


def looked(people: int, ratio: float) -> Fixations:
    """Fixations of people who look longer at region 2 than at 1 and 3, in two trials each."""
    generator = np.random.default_rng(1)
    visited = {}
    for number in range(people):
        own = ratio * np.exp(generator.normal(0, 0.3))
        for trial in range(2):
            seconds = generator.gamma(4, 0.1, 3) * (1, own, 1)
            visited[f"p{number}", trial] = list(zip((1, 2, 3), seconds, strict=True))
    return fixations_on(visited)


def test_ratio_is_of_the_target_to_the_mean_of_the_others() -> None:
    fixations = fixations_on(
        {("p1", 0): [(1, 0.2), (2, 0.9), (3, 0.4)], ("p2", 0): [(1, 0.5), (2, 0.6), (3, 0.1)]}
    )
    dwell = dwell_times(fixations, trials_of(fixations, target=2, level=20), {"image": REGIONS})
    (row,) = dwell_ratios(dwell, ["level"]).table.to_dict("records")
    assert row["ratio"] == pytest.approx(1.5 / 0.6)
    assert (row["level"], row["trials"], row["participants"]) == (20, 2, 2)
    assert row["low"] < row["ratio"] < row["high"]
    (other,) = dwell_ratios(dwell, ["level"], region=3).table.to_dict("records")
    assert other["ratio"] == pytest.approx(0.5 / 1.1)


def test_ratio_by_level_takes_each_trials_own_target() -> None:
    fixations = fixations_on({("p1", 0): [(1, 0.6), (2, 0.2)], ("p1", 1): [(1, 0.2), (3, 0.9)]})
    trials = trials_of(fixations).assign(target=[1, 3], level=[10, 20])
    dwell = dwell_times(fixations, trials, {"image": REGIONS})
    table = dwell_ratios(dwell, ["level"]).table
    assert table["ratio"].tolist() == pytest.approx([0.6 / 0.1, 0.9 / 0.1])
    assert table["low"].isna().all()  # one participant
    controls = dwell.assign(target=dwell["target"].astype("Int64").mask(dwell["level"] == 10))
    assert dwell_ratios(controls, ["level"]).table["level"].tolist() == [20]


def test_interval_of_the_ratio_holds_it() -> None:
    # Recovery: 400 studies of 12 participants whose own ratios differ by 30 %, as levels of one.
    truth = 2 * np.exp(0.3**2 / 2)  # of the sums: the mean of the participants' ratios
    fixations = looked(400 * 12, 2.0)
    trials = trials_of(fixations, target=2)
    trials["level"] = trials["participant"].str.slice(1).astype(int) // 12
    dwell = dwell_times(fixations, trials, {"image": REGIONS})
    table = dwell_ratios(dwell, ["level"]).table
    assert len(table) == 400
    holds = (table["low"] <= truth) & (truth <= table["high"])
    assert holds.mean() == pytest.approx(0.95, abs=0.033)


def test_saccades_have_amplitude_and_direction() -> None:
    fixations = fixations_on({("p1", 0): [(1, 0.3), (2, 0.3), (0, 0.2)], ("p2", 0): [(1, 0.3)]})
    found = saccades(fixations)
    assert found["participant"].tolist() == ["p1", "p1"]
    assert found["amplitude_deg"].tolist() == pytest.approx([3.0, np.hypot(4.5, 1.5)])
    up = np.degrees(np.arctan2(1.5, -4.5))  # from (50, 20) up and left to (5, 5)
    assert found["direction_deg"].tolist() == pytest.approx([0.0, up])
    assert found["duration_s"].tolist() == pytest.approx([0.05, 0.05])


@pytest.mark.parametrize(
    ("columns", "regions", "message"),
    [
        ({}, {"other": REGIONS}, "regions: none given for stimulus image"),
        ({}, {"image": REGIONS[0]}, r"regions: a label image \(height, width\) for image accepted"),
        ({"participant": "p9"}, {"image": REGIONS}, "trials: a trial without any gaze given"),
    ],
)
def test_refuses_trials_and_regions(
    columns: dict[str, Any], regions: dict[str, Matrix], message: str
) -> None:
    fixations = fixations_on({("p1", 0): [(1, 0.3)]})
    with pytest.raises(InputError, match=message):
        dwell_times(fixations, trials_of(fixations).assign(**columns), regions)


def test_refuses() -> None:
    fixations = fixations_on({("p1", 0): [(1, 0.3)]})
    trials = trials_of(fixations)
    regions = {"image": REGIONS}
    with pytest.raises(InputError, match="trials: the column stimulus is missing"):
        dwell_times(fixations, trials.drop(columns="stimulus"), regions)
    with pytest.raises(InputError, match="trials: a trial is named twice"):
        dwell_times(fixations, pd.concat([trials, trials]), regions)
    dwell = dwell_times(fixations, trials, regions)
    with pytest.raises(InputError, match="dwell: the column level is missing"):
        dwell_ratios(dwell, ["level"])
    with pytest.raises(InputError, match="dwell: the column target is missing"):
        dwell_ratios(dwell, ["stimulus"])
    with pytest.raises(InputError, match="dwell: no trial with that region and another one"):
        dwell_ratios(dwell, ["stimulus"], region=9)
    with pytest.raises(InputError, match=r"dwell: the column that makes the cells \(by\) is"):
        dwell_ratios(dwell, [], region=1)
    with pytest.raises(InputError, match="table: no fixation on the image, one or more accepted"):
        heat_map(fixations.table, (2, 2), 10)
    with pytest.raises(InputError, match="shape, pixels_per_degree, sigma_deg: numbers above 0"):
        heat_map(fixations.table, (60, 100), 10, sigma_deg=0)


@pytest.mark.parametrize("method", METHODS)
def test_from_raw_gaze_to_looking_times(method: str) -> None:
    # Recovery: the time on each half of an image, from samples with noise and blinks.
    path = scan_path(60, 250, 0.03, np.random.default_rng(5), blinks=4)
    width_px, height_px = (round(size * PIXELS_PER_DEGREE) for size in IMAGE_DEG)
    halves = np.ones((height_px, width_px), dtype=np.uint8)
    halves[:, width_px // 2 :] = 2
    fixations = METHODS[method](path.gaze, PIXELS_PER_DEGREE)
    found = dwell_times(fixations, trials_of(fixations), {"image": halves})
    truth = path.truth.assign(
        region=1 + (path.truth["x_deg"] * PIXELS_PER_DEGREE >= width_px // 2),
        duration_s=path.truth["end_s"] - path.truth["start_s"],
    )
    expected = truth.groupby("region")["duration_s"].sum()
    # Blinks take some of it away.
    np.testing.assert_allclose(found["dwell_s"], expected, atol=4 * 0.29 + 1)
    assert found["dwell_s"].sum() <= 60
    heat = heat_map(fixations.table, halves.shape, PIXELS_PER_DEGREE)
    left = float(heat.density[:, : width_px // 2].sum())
    assert left == pytest.approx(found["share"].iloc[0], abs=0.03)
