"""Figures that look like something: animals, a bone, a doll and rings, all closed, of radius 1.

Each is a function of a generator, which varies its proportions a little.
"""

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from stimuli.shapes.displaced_spheres import RuggedShape
from stimuli.shapes.distance_fields import ellipsoid, tube
from stimuli.shapes.implicit import Field, smooth_union, surface_of
from stimuli.shapes.mesh import Mesh

Points = list[tuple[float, float, float]]

_VARIATION: Final = 0.04
_KNOT_POINTS: Final = 36


def pebble(generator: np.random.Generator) -> Mesh:
    """Return a smooth stone with shallow dents."""
    return RuggedShape(generator, 0.25).mesh(128, 256)  # it is smooth enough


def vertebra(generator: np.random.Generator) -> Mesh:
    """Return a bone with a body, an arch around a hole, and three processes."""
    arch: Points = [
        (-0.30, 0.12, 0.0),
        (-0.36, 0.42, 0.0),
        (0.0, 0.66, 0.0),
        (0.36, 0.42, 0.0),
        (0.30, 0.12, 0.0),
    ]
    parts = [
        ellipsoid([0, -0.22, 0.05], [0.46, 0.40, 0.30]),
        _limb(generator, arch, [0.15, 0.12, 0.13, 0.12, 0.15]),
        _limb(generator, [(0, 0.62, 0), (0, 0.85, -0.12), (0, 1.02, -0.3)], [0.14, 0.09, 0.11]),
        *_pair(
            generator, [(0.34, 0.38, 0), (0.65, 0.45, -0.05), (0.9, 0.38, -0.12)], [0.13, 0.08, 0.1]
        ),
    ]
    return _figure(parts, 0.05)


def dolphin(generator: np.random.Generator) -> Mesh:
    """Return a leaping dolphin, seen from its side."""
    spine: Points = [
        (0.98, -0.10, 0),
        (0.80, 0.00, 0),
        (0.62, 0.12, 0),
        (0.30, 0.26, 0),
        (-0.05, 0.26, 0),
        (-0.40, 0.10, 0),
        (-0.72, -0.20, 0),
        (-0.90, -0.46, 0),
    ]
    fin: Points = [(0.05, 0.42, 0), (-0.10, 0.66, 0), (-0.28, 0.80, 0)]
    flipper: Points = [(0.42, 0.08, 0.16), (0.36, -0.12, 0.30), (0.22, -0.30, 0.38)]
    fluke: Points = [(-0.86, -0.42, 0.0), (-0.98, -0.54, 0.24), (-1.12, -0.54, 0.48)]
    parts = [
        _limb(generator, spine, [0.05, 0.08, 0.22, 0.31, 0.32, 0.24, 0.13, 0.07]),
        _limb(generator, fin, [0.12, 0.065, 0.015]),
        *_pair(generator, flipper, [0.09, 0.08, 0.02], axis=2),
        *_pair(generator, fluke, [0.08, 0.075, 0.02], axis=2),
    ]
    return _figure(parts, 0.035)


def bull(generator: np.random.Generator) -> Mesh:
    """Return a standing bull with horns, seen from its side."""
    trunk: Points = [
        (-0.62, 0.16, 0),
        (-0.35, 0.18, 0),
        (0.0, 0.16, 0),
        (0.35, 0.22, 0),
        (0.58, 0.34, 0),
    ]
    neck: Points = [(0.50, 0.32, 0), (0.64, 0.38, 0), (0.76, 0.42, 0)]
    head: Points = [(0.74, 0.42, 0), (0.86, 0.26, 0), (0.95, 0.08, 0)]
    fore: Points = [
        (0.36, 0.05, 0.17),
        (0.38, -0.25, 0.19),
        (0.36, -0.48, 0.19),
        (0.38, -0.74, 0.19),
    ]
    hind: Points = [
        (-0.55, 0.05, 0.17),
        (-0.60, -0.22, 0.19),
        (-0.68, -0.46, 0.19),
        (-0.62, -0.74, 0.19),
    ]
    horn: Points = [(0.76, 0.46, 0.08), (0.80, 0.52, 0.26), (0.88, 0.68, 0.34), (0.90, 0.84, 0.28)]
    tail: Points = [
        (-0.80, 0.26, 0),
        (-0.92, 0.12, 0.02),
        (-0.94, -0.20, 0.05),
        (-0.92, -0.42, 0.03),
    ]
    parts = [
        _limb(generator, trunk, [0.22, 0.26, 0.27, 0.31, 0.22]),
        _limb(generator, neck, [0.22, 0.19, 0.15]),
        _limb(generator, head, [0.15, 0.12, 0.09]),
        *_pair(generator, fore, [0.14, 0.085, 0.065, 0.075], axis=2),
        *_pair(generator, hind, [0.18, 0.10, 0.065, 0.075], axis=2),
        *_pair(generator, horn, [0.06, 0.055, 0.045, 0.02], axis=2),
        *_pair(generator, [(0.68, 0.42, 0.14), (0.62, 0.40, 0.28)], [0.05, 0.04], axis=2),
        _limb(generator, tail, [0.04, 0.035, 0.03, 0.05]),
    ]
    return _figure(parts, 0.05)


