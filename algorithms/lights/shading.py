"""What lights make of a matt surface, and the lights that explain a given shading best.

A surface point of normal n and position p shows, from each light, the cosine of incidence, never
less than 0 (Lopez-Moreno 2011, eq. 3.1), and the ambient light. A light is a vector: its direction
times its intensity. A near one has a nearness, 1 / distance in radii of the object; at p it shines
from ``direction - nearness p`` and falls off with the square of that length, so that nearness 0 is
a directional light. (Eq. 3.18 is the cosine of this on a circle, without the fall-off.)
"""

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from algorithms.lights.contour import Contour
from algorithms.lights.shape import Interior

Array = NDArray[np.float64]

NEAREST: Final = 1.2
"""The least distance of a point light, in radii."""

_LEAST_LEAN: Final = 0.1
_LEAN_POWER: Final = 3
_BRIGHT: Final = 95  # percentile of the luminance that is called 1
_OUTLYING: Final = 0.2
_CONTOUR_WEIGHT: Final = 0.25
_EVALUATIONS: Final = 60


@dataclass(frozen=True)
class Shading:
    """The luminance to be explained, inside an object and along its outline.

    Attributes
    ----------
    normals, positions
        `(n, 3)`; positions in radii of the object.
    luminance
        `(n,)`, of which 1 is bright.
    weights
        `(n,)`; their sum is 1 inside.
    inside
        How many of the first rows are the interior's.
    unit
        The luminance that is called 1.
    """

    normals: Array
    positions: Array
    luminance: Array
    weights: Array
    inside: int
    unit: float

    @property
    def variance(self) -> float:
        """The weighted variance of all of the luminance."""
        mean = np.average(self.luminance, weights=self.weights)
        return float(np.average((self.luminance - mean) ** 2, weights=self.weights))

    def mean_squares(self, values: Array) -> Array:
        """Return the weighted mean squares inside and along the outline, `(2,)`."""
        parts = (slice(None, self.inside), slice(self.inside, None))
        return np.array([np.average(values[p] ** 2, weights=self.weights[p]) for p in parts])

    def thinned(self, step: int) -> "Shading":
        """Return every so many places inside, and all of the outline."""
        kept = np.r_[0 : self.inside : step, self.inside : self.luminance.size]
        inside = len(range(0, self.inside, step))
        weights = self.weights[kept]
        weights[:inside] /= weights[:inside].sum()
        return replace(
            self,
            normals=self.normals[kept],
            positions=self.positions[kept],
            luminance=self.luminance[kept],
            weights=weights,
            inside=inside,
        )


