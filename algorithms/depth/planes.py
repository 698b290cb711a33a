"""Distance from a few things that a user knows: layers, a receding plane, near and far.

Almost any picture falls into two or three planes of depth, and a ground that recedes between them;
for fog that is good enough (Lopez-Moreno 2011, sec. 6.3.4.1).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.depth.poisson import Plane
from algorithms.errors import InputError

Point = tuple[float, float]


def layered_distance(
    masks: Sequence[ArrayLike],
    distances: Sequence[float | ArrayLike],
    background: float | ArrayLike,
) -> Plane:
    """Put layers in front of a background.

    Parameters
    ----------
    masks
        bool `(height, width)`, one or more; a later layer covers those before it.
    distances
        Of each layer, scene units, 0 or more: one number, or `(height, width)`, such as that of a
        receding plane.
    background
        The distance where there is no layer, likewise; infinite for the sky.

    Returns
    -------
    float32 `(height, width)`, scene units, larger is farther.

    Raises
    ------
    InputError
        If there is no mask, numbers or shapes differ, or a distance is negative or NaN.
    """
    if not masks or len(masks) != len(distances):
        raise InputError("distances: one for each mask is accepted, and at least one mask")
    shape = np.shape(masks[0])
    if len(shape) != 2:
        raise InputError(f"masks: (height, width) is accepted, not {shape}")
    distance = np.array(_broadcast("background", background, shape))
    for mask, layer in zip(masks, distances, strict=True):
        inside = np.asarray(mask).astype(bool)
        if inside.shape != shape:
            raise InputError(f"masks: one size is accepted, not {shape} and {inside.shape}")
        np.copyto(distance, _broadcast("distances", layer, shape), where=inside)
    return distance


def receding_distance(
    shape: tuple[int, int], near_point: Point, far_point: Point, near: float, far: float
) -> Plane:
    """Return the distance of a plane that recedes from one point of the picture to another.

    Parameters
    ----------
    shape
        Height and width.
    near_point, far_point
        x and y in pixels from the top left corner, such as where a user begins and ends to drag.
    near, far
        The distances there, scene units, more than 0; `far` may be infinite, for the horizon.

    Returns
    -------
    float32 `(height, width)`, scene units, larger is farther: constant across the line between the
    points, and infinite from the plane's horizon on.

    Raises
    ------
    InputError
        If the points are the same or not finite, or the distances not as described.

    Notes
    -----
    The depth of a plane seen in perspective is the inverse of a linear function of the position in
    the picture; the gradient of Oh et al. 2001 (Lopez-Moreno 2011, fig. 6.4).
    """
    start, end = np.asarray(near_point, dtype=float), np.asarray(far_point, dtype=float)
    if start.shape != (2,) or end.shape != (2,) or not np.isfinite([start, end]).all():
        raise InputError("near_point, far_point: x and y, two finite numbers each, are accepted")
    if (start == end).all():
        raise InputError("far_point: another point than near_point is accepted")
    if not (0 < near < far):
        raise InputError(f"near, far: 0 < near < far is accepted, not {near} and {far}")
    along = (end - start) / ((end - start) @ (end - start))
    rows, columns = (np.arange(extent) + 0.5 for extent in shape)
    share = (columns - start[0]) * along[0] + ((rows - start[1]) * along[1])[:, None]
    inverse = 1 / near + share * (1 / far - 1 / near)
    with np.errstate(divide="ignore"):
        return np.asarray(1 / np.maximum(inverse, 0), dtype=np.float32)


def distance_of_relief(relief: NDArray[np.floating[Any]], near: float, far: float) -> Plane:
    """Return the distances of a relief whose ends are known.

    Parameters
    ----------
    relief
        `(height, width)`, finite, larger is nearer; of all of a picture.
    near, far
        The distances of its highest and its lowest point, scene units, 0 <= near < far, finite.

    Returns
    -------
    float32 `(height, width)`, scene units, larger is farther; linear in the relief.

    Raises
    ------
    InputError
        If a value is not as described.
    """
    heights = np.asarray(relief, dtype=np.float32)
    if heights.ndim != 2 or not np.isfinite(heights).all():
        raise InputError("relief: finite values (height, width) are accepted")
    if not 0 <= near < far < np.inf:
        raise InputError(f"near, far: 0 <= near < far is accepted, not {near} and {far}")
    lowest, highest = float(heights.min()), float(heights.max())
    depth = (highest - heights) / max(highest - lowest, 1e-12)
    return np.asarray(near + depth * (far - near), dtype=np.float32)


def scaled_distance(distance: ArrayLike) -> Plane:
    """Scale distances so that the farthest thing is at 1, and the sky with it.

    Parameters
    ----------
    distance
        `(height, width)`, 0 or more, infinite for the sky.

    Returns
    -------
    float32 `(height, width)`, 0..1: the depth that the thesis' fog parameters are meant for.

    Raises
    ------
    InputError
        If a value is negative or NaN, or none is finite and more than 0.
    """
    values = _broadcast("distance", distance, np.shape(distance))
    finite = values[np.isfinite(values)]
    if finite.size == 0 or finite.max() == 0:
        raise InputError("distance: a finite value of more than 0 is accepted, at least one")
    return np.asarray(np.minimum(values / finite.max(), 1))


def _broadcast(name: str, value: float | ArrayLike, shape: tuple[int, ...]) -> Plane:
    distance = np.asarray(value, dtype=np.float32)
    if distance.shape not in ((), shape):
        raise InputError(f"{name}: one number or {shape} is accepted, not {distance.shape}")
    if not (distance >= 0).all():
        raise InputError(f"{name}: 0 or more is accepted, not negative or NaN")
    return np.broadcast_to(distance, shape)
