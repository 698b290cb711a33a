"""Where to look for lights: starting points of the fit, from tables of what lights would do.

The shading of a set of lights is a sum with weights of 0 or more, so that sets can be judged from
the inner products of their shadings alone, many at once.
"""

from collections.abc import Iterator
from functools import cache
from itertools import combinations, product
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.lights.shading import Array, Shading, Sources, cosines

_DIRECTIONS: Final = 200
_STEP_DEG: Final = 15
_ELEVATIONS_DEG: Final = (-45.0, -15.0, 15.0, 45.0)
_SPLIT_DEG: Final = 35.0
_LEAST_INTENSITY: Final = 0.05


def starting_points(shading: Shading, found: Sources, count: int) -> Iterator[Sources]:
    """Yield sets of lights from which a fit may start.

    Parameters
    ----------
    shading
        What is to be explained.
    found
        The best set of one light less.
    count
        How many lights, 1 or more.

    Yields
    ------
    The set that explains the outline best; `found` with the light that helps most; `found` with
    each light split into two on either side of it, as where two lights had been taken for one.
    """
    yield _best_on_contour(shading, count)
    yield _one_more(shading, found)
    for index, vector in enumerate(found.vectors):
        others = np.delete(found.vectors, index, axis=0)
        yield Sources.directional(np.concatenate([others, _split(vector)]), found.ambient)


def direction_of(azimuth_deg: float, elevation_deg: float) -> Array:
    """Return a unit vector `(3,)` in the project's frame."""
    azimuth, elevation = np.radians([azimuth_deg, elevation_deg])
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])


@cache
def sphere_points(count: int) -> Array:
    """Return unit vectors spread evenly over the sphere, `(count, 3)`."""
    z = 1 - (2 * np.arange(count) + 1) / count
    turns = np.pi * (3 - np.sqrt(5)) * np.arange(count)
    level = np.sqrt(1 - z**2)
    return np.stack([level * np.cos(turns), level * np.sin(turns), z], axis=-1)


def _split(vector: Array) -> Array:
    """Turn half of a light to either side in azimuth."""
    intensity = np.linalg.norm(vector)
    sideways = np.array([-vector[1], vector[0], 0.0])
    sideways /= max(float(np.linalg.norm(sideways)), 1e-12)
    turn = np.radians(_SPLIT_DEG)
    parts = [np.cos(turn) * vector + sign * np.sin(turn) * intensity * sideways for sign in (1, -1)]
    return np.asarray(np.array(parts) / (2 * np.cos(turn)))


def _one_more(shading: Shading, found: Sources) -> Sources:
    """Add the direction that explains most of what is left."""
    candidates = sphere_points(_DIRECTIONS)
    intensities = np.maximum(found.intensities, 1e-12)
    old = found.vectors / intensities[:, None]
    columns = cosines(shading.normals, np.concatenate([old, candidates]))
    sets = np.array([[*range(len(old)), len(old) + new] for new in range(len(candidates))])
    chosen, weights = _best_set(columns, shading.luminance, shading.weights, sets)
    directions = np.concatenate([old, candidates])[chosen]
    return Sources.directional(directions * weights[1:, None], float(weights[0]))


def _best_on_contour(shading: Shading, count: int) -> Sources:
    """Find azimuths on the outline, then elevations by all of the shading."""
    rows = np.s_[shading.inside :]
    azimuths_deg = np.arange(0.0, 360.0, _STEP_DEG)
    level = np.array([direction_of(azimuth, 0) for azimuth in azimuths_deg])
    sets = np.array(list(combinations(range(len(level)), count)))
    columns = cosines(shading.normals[rows], level)
    chosen, _ = _best_set(columns, shading.luminance[rows], shading.weights[rows], sets)
    return raised(shading, azimuths_deg[chosen])


def raised(shading: Shading, azimuths_deg: Array) -> Sources:
    """Return lights of given azimuths at those of a few elevations that explain most."""
    heights = len(_ELEVATIONS_DEG)
    directions = np.array(
        [
            direction_of(azimuth, elevation)
            for azimuth in azimuths_deg
            for elevation in _ELEVATIONS_DEG
        ]
    )
    choices = [range(heights * index, heights * (index + 1)) for index in range(len(azimuths_deg))]
    columns = cosines(shading.normals, directions)
    sets = np.array(list(product(*choices)))
    chosen, weights = _best_set(columns, shading.luminance, shading.weights, sets)
    return Sources.directional(directions[chosen] * weights[1:, None], float(weights[0]))


def _best_set(
    columns: Array, luminance: Array, weights: Array, sets: NDArray[np.int64]
) -> tuple[NDArray[np.int64], Array]:
    """Return the set of columns that fits best beside a constant, and their weights.

    Weights below 0 are cut to 0 instead of solving for the rest again: good enough for a start.
    """
    table = np.concatenate([np.ones((len(columns), 1)), columns], axis=1)
    weighted = table * weights[:, None]
    products, targets = table.T @ weighted, weighted.T @ luminance
    index = np.concatenate([np.zeros((len(sets), 1), dtype=np.int64), sets + 1], axis=1)
    gram = products[index[:, :, None], index[:, None, :]]
    gram = gram + 1e-6 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(index.shape[1])
    target = targets[index]
    solved = np.maximum(np.linalg.solve(gram, target[..., None])[..., 0], 0)
    cost = np.einsum("si,sij,sj->s", solved, gram, solved) - 2 * (solved * target).sum(axis=1)
    best = int(np.argmin(cost))
    found = solved[best].copy()
    found[1:] = np.maximum(found[1:], _LEAST_INTENSITY)
    return sets[best], found
