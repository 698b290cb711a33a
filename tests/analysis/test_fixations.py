import re

import numpy as np
import pandas as pd
import pytest
from scipy.signal import savgol_filter

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.bounded_means import Flags
from analysis.gaze.fixations import (
    fixations_by_dispersion,
    fixations_by_velocity,
)
from analysis.gaze.resting_gaze import boxes, speed_deg_s
from analysis.gaze.samples import (
    Track,
    image_coordinates,
    pixels_per_degree,
    regular_tracks,
)
from benchmarks.gaze import METHODS, PIXELS_PER_DEGREE, found_again, recovered, scan_path
from experiments.lab.geometry import Area, fit


def gaze_of(time_s: Matrix, x_px: Matrix, y_px: Matrix, valid: Flags | None = None) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "participant": "p1",
            "session": "s1",
            "trial_index": 0,
            "time_s": time_s,
            "x_px": x_px,
            "y_px": y_px,
            "valid": np.ones(len(time_s), bool) if valid is None else valid,
        }
    )


def two_places(rate_hz: float = 500, jump_deg: float = 5.0) -> pd.DataFrame:
    """Half a second at one place, a jump without any time, half a second at another."""
    time_s = np.arange(round(rate_hz)) / rate_hz
    x_deg = np.where(time_s < 0.5, 3.0, 3.0 + jump_deg)
    return gaze_of(time_s, x_deg * 40, np.full(len(time_s), 80.0))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rate_hz", [60.0, 500.0])
def test_finds_known_fixations_without_noise(method: str, rate_hz: float) -> None:
    # Recovery: all of a minute, at their place, within a sample or the smoothing's half window.
    path = scan_path(60, rate_hz, 0.0, np.random.default_rng(1))
    found = METHODS[method](path.gaze, PIXELS_PER_DEGREE)
    errors = found_again(path.truth, found)
    assert len(found.table) == len(path.truth)
    assert errors.notna().all(axis=None)
    assert (errors["distance_deg"] < 0.2).all()
    tolerance_s = 1.6 / rate_hz + 0.012
    assert (errors[["start_error_s", "end_error_s"]].abs() <= tolerance_s).all(axis=None)


@pytest.mark.parametrize(
    ("method", "rate_hz", "noise_deg", "share"),
    [
        ("I-VT", 60, 0.1, 1.0),
        ("I-VT", 250, 0.1, 1.0),
        ("I-VT", 500, 0.2, 1.0),
        ("I-DT", 60, 0.05, 0.95),
        ("I-DT", 500, 0.1, 0.9),
    ],
)
def test_finds_known_fixations_with_noise(
    method: str, rate_hz: float, noise_deg: float, share: float
) -> None:
    found = recovered(method, rate_hz, noise_deg)
    assert found["found_again"] >= share
    assert found["distance_deg"] < noise_deg / 2


def test_velocity_method_gives_time_and_place_of_a_jump() -> None:
    found = fixations_by_velocity(two_places(), 40).table
    assert found["x_px"].tolist() == pytest.approx([120, 320], abs=0.5)
    assert found["y_px"].tolist() == pytest.approx([80, 80])
    # The window of 20 ms sees the jump from 10 ms away.
    assert found["start_s"].tolist() == pytest.approx([0, 0.51], abs=0.003)
    assert found["end_s"].tolist() == pytest.approx([0.49, 1.0], abs=0.003)
    np.testing.assert_allclose(found["duration_s"], found["end_s"] - found["start_s"])


def test_close_neighbours_are_merged() -> None:
    # A small jump is a movement, but not to another place.
    assert len(fixations_by_velocity(two_places(jump_deg=0.45), 40).table) == 1
    apart = fixations_by_velocity(two_places(jump_deg=0.45), 40, merge_distance_deg=0.3)
    assert len(apart.table) == 2
    assert len(fixations_by_velocity(two_places(), 40, merge_gap_s=0).table) == 2


