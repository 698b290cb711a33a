"""Where on a track of gaze the eye rests: slow stretches, and stretches within a small box."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from analysis.bootstrap import Matrix
from analysis.gaze.samples import Track

Integers = NDArray[np.intp]
_CHUNK = 256  # samples looked at when a box grows


def speed_deg_s(track: Track, window_s: float) -> Matrix:
    """Return the speed of gaze: the slope of straight lines through windows of samples.

    At both ends of a track, where half a window is missing, the nearest speed; infinite where the
    track is shorter than a window.
    """
    half = half_window(track, window_s, fewest=1)
    if len(track.x_deg) < 2 * half + 1:
        return np.full(len(track.x_deg), np.inf)
    steps = np.arange(half, -half - 1, -1)  # turned round, as a convolution does
    kernel = steps / ((steps**2).sum() * track.interval_s)
    slopes = [np.convolve(axis, kernel, mode="valid") for axis in (track.x_deg, track.y_deg)]
    return np.pad(np.hypot(*slopes), half, mode="edge")


def half_window(track: Track, window_s: float, fewest: int) -> int:
    """Return how many samples a window reaches to both sides."""
    return max(int(window_s / track.interval_s / 2 + 1e-6), fewest)


def moving_mean(values: Matrix, half: int) -> Matrix:
    """Return the mean over windows, which are shorter at the ends."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    places = np.arange(len(values))
    stop, start = np.minimum(places + half + 1, len(values)), np.maximum(places - half, 0)
    return np.asarray((sums[stop] - sums[start]) / (stop - start))


def runs(flags: NDArray[np.bool_]) -> tuple[Integers, Integers]:
    """Return where stretches of true begin, and where they have ended."""
    changes = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return changes[::2], changes[1::2]


def merged(
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
    x_deg, y_deg = (means(axis, weights, first, stop) for axis in (track.x_deg, track.y_deg))
    near = np.hypot(np.diff(x_deg), np.diff(y_deg)) <= distance_deg
    soon = (first[1:] - stop[:-1]) * track.interval_s <= gap_s + 1e-9
    begins = np.concatenate([[True], ~(near & soon)])
    ends = np.concatenate([begins[1:], [True]])
    return first[begins], stop[ends], weights


def means(values: Matrix, weights: Matrix, first: Integers, stop: Integers) -> Matrix:
    """Return the weighted mean of each stretch."""
    sums, totals = (
        np.concatenate([[0.0], np.cumsum(each)]) for each in (values * weights, weights)
    )
    return np.asarray((sums[stop] - sums[first]) / (totals[stop] - totals[first]))


def boxes(position_deg: Matrix, samples: int, dispersion_deg: float) -> Iterator[tuple[int, int]]:
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
