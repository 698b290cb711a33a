"""Broad-leaved trees in autumn: branching wood and flat leaves at the ends of the twigs."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stimuli.shapes.mesh import Mesh
from stimuli.shapes.solids import grid_faces, merged, tube

Vector = NDArray[np.float64]

_TRUNK_LENGTH: Final = 0.25  # of the tree's height
_TRUNK_RADIUS: Final = 0.022
_LENGTH_RATIO: Final = 0.77
_TWIG_RADIUS: Final = 0.0011
_LEAF_REACH: Final = 0.05
_SEGMENTS: Final = 4
_UPWARD: Final = 0.16


@dataclass(frozen=True)
class Tree:
    """A tree of height about 1 that stands on the origin.

    Attributes
    ----------
    wood
        Trunk, branches and twigs.
    leaves
        Flat and pointed, seen from both sides; the first texture coordinate is one random number
        for each leaf, to colour it by.
    """

    wood: Mesh
    leaves: Mesh


@dataclass(frozen=True)
class _Branch:
    start: Vector
    direction: Vector
    length: float
    radius: float
    level: int


def grow_tree(
    generator: np.random.Generator,
    levels: int = 6,
    leaves_per_twig: int = 14,
    leaf_size: float = 0.017,
) -> Tree:
    """Grow a tree: each branch parts into two or three shorter ones.

    Parameters
    ----------
    generator
        Draws angles, lengths and bends.
    levels
        How often branches part, 1 or more; the number of twigs grows by about 2.4 each time.
    leaves_per_twig
        0 for a bare tree.
    leaf_size
        The mean width of a leaf.

    Notes
    -----
    The cross-sections of the branches that leave a fork add up to that of the one that enters it.
    """
    growing = [_Branch(np.zeros(3), np.array([0.0, 1.0, 0.0]), _TRUNK_LENGTH, _TRUNK_RADIUS, 0)]
    wood, tips = [], []
    while growing:
        branch = growing.pop()
        path = _bent_path(branch, generator)
        children = _children(branch, path, levels, generator)
        end = max((child.radius for child in children), default=_TWIG_RADIUS / 2)
        radii = np.linspace(branch.radius, max(end, _TWIG_RADIUS / 2), len(path))
        if branch.level == 0:
            radii[0] *= 1.5  # the foot of the trunk
        wood.append(tube(path, radii, sides=max(3, 9 - 2 * branch.level)))
        growing.extend(children)
        if branch.level >= levels - 2:
            tips.append(path)
    return Tree(merged(wood), _leaves(np.array(tips), leaves_per_twig, leaf_size, generator))


def _bent_path(branch: _Branch, generator: np.random.Generator) -> Vector:
    """Return a branch's axis: a random walk that tends upwards, `(segments + 1, 3)`."""
    bend = 0.05 if branch.level == 0 else 0.16
    direction, points = branch.direction, [branch.start]
    for _ in range(_SEGMENTS):
        upward = np.array([0, _UPWARD if branch.level else 0, 0])
        direction = direction + bend * generator.normal(size=3) + upward
        direction = direction / np.linalg.norm(direction)
        points.append(points[-1] + direction * branch.length / _SEGMENTS)
    return np.array(points)


def _children(
    branch: _Branch, path: Vector, levels: int, generator: np.random.Generator
) -> list[_Branch]:
    if branch.level == levels:
        return []
    count = int(generator.choice([2, 3], p=[0.55, 0.45])) + (2 if branch.level == 0 else 0)
    heading = path[-1] - path[-2]
    heading /= np.linalg.norm(heading)
    across = np.linalg.svd(heading[None])[2][1:]
    start_turn = generator.uniform(0, 2 * np.pi)
    shares = generator.dirichlet([9.0, *np.full(count - 1, 5.0)])  # the first one leads
    children = []
    for number, share in enumerate(shares):
        turn = start_turn + 2 * np.pi * number / count + generator.normal(0, 0.3)
        lean = np.radians(generator.uniform(4, 16) if number == 0 else generator.uniform(28, 58))
        outward = np.cos(turn) * across[0] + np.sin(turn) * across[1]
        children.append(
            _Branch(
                # Side branches leave a little below the end, as they do in nature.
                path[-1] if number == 0 else _along(path, generator.uniform(0.45, 1.0)),
                np.cos(lean) * heading + np.sin(lean) * outward,
                branch.length * _LENGTH_RATIO * generator.uniform(0.8, 1.12),
                max(branch.radius * float(np.sqrt(share)), _TWIG_RADIUS),
                branch.level + 1,
            )
        )
    return children


def _along(path: Vector, share: float) -> Vector:
    """Return the point at a share of a path's length."""
    place = share * (len(path) - 1)
    index = min(int(place), len(path) - 2)
    return np.asarray(path[index] + (place - index) * (path[index + 1] - path[index]))


def _leaves(tips: Vector, per_twig: int, mean_size: float, generator: np.random.Generator) -> Mesh:
    """Scatter leaves around twigs whose axes are `(n, points, 3)`."""
    count = len(tips) * per_twig
    twig = np.repeat(np.arange(len(tips)), per_twig)
    place = generator.integers(1, tips.shape[1], size=count)
    centres = tips[twig, place] + generator.normal(size=(count, 3)) * _LEAF_REACH / 2
    frames: NDArray[Any] = np.linalg.qr(generator.normal(size=(count, 3, 3)))[0]
    size = mean_size * generator.uniform(0.7, 1.3, size=count)
    corners = np.array([(0.0, -0.7), (0.42, -0.05), (-0.42, -0.05), (0.0, 0.7)])
    offsets = np.einsum("kc,nci->nki", corners, frames[:, :2]) * size[:, None, None]
    colour = np.repeat(generator.uniform(size=count), 4)
    faces = grid_faces(2, 2)[None] + 4 * np.arange(count)[:, None, None]
    return Mesh(
        (centres[:, None] + offsets).reshape(-1, 3),
        np.repeat(np.cross(frames[:, 0], frames[:, 1]), 4, axis=0),
        np.stack([colour, np.full(4 * count, 0.5)], axis=1),
        faces.reshape(-1, 3),
    )
