"""Poisson's equation inside a mask.

It is solved from coarse to fine: each level starts with the solution of the one before, so that a
few sweeps of Jacobi's iteration are left to do (Bornemann and Deuflhard 1996); rounds of correction
remove what is wrong on the coarse levels.
"""

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

Plane = NDArray[np.float32]
Mask = NDArray[np.bool_]
Sides = tuple[bool, bool, bool, bool]
"""Top, bottom, left, right."""

_COARSEST_PX: Final = 16
_COARSEST_SWEEPS: Final = 200
_SWEEPS: Final = 6
_DAMPING: Final = 0.8
_ROUNDS: Final = 4


def solve_poisson(
    inside: Mask,
    even: Sides,
    source: float = 0.0,
    fixed: tuple[Mask, NDArray[np.floating]] | None = None,
) -> Plane:
    """Solve ``laplacian = -4 source`` inside a mask, 0 outside.

    Parameters
    ----------
    inside
        bool `(height, width)`.
    even
        Top, bottom, left, right: whether the solution goes on as it is beyond that side.
    source
        In the inverse of squared pixels.
    fixed
        Where values are given, bool, and these values; those elsewhere are a first guess.
    """
    solution = np.zeros(inside.shape, dtype=np.float32)
    free = inside
    if fixed:
        pinned, values = fixed
        solution[inside] = values[inside]
        free = inside & ~pinned
    whole = 2 ** max(0, math.ceil(math.log2(min(inside.shape) / _COARSEST_PX)))
    solution = _extended(solution, whole, even)
    free = _extended(free.astype(np.float32), whole, even) > 0
    for _ in range(_ROUNDS):
        # Coarse levels see an outline that is off by parts of a cell: the next round solves for
        # what is missing.
        missing = np.where(free, source - _excess(solution, even), 0).astype(np.float32)
        solution += _corrections(missing, free, even)
    return solution[: inside.shape[0], : inside.shape[1]]


def _extended(plane: Plane, whole: int, even: Sides) -> Plane:
    """Return a plane whose sides are multiples of a number: all cells of all levels are whole."""
    _, bottom, _, right = even
    below, beside = (-extent % whole for extent in plane.shape)
    plane = np.pad(plane, ((0, below), (0, 0)), mode="edge" if bottom else "constant")
    return np.pad(plane, ((0, 0), (0, beside)), mode="edge" if right else "constant")


def _corrections(source: Plane, free: Mask, even: Sides) -> Plane:
    """Solve from coarse to fine, 0 where not free; sources count in the unit of a level's cells."""
    if min(source.shape) <= _COARSEST_PX:
        return _relaxed(np.zeros_like(source), source, free, even, _COARSEST_SWEEPS)
    coarse = _corrections(4 * _cells(source), _coarser(free, even), even)
    start = np.where(free, _doubled(coarse), 0)
    return _relaxed(start, source, free, even, _SWEEPS)


def _coarser(free: Mask, even: Sides) -> Mask:
    """Return the cells that lie inside with all of their pixels.

    Larger ones would take the outline to be farther away than it is, and correct too much; so would
    those along a side beyond which there is 0.
    """
    cells = free[::2] & free[1::2]
    cells = cells[:, ::2] & cells[:, 1::2]
    _zero_beyond(cells, even)
    return np.asarray(cells)


def _zero_beyond(plane: NDArray[Any], even: Sides) -> None:
    """Set the outermost pixels to 0 along the sides that are not even."""
    edges = (plane[0], plane[-1], plane[:, 0], plane[:, -1])
    for goes_on, edge in zip(even, edges, strict=True):
        if not goes_on:
            edge[...] = 0


def _cells(plane: Plane) -> Plane:
    """Return the means of two by two pixels."""
    rows = plane[::2] + plane[1::2]
    return np.asarray((rows[:, ::2] + rows[:, 1::2]) / 4)


def _doubled(plane: Plane) -> Plane:
    """Interpolate linearly between the centres of cells, to twice the size."""
    for _ in range(2):
        padded = np.concatenate([plane[:1], plane, plane[-1:]])
        fine = np.empty((2 * len(plane), plane.shape[1]), dtype=np.float32)
        fine[::2] = 0.75 * plane + 0.25 * padded[:-2]
        fine[1::2] = 0.75 * plane + 0.25 * padded[2:]
        plane = fine.T
    return np.ascontiguousarray(plane)


def _relaxed(values: Plane, source: Plane, free: Mask, even: Sides, sweeps: int) -> Plane:
    """Sweep: move every free value towards the mean of its neighbours and the source."""
    step = np.where(free, np.float32(_DAMPING), np.float32(0))
    for _ in range(sweeps):
        values = values + step * (source - _excess(values, even))
    return values


def _excess(values: Plane, even: Sides) -> Plane:
    """Return by how much values exceed the mean of their four neighbours.

    Beyond the sides that are even they go on as they are, beyond the others there is 0.
    """
    padded = np.pad(values, 1, mode="edge")
    _zero_beyond(padded, even)
    mean = padded[:-2, 1:-1] + padded[2:, 1:-1]
    mean += padded[1:-1, :-2]
    mean += padded[1:-1, 2:]
    mean *= -0.25
    mean += values
    return mean
