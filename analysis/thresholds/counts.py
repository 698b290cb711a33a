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
    _check_guess_rate(guess_rate)
    level = _numbers("levels", levels, 1)
    right = _whole("correct", correct, 1)
    answers = _whole("total", total, 1)
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


def count_rows(
    levels: ArrayLike, correct: ArrayLike, total: ArrayLike, guess_rate: float, row: str = "fit"
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Check counts of many data sets, or of many participants, at the same levels.

    Parameters
    ----------
    levels
        Different levels in rising order, shape (l,), two or more.
    correct, total
        Right answers and all answers, shape (n, l), whole numbers; 0 answers are allowed.
    guess_rate
        As in `analysis.fit_threshold`.
    row
        What a row is, for the message.

    Returns
    -------
    The three as floating-point arrays.

    Raises
    ------
    InputError
        Naming the argument and what is accepted.
    """
    _check_guess_rate(guess_rate)
    level = _numbers("levels", levels, 1)
    if level.size < 2 or np.any(np.diff(level) <= 0):
        raise InputError("levels: two or more different ones in rising order accepted")
    right, answers = _whole("correct", correct, 2), _whole("total", total, 2)
    if right.shape != answers.shape or right.shape[1:] != level.shape:
        raise InputError(
            f"correct, total: shapes {right.shape} and {answers.shape} given,"
            f" one row a {row} with {level.size} levels accepted"
        )
    if np.any(right > answers):
        raise InputError("correct: more right answers than answers given")
    return level, right, answers


def _check_guess_rate(guess_rate: float) -> None:
    if not 0 <= guess_rate <= LARGEST_GUESS_RATE:
        raise InputError(f"guess_rate: {guess_rate} given, 0 to {LARGEST_GUESS_RATE} accepted")


def _numbers(name: str, values: ArrayLike, dimensions: int) -> NDArray[np.float64]:
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{name}: not a sequence of numbers") from None
    if array.ndim != dimensions:
        accepted = "(n,)" if dimensions == 1 else "(n, levels)"
        raise InputError(f"{name}: shape {array.shape} given, {accepted} accepted")
    if not np.all(np.isfinite(array)):
        raise InputError(f"{name}: NaN or infinite entries given, finite numbers accepted")
    return array


def _whole(name: str, values: ArrayLike, dimensions: int) -> NDArray[np.float64]:
    array = _numbers(name, values, dimensions)
    if np.any(array < 0) or np.any(array % 1 != 0):
        raise InputError(f"{name}: whole numbers of 0 or more accepted")
    return array
