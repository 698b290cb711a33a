"""Fixations from raw gaze, by velocity or by dispersion (Salvucci and Goldberg 2000).

By velocity (I-VT): the eye rests where it moves slower than a threshold. By dispersion (I-DT): it
rests where gaze stays within a small box for long enough. Both take and give pixels and work in
degrees of visual angle.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from analysis.estimates import software_version
from analysis.gaze_samples import TRIAL, Track, Tracks, regular_tracks

Integers = NDArray[np.intp]

VELOCITY_DEG_S = 30.0
WINDOW_S = 0.02
SHORTEST_S = 0.06
LONGEST_GAP_S = 0.075
MERGE_GAP_S = 0.075
MERGE_DISTANCE_DEG = 0.5
DISPERSION_DEG = 1.0
SHORTEST_IN_BOX_S = 0.1
MARGIN_S = 0.02
_CHUNK = 256  # samples looked at when a box grows


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
        As in `analysis.gaze_samples.regular_tracks`: one row a sample.
    pixels_per_degree
        Above 0; see `analysis.gaze_samples.pixels_per_degree`.
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
        first, stop = _runs(speed_deg_s(track, window_s) < velocity_deg_s)
        first, stop, weights = _merged(track, first, stop, merge_gap_s, merge_distance_deg)
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
        half = _half_window(track, window_s, fewest=0)
        smooth = np.stack([_moving_mean(axis, half) for axis in (track.x_deg, track.y_deg)])
        samples = max(int(np.ceil(shortest_s / track.interval_s - 1e-6)), 2)
        pairs = list(_boxes(smooth, samples, dispersion_deg))
        first, stop = np.array(pairs, dtype=np.intp).reshape(-1, 2).T
        found.append((track, first, stop, np.ones(len(track.x_deg))))
    return _fixations(tracks, found, pixels_per_degree, "I-DT", settings)


def speed_deg_s(track: Track, window_s: float) -> Matrix:
    """Return the speed of gaze: the slope of straight lines through windows of samples.

    At both ends of a track, where half a window is missing, the nearest speed; infinite where the
    track is shorter than a window.
    """
    half = _half_window(track, window_s, fewest=1)
    if len(track.x_deg) < 2 * half + 1:
        return np.full(len(track.x_deg), np.inf)
    steps = np.arange(half, -half - 1, -1)  # turned round, as a convolution does
    kernel = steps / ((steps**2).sum() * track.interval_s)
    slopes = [np.convolve(axis, kernel, mode="valid") for axis in (track.x_deg, track.y_deg)]
    return np.pad(np.hypot(*slopes), half, mode="edge")


def _check(settings: Mapping[str, float]) -> None:
    for name, value in settings.items():
        if not value >= 0:
            raise InputError(f"{name}: {value} given, 0 or more accepted")


def _half_window(track: Track, window_s: float, fewest: int) -> int:
    """Return how many samples a window reaches to both sides."""
    return max(int(window_s / track.interval_s / 2 + 1e-6), fewest)


def _moving_mean(values: Matrix, half: int) -> Matrix:
    """Return the mean over windows, which are shorter at the ends."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    places = np.arange(len(values))
    stop, start = np.minimum(places + half + 1, len(values)), np.maximum(places - half, 0)
    return np.asarray((sums[stop] - sums[start]) / (stop - start))


def _runs(flags: NDArray[np.bool_]) -> tuple[Integers, Integers]:
    """Return where stretches of true begin, and where they have ended."""
    changes = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return changes[::2], changes[1::2]


def _merged(
    track: Track, first: Integers, stop: Integers, gap_s: float, distance_deg: float
) -> tuple[Integers, Integers, Matrix]:
    """Join neighbours that are close in time and space; return also which samples rest."""
    weights = np.zeros(len(track.x_deg))
    if not len(first):
        return first, stop, weights
    steps = np.zeros(len(weights) + 1)
    np.add.at(steps, first, 1)
    np.add.at(steps, stop, -1)
    weights = np.cumsum(steps)[:-1]
    x_deg, y_deg = (_means(axis, weights, first, stop) for axis in (track.x_deg, track.y_deg))
    near = np.hypot(np.diff(x_deg), np.diff(y_deg)) <= distance_deg
    soon = (first[1:] - stop[:-1]) * track.interval_s <= gap_s + 1e-9
    begins = np.concatenate([[True], ~(near & soon)])
    ends = np.concatenate([begins[1:], [True]])
    return first[begins], stop[ends], weights


def _means(values: Matrix, weights: Matrix, first: Integers, stop: Integers) -> Matrix:
    """Return the weighted mean of each stretch."""
    sums, totals = (
        np.concatenate([[0.0], np.cumsum(each)]) for each in (values * weights, weights)
    )
    return np.asarray((sums[stop] - sums[first]) / (totals[stop] - totals[first]))


def _boxes(position_deg: Matrix, samples: int, dispersion_deg: float) -> Iterator[tuple[int, int]]:
    """Yield the stretches that fit into a box, shape of positions (2, n)."""
    length = position_deg.shape[1]
    if length < samples:
        return
    origin = -(samples // 2)  # a window that begins at its sample
    ranges = [
        ndimage.maximum_filter1d(axis, samples, origin=origin)
        - ndimage.minimum_filter1d(axis, samples, origin=origin)
        for axis in position_deg
    ]
    fits = np.flatnonzero((ranges[0] + ranges[1] <= dispersion_deg)[: length - samples + 1])
    place = 0
    while place < len(fits):
        first = int(fits[place])
        stop = _grown(position_deg, first, first + samples, dispersion_deg)
        yield first, stop
        place = int(np.searchsorted(fits, stop))


def _grown(position_deg: Matrix, first: int, stop: int, dispersion_deg: float) -> int:
    """Return where a box that holds the samples from first to stop has grown to."""
    low, high = (f(position_deg[:, first:stop], axis=1) for f in (np.min, np.max))
    while stop < position_deg.shape[1]:
        ahead = position_deg[:, stop : stop + _CHUNK]
        lows = np.minimum.accumulate(np.column_stack([low, ahead]), axis=1)[:, 1:]
        highs = np.maximum.accumulate(np.column_stack([high, ahead]), axis=1)[:, 1:]
        too_wide = (highs - lows).sum(axis=0) > dispersion_deg
        if too_wide.any():
            return stop + int(np.argmax(too_wide))
        low, high, stop = lows[:, -1], highs[:, -1], stop + ahead.shape[1]
    return stop


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
            "x_px": _means(track.x_deg, weights, first, stop) * pixels_per_degree,
            "y_px": _means(track.y_deg, weights, first, stop) * pixels_per_degree,
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
