"""Right answers and all answers at each level: what thresholds are computed from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError

LARGEST_GUESS_RATE = 0.5


@dataclass(frozen=True)
class LevelCounts:
    """Different levels in rising order, each with at least one answer."""

    levels: tuple[float, ...]
    correct: tuple[int, ...]
    total: tuple[int, ...]


def level_counts(
    levels: ArrayLike, correct: ArrayLike, total: ArrayLike, guess_rate: float
) -> LevelCounts:
    """Check counts and pool those of equal levels; levels without an answer are dropped.

    Parameters
    ----------
    levels, correct, total, guess_rate
        As in `analysis.fit_threshold`.

    Raises
    ------
    InputError
        Naming the argument and what is accepted.
    """
    if not 0 <= guess_rate <= LARGEST_GUESS_RATE:
        raise InputError(f"guess_rate: {guess_rate} given, 0 to {LARGEST_GUESS_RATE} accepted")
    level = _one_dimensional("levels", levels)
    right = _whole("correct", correct)
    answers = _whole("total", total)
    if not level.shape == right.shape == answers.shape:
        raise InputError(
            f"levels, correct, total: {level.size}, {right.size} and {answers.size} entries given,"
            " one for each level accepted"
        )
    if np.any(right > answers):
        raise InputError("correct: more right answers than answers given")
    distinct, place = np.unique(level[answers > 0], return_inverse=True)
    if distinct.size < 2:
        raise InputError(f"levels: {distinct.size} with answers given, two or more accepted")
    size = distinct.size
    return LevelCounts(
        tuple(distinct.tolist()),
        tuple(np.bincount(place, right[answers > 0], size).astype(int).tolist()),
        tuple(np.bincount(place, answers[answers > 0], size).astype(int).tolist()),
    )


def _one_dimensional(name: str, values: ArrayLike) -> NDArray[np.float64]:
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: not a sequence of numbers") from None
    if array.ndim != 1:
        raise InputError(f"{name}: shape {array.shape} given, (n,) accepted")
    if not np.all(np.isfinite(array)):
        raise InputError(f"{name}: NaN or infinite entries given, finite numbers accepted")
    return array


def _whole(name: str, values: ArrayLike) -> NDArray[np.float64]:
    array = _one_dimensional(name, values)
    if np.any(array < 0) or np.any(array % 1 != 0):
        raise InputError(f"{name}: whole numbers of 0 or more accepted")
    return array