def test_short_ones_are_dropped() -> None:
    time_s = np.arange(500) / 500
    x_deg = np.select([time_s < 0.4, time_s < 0.47], [2.0, 9.0], 15.0)  # 70 ms at 9 degrees
    gaze = gaze_of(time_s, x_deg * 40, np.zeros(500))
    assert len(fixations_by_velocity(gaze, 40, shortest_s=0.04).table) == 3
    assert len(fixations_by_velocity(gaze, 40).table) == 2
    assert len(fixations_by_dispersion(gaze, 40).table) == 2


def test_speed_is_the_slope_of_a_line_through_the_window() -> None:
    # Another implementation: Savitzky and Golay's filter of first order.
    generator = np.random.default_rng(1)
    x_deg, y_deg = generator.standard_normal((2, 200)).cumsum(axis=1) / 10
    track = Track(0, 0.0, 0.002, x_deg, y_deg)
    slopes = [
        savgol_filter(axis, 11, 1, deriv=1, delta=0.002, mode="interp") for axis in (x_deg, y_deg)
    ]
    np.testing.assert_allclose(speed_deg_s(track, 0.02), np.hypot(*slopes), rtol=1e-9)
    assert np.isinf(speed_deg_s(Track(0, 0.0, 0.002, x_deg[:10], y_deg[:10]), 0.02)).all()


def boxes_by_hand(position: Matrix, samples: int, widest: float) -> list[tuple[int, int]]:
    """Salvucci and Goldberg 2000, figure 4, as printed: one sample at a time."""
    found, first, count = [], 0, position.shape[1]
    while first + samples <= count:
        stop = first + samples
        if np.ptp(position[:, first:stop], axis=1).sum() <= widest:
            while stop < count and np.ptp(position[:, first : stop + 1], axis=1).sum() <= widest:
                stop += 1
            found.append((first, stop))
            first = stop
        else:
            first += 1
    return found


@pytest.mark.parametrize("samples", [2, 5, 8])
@pytest.mark.parametrize("seed", range(8))
def test_boxes_are_those_of_the_printed_algorithm(samples: int, seed: int) -> None:
    generator = np.random.default_rng(seed)
    jumps = generator.standard_normal((2, 40)).repeat(generator.integers(1, 60, 40), axis=1) * 3
    position = jumps + 0.1 * generator.standard_normal(jumps.shape)
    expected = boxes_by_hand(position, samples, 1.0)
    assert list(boxes(position, samples, 1.0)) == expected
    assert expected


@pytest.mark.parametrize("method", METHODS)
def test_blinks_part_fixations_and_short_gaps_do_not(method: str) -> None:
    time_s = np.arange(500) / 500
    x_px = np.full(500, 100.0)
    for length_s, parts in ((0.05, 1), (0.15, 2)):
        lost = (time_s >= 0.4) & (time_s < 0.4 + length_s)
        gaze = gaze_of(time_s, np.where(lost, np.nan, x_px), x_px, ~lost)
        for written in (gaze, gaze[~lost], gaze.assign(valid=True)):
            found = METHODS[method](written, 40).table
            assert len(found) == parts
            if parts == 2:  # a margin of 20 ms is cut off at both sides
                assert found["end_s"].iloc[0] == pytest.approx(0.38, abs=0.003)
                assert found["start_s"].iloc[1] == pytest.approx(0.57, abs=0.003)


def test_lids_that_half_cover_the_pupil_are_cut_out() -> None:
    # Gaze seems to sink by three degrees in the last 20 ms before a blink.
    time_s = np.arange(500) / 500
    lost = (time_s >= 0.4) & (time_s < 0.55)
    y_px = 80 + 120 * np.clip((time_s - 0.38) / 0.02, 0, 1) * (time_s < 0.4)
    gaze = gaze_of(time_s, np.full(500, 100.0), y_px, ~lost)
    kept = fixations_by_velocity(gaze, 40).table
    assert kept["y_px"].tolist() == pytest.approx([80, 80], abs=0.1)


def test_jitter_and_dropped_rows_do_no_harm() -> None:
    generator = np.random.default_rng(2)
    path = scan_path(30, 250, 0.02, generator)
    gaze = path.gaze.drop(index=generator.choice(7500, 700, replace=False).tolist())
    gaze["time_s"] += generator.uniform(-0.001, 0.001, len(gaze))
    errors = found_again(path.truth, fixations_by_velocity(gaze, PIXELS_PER_DEGREE))
    assert errors["distance_deg"].notna().mean() > 0.97


