"""Vessels from the lathe: walls of glass with an inside and an outside, each a closed surface."""

import numpy as np
from numpy.typing import NDArray

from stimuli.shapes.lathe import lathe
from stimuli.shapes.mesh import Mesh

_VASE = [
    # radius and height: up the inside, over the lip, down the outside, back under the foot
    (0.0, 0.10),
    (0.28, 0.15),
    (0.48, 0.42),
    (0.55, 0.80),
    (0.42, 1.25),
    (0.22, 1.58),
    (0.22, 1.78),
    (0.33, 1.97),
    (0.355, 2.00),
    (0.365, 1.965),
    (0.275, 1.77),
    (0.275, 1.60),
    (0.49, 1.25),
    (0.62, 0.80),
    (0.55, 0.38),
    (0.37, 0.09),
    (0.35, 0.02),
    (0.31, 0.0),
    (0.15, 0.02),
    (0.0, 0.025),
]
_GOBLET = [
    (0.0, 1.03),
    (0.20, 1.07),
    (0.39, 1.24),
    (0.47, 1.52),
    (0.42, 1.94),
    (0.415, 1.975),
    (0.43, 1.99),
    (0.445, 1.975),
    (0.455, 1.94),
    (0.51, 1.52),
    (0.43, 1.20),
    (0.24, 1.00),
    (0.09, 0.91),
    (0.055, 0.78),
    (0.05, 0.45),
    (0.075, 0.22),
    (0.20, 0.105),
    (0.42, 0.055),
    (0.455, 0.035),
    (0.44, 0.01),
    (0.40, 0.0),
    (0.20, 0.012),
    (0.0, 0.015),
]
_BOWL = [
    (0.0, 0.12),
    (0.35, 0.16),
    (0.68, 0.40),
    (0.88, 0.78),
    (0.91, 0.81),
    (0.935, 0.78),
    (0.75, 0.36),
    (0.46, 0.10),
    (0.38, 0.04),
    (0.35, 0.0),
    (0.31, 0.0),
    (0.26, 0.03),
    (0.0, 0.04),
]


def vase(generator: np.random.Generator) -> Mesh:
    """Return a vase with a belly, a neck and a lip, open above."""
    return _turned(_VASE, generator)


def goblet(generator: np.random.Generator) -> Mesh:
    """Return a wine glass on a stem."""
    return _turned(_GOBLET, generator)


def bowl(generator: np.random.Generator) -> Mesh:
    """Return a bowl on a foot ring."""
    return _turned(_BOWL, generator)


def _turned(profile: list[tuple[float, float]], generator: np.random.Generator) -> Mesh:
    """Return the vessel, up to a tenth wider and slimmer here and there, of radius 1."""
    points: NDArray[np.float64] = np.array(profile)
    height = points[:, 1] / points[:, 1].max()
    first, second = generator.uniform(-0.1, 0.1, size=2)
    # Inside and outside are stretched alike, so that the wall stays a wall.
    points[:, 0] *= 1 + first * np.cos(np.pi * height) + second * np.sin(np.pi * height)
    return lathe(points, rows=384).fitted()
