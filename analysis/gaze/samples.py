"""Raw gaze on a regular grid of time: gaps closed or kept, blinks cut out, degrees for pixels."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from algorithms.errors import InputError
from analysis.bootstrap import Matrix
from experiments.gaze import pixels_per_degree

__all__ = [
    "COLUMNS",
    "TRIAL",
    "Track",
    "Tracks",
    "image_coordinates",
    "pixels_per_degree",
    "regular_tracks",
]

TRIAL = ("participant", "session", "trial_index")
COLUMNS = (*TRIAL, "time_s", "x_px", "y_px", "valid")


@dataclass(frozen=True)
class Track:
    """The gaze of one trial without a gap: samples at equal distances in time.

    Attributes
    ----------
    trial
        Its place in `Tracks.trials`.
    start_s, interval_s
        The time of the first sample, on the clock of the samples, and the step.
    x_deg, y_deg
        Shape (n,): from the upper left corner, y downwards.
    """

    trial: int
    start_s: float
    interval_s: float
    x_deg: Matrix
    y_deg: Matrix


@dataclass(frozen=True)
class Tracks:
    """All gaze, trial by trial.

    Attributes
    ----------
    trials
        One row a trial: `participant`, `session`, `trial_index`, `start_s`, `end_s` (of its
        samples), `samples`, `valid_share` (of the samples as recorded).
    tracks
        In the order of trials and time; none for trials without two valid samples.
    """

    trials: pd.DataFrame
    tracks: tuple[Track, ...]


def image_coordinates(
    gaze: pd.DataFrame, left_px: float, top_px: float, scale: float
) -> pd.DataFrame:
    """Return gaze in pixels of the image where it was recorded in pixels of the screen.

    Parameters
    ----------
    gaze
        With `x_px` and `y_px` from the screen's upper left corner, y downwards.
    left_px, top_px
        Where on the screen the image's upper left corner was.
    scale
        Pixels of the screen per pixel of the image, above 0. A degree then takes
        ``pixels_per_degree / scale`` pixels of the image.
    """
    if not scale > 0:
        raise InputError(f"scale: {scale} given, above 0 accepted")
    return gaze.assign(x_px=(gaze["x_px"] - left_px) / scale, y_px=(gaze["y_px"] - top_px) / scale)


def regular_tracks(
    gaze: pd.DataFrame, pixels_per_degree: float, longest_gap_s: float, margin_s: float
) -> Tracks:
    """Put the samples of each trial on a regular grid.

    Parameters
    ----------
    gaze
        One row a sample: `participant`, `session`, `trial_index`, `time_s` (rising within a trial),
        `x_px`, `y_px` (from the upper left corner, y downwards), `valid`. Coordinates that are
        missing or infinite count as not valid.
    pixels_per_degree
        Above 0.
    longest_gap_s
        Gaps without a valid sample are closed by straight lines up to that length; longer ones
        (blinks, losses) part the tracks.
    margin_s
        So much is cut off at both sides of the longer ones, where a lid half covers the pupil.

    Raises
    ------
    InputError
        If a column is missing, there is no sample, or times do not rise.

    Notes
    -----
    The step is the median one of the trial, so trackers with jitter or dropped rows will do.
    """
    missing = [name for name in COLUMNS if name not in gaze]
    if missing:
        raise InputError(f"gaze: the column {missing[0]} is missing")
    if gaze.empty:
        raise InputError("gaze: no sample given, one or more accepted")
    if not pixels_per_degree > 0:
        raise InputError(f"pixels_per_degree: {pixels_per_degree} given, above 0 accepted")
    if longest_gap_s < 0 or margin_s < 0:
        raise InputError("longest_gap_s, margin_s: 0 or more accepted")
    trials, tracks = [], []
    for key, samples in gaze.groupby(list(TRIAL), sort=False, observed=True, dropna=False):
        times_s, position_px, valid = _arrays(samples, key)
        trials.append(
            {
                **dict(zip(TRIAL, key, strict=True)),
                "start_s": times_s[0],
                "end_s": times_s[-1],
                "samples": len(times_s),
                "valid_share": float(valid.mean()),
            }
        )
        if valid.sum() >= 2:
            number = len(trials) - 1
            found = _tracks(
                times_s, position_px / pixels_per_degree, valid, longest_gap_s, margin_s
            )
            tracks += [Track(number, *parts) for parts in found]
    return Tracks(pd.DataFrame(trials), tuple(tracks))


def _arrays(
    samples: pd.DataFrame, key: tuple[object, ...]
) -> tuple[Matrix, Matrix, NDArray[np.bool_]]:
    times_s = samples["time_s"].to_numpy(float)
    if not np.all(np.isfinite(times_s)) or np.any(np.diff(times_s) <= 0):
        raise InputError(
            f"gaze: time_s of participant {key[0]}, session {key[1]}, trial {key[2]} does not rise"
            " from sample to sample"
        )
    position_px = samples[["x_px", "y_px"]].to_numpy(float).T
    valid = samples["valid"].fillna(value=False).to_numpy(bool)
    return times_s, position_px, valid & np.isfinite(position_px).all(axis=0)


def _tracks(
    times_s: Matrix,
    position_deg: Matrix,
    valid: NDArray[np.bool_],
    longest_gap_s: float,
    margin_s: float,
) -> Iterator[tuple[float, float, Matrix, Matrix]]:
    """Yield start, step and position of each stretch without a long gap."""
    step_s = float(np.median(np.diff(times_s)))
    known_s, known_deg = times_s[valid], position_deg[:, valid]
    longest_s = max(longest_gap_s, 0.0) + 1.5 * step_s  # one step apart is no gap
    breaks = np.flatnonzero(np.diff(known_s) > longest_s)
    starts, stops = np.r_[0, breaks + 1], np.r_[breaks, len(known_s) - 1]
    for first, last in zip(starts, stops, strict=True):
        start_s = known_s[first] + (margin_s if first > 0 else 0.0)
        stop_s = known_s[last] - (margin_s if last < len(known_s) - 1 else 0.0)
        steps = int((stop_s - start_s) / step_s + 1e-6)
        if steps < 1:
            continue
        grid_s = start_s + step_s * np.arange(steps + 1)
        part = slice(first, last + 1)
        x_deg, y_deg = (np.interp(grid_s, known_s[part], axis[part]) for axis in known_deg)
        yield float(start_s), step_s, x_deg, y_deg