def test_trials_are_kept_apart_and_counted() -> None:
    generator = np.random.default_rng(3)
    paths = [scan_path(4, 250, 0.02, generator, trial_index=k, blinks=1) for k in range(3)]
    gaze = pd.concat([path.gaze for path in paths])
    lost = gaze[gaze["trial_index"] == 2].assign(valid=False)
    found = fixations_by_velocity(pd.concat([gaze[gaze["trial_index"] < 2], lost]), 38)
    assert found.trials["trial_index"].tolist() == [0, 1, 2]
    assert set(found.table["trial_index"]) == {0, 1}
    assert found.trials["valid_share"].iloc[2] == 0
    alone = fixations_by_velocity(paths[1].gaze, 38).table
    pd.testing.assert_frame_equal(
        found.table[found.table["trial_index"] == 1].reset_index(drop=True), alone
    )
    assert found.settings["velocity_deg_s"] == 30


@pytest.mark.parametrize("method", METHODS)
def test_no_valid_sample_no_fixation(method: str) -> None:
    gaze = two_places().assign(valid=False)
    found = METHODS[method](gaze, 40)
    assert found.table.empty
    assert list(found.table.columns) == list(METHODS[method](two_places(), 40).table.columns)
    one = METHODS[method](two_places()[:1], 40)
    assert one.table.empty


def test_grid_leaves_regular_samples_as_they_are() -> None:
    gaze = two_places(rate_hz=250)
    (track,) = regular_tracks(gaze, 40, 0.075, 0.02).tracks
    np.testing.assert_allclose(track.x_deg * 40, gaze["x_px"], atol=1e-6)
    assert track.interval_s == pytest.approx(0.004)


def test_pixels_per_degree() -> None:
    # Theory: at 57.3 cm a degree takes a centimetre.
    assert pixels_per_degree(1000, 50, 57.3) == pytest.approx(20, rel=1e-3)
    with pytest.raises(InputError, match="width_px, width_cm, distance_cm: numbers above 0"):
        pixels_per_degree(1000, 0, 57)


def test_gaze_on_the_screen_becomes_gaze_on_the_image() -> None:
    # Against the lab's own placement of images.
    placement = fit(1000, 600, Area(0, 0, 1280, 400))
    x_px, y_px = placement.window_point(250, 150)
    gaze = gaze_of(np.zeros(1), np.array([x_px]), np.array([y_px]))
    area = placement.area
    found = image_coordinates(gaze, area.left_px, area.top_px, placement.scale)
    assert found["x_px"].iloc[0] == pytest.approx(250, abs=0.5)
    assert found["y_px"].iloc[0] == pytest.approx(150, abs=0.5)
    with pytest.raises(InputError, match="scale: 0 given, above 0 accepted"):
        image_coordinates(gaze, 0, 0, 0)


def test_refuses() -> None:
    gaze = two_places()
    with pytest.raises(InputError, match="gaze: the column valid is missing"):
        fixations_by_velocity(gaze.drop(columns="valid"), 40)
    with pytest.raises(InputError, match="gaze: no sample given, one or more accepted"):
        fixations_by_velocity(gaze[:0], 40)
    with pytest.raises(InputError, match="pixels_per_degree: 0 given, above 0 accepted"):
        fixations_by_dispersion(gaze, 0)
    with pytest.raises(InputError, match="velocity_deg_s: -1 given, 0 or more accepted"):
        fixations_by_velocity(gaze, 40, velocity_deg_s=-1)
    with pytest.raises(InputError, match="dispersion_deg: nan given, 0 or more accepted"):
        fixations_by_dispersion(gaze, 40, dispersion_deg=float("nan"))
    message = "gaze: time_s of participant p1, session s1, trial 0 does not rise"
    with pytest.raises(InputError, match=re.escape(message)):
        fixations_by_velocity(pd.concat([gaze, gaze]), 40)
    with pytest.raises(InputError, match=re.escape(message)):
        fixations_by_velocity(gaze.assign(time_s=np.nan), 40)