def doll(generator: np.random.Generator) -> Mesh:
    """Return a standing doll with a round head, arms held out."""
    body: Points = [(0, -0.30, 0), (0, -0.05, 0), (0, 0.25, 0), (0, 0.42, 0)]
    leg: Points = [(0.13, -0.30, 0), (0.16, -0.62, 0.02), (0.18, -0.92, 0)]
    foot: Points = [(0.18, -0.94, 0.02), (0.21, -0.95, 0.14)]
    arm: Points = [(0.20, 0.28, 0), (0.40, 0.20, 0.05), (0.56, 0.30, 0.14), (0.64, 0.44, 0.18)]
    parts = [
        _limb(generator, body, [0.24, 0.20, 0.21, 0.09]),
        ellipsoid([0, 0.70, 0], [0.27, 0.29, 0.26]),
        ellipsoid([0, 0.68, 0.26], [0.05, 0.05, 0.06]),
        *_pair(generator, [(0.12, 0.92, 0), (0.20, 1.02, -0.02)], [0.08, 0.07]),
        *_pair(generator, leg, [0.14, 0.10, 0.08]),
        *_pair(generator, foot, [0.08, 0.08]),
        *_pair(generator, arm, [0.09, 0.075, 0.065, 0.08]),
    ]
    return _figure(parts, 0.06)


def knot(generator: np.random.Generator) -> Mesh:
    """Return a ring that is knotted once (a trefoil)."""
    turn = np.arange(_KNOT_POINTS) * 2 * np.pi / _KNOT_POINTS
    lobe, lift = generator.uniform([0.26, 0.26], [0.32, 0.32])
    ring = 0.58 + lobe * np.cos(3 * turn)
    points = np.column_stack(
        [ring * np.cos(2 * turn), ring * np.sin(2 * turn), lift * np.sin(3 * turn)]
    )
    return surface_of(tube(points, np.full(_KNOT_POINTS, 0.135), closed=True), cells=160).fitted()


def twisted_ring(generator: np.random.Generator) -> Mesh:
    """Return a ring of square section with round edges, its section twisted by half a turn."""
    phase, ring_radius = generator.uniform([0, 0.62], [np.pi, 0.68])

    def field(points: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, z = np.moveaxis(points, -1, 0)
        # A square looks the same after half a turn, so that the ring closes.
        twist = np.arctan2(y, x) / 2 + phase
        out = np.hypot(x, y) - ring_radius
        across = np.cos(twist) * out + np.sin(twist) * z
        along = np.cos(twist) * z - np.sin(twist) * out
        return np.asarray((across**4 + along**4) ** 0.25 - 0.22)

    return surface_of(field, cells=160).fitted()


FIGURES: Final[dict[str, Callable[[np.random.Generator], Mesh]]] = {
    "pebble": pebble,
    "vertebra": vertebra,
    "dolphin": dolphin,
    "bull": bull,
    "doll": doll,
    "knot": knot,
    "twisted-ring": twisted_ring,
}
"""By name; the first four, from simple to complex, stand for the skull, the vertebrae, the dolphin
and the bull of Lopez-Moreno 2011, sec. 7.5.1."""


def _limb(generator: np.random.Generator, points: Points, radii: list[float]) -> Field:
    thickness = generator.uniform(1 - _VARIATION, 1 + _VARIATION)
    shifts = generator.uniform(-_VARIATION, _VARIATION, size=3) / 2
    return tube(np.array(points) + shifts, np.array(radii) * thickness)


def _pair(
    generator: np.random.Generator, points: Points, radii: list[float], axis: int = 0
) -> list[Field]:
    """Return a limb and its image on the body's other side."""
    mirror = np.where(np.arange(3) == axis, -1.0, 1.0)
    mirrored = [(x * mirror[0], y * mirror[1], z * mirror[2]) for x, y, z in points]
    return [_limb(generator, points, radii), _limb(generator, mirrored, radii)]


def _figure(parts: list[Field], softness: float) -> Mesh:
    return surface_of(smooth_union(parts, softness), cells=192, reach=1.3).fitted()