@dataclass(frozen=True)
class Sources:
    """Some lights.

    Attributes
    ----------
    vectors
        `(k, 3)`: directions times intensities.
    ambient
        0 or more.
    nearness
        `(k,)`: 1 / distance in radii of the object; 0 for directional lights.
    """

    vectors: Array
    ambient: float
    nearness: Array

    @classmethod
    def directional(cls, vectors: Array, ambient: float = 0.0) -> "Sources":
        """Return lights that are infinitely far away."""
        return cls(np.reshape(vectors, (-1, 3)), ambient, np.zeros(np.size(vectors) // 3))

    @property
    def intensities(self) -> Array:
        """The length of each vector, `(k,)`."""
        return np.asarray(np.linalg.norm(self.vectors, axis=1))


def shading_of(interior: Interior, contour: Contour) -> Shading:
    """Join an object's interior and outline.

    Inside, a normal is the less certain the more it leans to the viewer, and the many that do would
    outvote the few near the outline: the weights fall with the third power of the lean. All of the
    outline, where a single pixel may be wrong, weighs a quarter of the interior.
    """
    lean = np.maximum(interior.normals[:, 2], _LEAST_LEAN) ** -_LEAN_POWER
    count = contour.luminance.size
    unit = float(np.percentile(interior.luminance, _BRIGHT)) or float(interior.luminance.max())
    unit = unit or 1.0
    return Shading(
        np.concatenate([interior.normals, contour.normals]),
        np.concatenate([interior.positions, contour.normals]),
        np.concatenate([interior.luminance, contour.luminance]) / unit,
        np.concatenate([lean / lean.sum(), np.full(count, _CONTOUR_WEIGHT / count)]),
        interior.luminance.size,
        unit,
    )


def robust(residuals: Array, scale: float) -> Array:
    """Return residuals whose squares are Charbonnier's loss of the given ones.

    Those below the scale stay about as they are; of larger ones, as of shadows, highlights and
    spots of another albedo, the loss grows linearly instead of with the square.
    """
    stretched = np.sqrt(1 + (residuals / scale) ** 2) - 1
    return np.asarray(np.sign(residuals) * scale * np.sqrt(2 * stretched))


def _robust_slope(residuals: Array, scale: float) -> Array:
    large = np.abs(residuals) > 1e-6 * scale
    safe = np.where(large, residuals, scale)
    slope = safe / (np.sqrt(1 + (safe / scale) ** 2) * robust(safe, scale))
    return np.where(large, slope, 1.0)


def cosines(normals: Array, vectors: Array) -> Array:
    """Return what directional lights add to each point, `(n, k)`."""
    return np.maximum(normals @ vectors.T, 0)


def predict(shading: Shading, sources: Sources) -> Array:
    """Return the luminance that lights would give, `(n,)`."""
    if not sources.nearness.any():
        return np.asarray(sources.ambient + cosines(shading.normals, sources.vectors).sum(axis=1))
    total = np.full(shading.luminance.shape, sources.ambient)
    lights = zip(sources.vectors, sources.intensities, sources.nearness, strict=True)
    for vector, intensity, nearness in lights:
        towards = vector / max(intensity, 1e-12) - nearness * shading.positions
        length = np.linalg.norm(towards, axis=1)
        facing = np.maximum(np.einsum("ij,ij->i", shading.normals, towards), 0)
        total += intensity * facing / length**3
    return total


def refine(
    shading: Shading, start: Sources, *, near: bool = False, turning: bool = True
) -> tuple[Sources, float]:
    """Move all lights together to where they explain the shading best.

    Parameters
    ----------
    shading
        What is to be explained.
    start
        Lights to start from.
    near
        Whether distances are found as well; else they stay as they are.
    turning
        Whether azimuths are found as well; else they stay as they are.

    Returns
    -------
    The lights, and the robust loss that is left.
    """
    count = len(start.vectors)
    root = np.sqrt(shading.weights)
    axes = _axes(start.vectors, turning)
    lights = slice(1, 1 + axes.shape[0] * axes.shape[1])

    def unpack(parameters: Array) -> Sources:
        parts = parameters[lights].reshape(axes.shape[:2])
        vectors = np.einsum("kj,kjd->kd", parts, axes)
        nearness = parameters[lights.stop :] if near else start.nearness
        return Sources(vectors, float(parameters[0]), nearness)

    def residuals(parameters: Array) -> Array:
        left = predict(shading, unpack(parameters)) - shading.luminance
        return root * robust(left, _OUTLYING)

    def jacobian(parameters: Array) -> Array:
        sources = unpack(parameters)
        left = predict(shading, sources) - shading.luminance
        slope = root * _robust_slope(left, _OUTLYING)
        lit = (shading.normals @ sources.vectors.T > 0) * slope[:, None]
        along = np.einsum("nd,kjd->nkj", shading.normals, axes)
        by_part = (lit[:, :, None] * along).reshape(len(slope), -1)
        return np.concatenate([slope[:, None], by_part], axis=1)

    parts = np.einsum("kd,kjd->kj", start.vectors, axes)
    free = np.concatenate([[max(start.ambient, 1e-4)], parts.ravel()])
    low, high = np.full(free.size, -np.inf), np.full(free.size, np.inf)
    low[0] = 0
    if not turning:
        low[1 :: axes.shape[1]] = 0
        free[1 :: axes.shape[1]] = np.maximum(free[1 :: axes.shape[1]], 1e-6)
    if near:
        free = np.concatenate([free, np.clip(start.nearness, 0.01, 0.9 / NEAREST)])
        low = np.concatenate([low, np.zeros(count)])
        high = np.concatenate([high, np.full(count, 1 / NEAREST)])
    derivative: Any = "2-point" if near or start.nearness.any() else jacobian
    found = optimize.least_squares(
        residuals,
        free,
        derivative,
        bounds=(low, high),
        max_nfev=_EVALUATIONS,
        xtol=1e-4,
        ftol=1e-5,
    )
    return unpack(found.x), float(found.cost)


def _axes(vectors: Array, turning: bool) -> Array:
    """Return the axes along which each light may move: x, y, z, or only outwards and z."""
    if turning:
        return np.broadcast_to(np.eye(3), (len(vectors), 3, 3))
    level = vectors[:, :2] / np.maximum(
        np.linalg.norm(vectors[:, :2], axis=1, keepdims=True), 1e-12
    )
    axes = np.zeros((len(vectors), 2, 3))
    axes[:, 0, :2], axes[:, 1, 2] = level, 1
    return axes
