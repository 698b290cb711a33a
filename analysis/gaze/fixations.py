"""Fixations from raw gaze, by velocity or by dispersion (Salvucci and Goldberg 2000).

By velocity (I-VT): the eye rests where it moves slower than a threshold. By dispersion (I-DT): it
rests where gaze stays within a small box for long enough. Both take and give pixels and work in
degrees of visual angle.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import software_version
from analysis.gaze.resting_gaze import (
    Integers,
    boxes,
    half_window,
    means,
    merged,
    moving_mean,
    runs,
    speed_deg_s,
)
from analysis.gaze.samples import TRIAL, Track, Tracks, regular_tracks

VELOCITY_DEG_S = 30.0
WINDOW_S = 0.02
SHORTEST_S = 0.06
LONGEST_GAP_S = 0.075
MERGE_GAP_S = 0.075
MERGE_DISTANCE_DEG = 0.5
DISPERSION_DEG = 1.0
SHORTEST_IN_BOX_S = 0.1
MARGIN_S = 0.02


@dataclass(frozen=True)
class Fixations:
    """Fixations of all trials.

    Attributes
    ----------
    table
        One row a fixation, in the order of trials and time: `participant`, `session`,
        `trial_index`, `start_s`, `end_s` (on the clock of the samples; a sample stands for the
        time until the next one), `duration_s`, `x_px`, `y_px` (the mean of its samples).
    trials
        One row a trial, with or without a fixation: `participant`, `session`, `trial_index`,
        `start_s`, `end_s`, `samples`, `valid_share` (of the samples as recorded).
    pixels_per_degree
        As given.
    method, settings
        The algorithm and its parameters by name.
    version
        By which Trompe.
    """

    table: pd.DataFrame
    trials: pd.DataFrame
    pixels_per_degree: float
    method: str
    settings: Mapping[str, float]
    version: str

    def to_frame(self) -> pd.DataFrame:
        """Return the table."""
        return self.table.copy()


def fixations_by_velocity(
    gaze: pd.DataFrame,
    pixels_per_degree: float,
    *,
    velocity_deg_s: float = VELOCITY_DEG_S,
    window_s: float = WINDOW_S,
    shortest_s: float = SHORTEST_S,
    merge_gap_s: float = MERGE_GAP_S,
    merge_distance_deg: float = MERGE_DISTANCE_DEG,
    longest_gap_s: float = LONGEST_GAP_S,
    margin_s: float = MARGIN_S,
) -> Fixations:
    """Find fixations as stretches of slow gaze (I-VT).

    Parameters
    ----------
    gaze
        As in `analysis.gaze.samples.regular_tracks`: one row a sample.
    pixels_per_degree
        Above 0; see `analysis.pixels_per_degree`.
    velocity_deg_s
        Slower is a fixation.
    window_s
        Velocity is the slope of the straight line through the samples of that time (three or
        more).
    shortest_s
        Shorter fixations are dropped.
    merge_gap_s, merge_distance_deg
        Neighbours closer than both are one fixation.
    longest_gap_s, margin_s
        How missing samples are dealt with, as in `regular_tracks`.

    Raises
    ------
    InputError
        If the samples or an argument are impossible.

    Notes
    -----
    Salvucci and Goldberg 2000, sec. 3.1, with gap filling, merging and defaults of Olsen 2012 (The
    Tobii I-VT fixation filter). At 60 to 500 Hz it finds every simulated fixation again with a
    noise of 0.1 degrees on each axis, and falls apart at 0.4 (measured by ``python -m
    benchmarks.gaze``); a longer window bears more.
    """
    settings = {
        "velocity_deg_s": velocity_deg_s,
        "window_s": window_s,
        "shortest_s": shortest_s,
        "merge_gap_s": merge_gap_s,
        "merge_distance_deg": merge_distance_deg,
        "longest_gap_s": longest_gap_s,
        "margin_s": margin_s,
    }
    _check(settings)
    tracks = regular_tracks(gaze, pixels_per_degree, longest_gap_s, margin_s)
    found = []
    for track in tracks.tracks:
        first, stop = runs(speed_deg_s(track, window_s) < velocity_deg_s)
        first, stop, weights = merged(track, first, stop, merge_gap_s, merge_distance_deg)
        long_enough = (stop - first) * track.interval_s >= shortest_s - 1e-9
        found.append((track, first[long_enough], stop[long_enough], weights))
    return _fixations(tracks, found, pixels_per_degree, "I-VT", settings)


def fixations_by_dispersion(
    gaze: pd.DataFrame,
    pixels_per_degree: float,
    *,
    dispersion_deg: float = DISPERSION_DEG,
    shortest_s: float = SHORTEST_IN_BOX_S,
    window_s: float = WINDOW_S,
    longest_gap_s: float = LONGEST_GAP_S,
    margin_s: float = MARGIN_S,
) -> Fixations:
    """Find fixations as stretches of gaze within a small box (I-DT).

    Parameters
    ----------
    gaze, pixels_per_degree, longest_gap_s, margin_s
        As in `fixations_by_velocity`.
    dispersion_deg
        The largest width plus height of the box.
    shortest_s
        How long gaze must stay in it.
    window_s
        Gaze is smoothed by the mean over that time first, as noise alone widens a box; 0 for raw
        gaze.

    Raises
    ------
    InputError
        If the samples or an argument are impossible.

    Notes
    -----
    Salvucci and Goldberg 2000, sec. 3.3: a box of the shortest duration grows until it is too
    wide. Smoothing is ours.
    """
    settings = {
        "dispersion_deg": dispersion_deg,
        "shortest_s": shortest_s,
        "window_s": window_s,
        "longest_gap_s": longest_gap_s,
        "margin_s": margin_s,
    }
    _check(settings)
    tracks = regular_tracks(gaze, pixels_per_degree, longest_gap_s, margin_s)
    found = []
    for track in tracks.tracks:
        half = half_window(track, window_s, fewest=0)
        smooth = np.stack([moving_mean(axis, half) for axis in (track.x_deg, track.y_deg)])
        samples = max(int(np.ceil(shortest_s / track.interval_s - 1e-6)), 2)
        pairs = list(boxes(smooth, samples, dispersion_deg))
        first, stop = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        found.append((track, first, stop, np.ones(len(track.x_deg))))
    return _fixations(tracks, found, pixels_per_degree, "I-DT", settings)


def _check(settings: Mapping[str, float]) -> None:
    for name, value in settings.items():
        if not value >= 0:
            raise InputError(f"{name}: {value} given, 0 or more accepted")


def _fixations(
    tracks: Tracks,
    found: list[tuple[Track, Integers, Integers, Matrix]],
    pixels_per_degree: float,
    method: str,
    settings: Mapping[str, float],
) -> Fixations:
    parts = [
        {
            "trial": np.full(len(first), track.trial),
            "start_s": track.start_s + first * track.interval_s,
            "end_s": track.start_s + stop * track.interval_s,
            "x_px": means(track.x_deg, weights, first, stop) * pixels_per_degree,
            "y_px": means(track.y_deg, weights, first, stop) * pixels_per_degree,
        }
        for track, first, stop, weights in found
        if len(first)
    ]
    names = ("trial", "start_s", "end_s", "x_px", "y_px")
    table = pd.DataFrame(
        {name: np.concatenate([part[name] for part in parts]) if parts else [] for name in names}
    )
    trials = tracks.trials.loc[table.pop("trial").astype(int), list(TRIAL)].reset_index(drop=True)
    table.insert(2, "duration_s", table["end_s"] - table["start_s"])
    return Fixations(
        table=pd.concat([trials, table], axis=1),
        trials=tracks.trials,
        pixels_per_degree=pixels_per_degree,
        method=method,
        settings=dict(settings),
        version=software_version(),
    )
