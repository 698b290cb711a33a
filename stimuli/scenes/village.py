"""What people put beside a lane: houses, a church, street lamps, marker posts and a fence.

Metres; each thing stands on the origin with y up, its front towards +z.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from stimuli.shapes.mesh import Mesh
from stimuli.shapes.solids import box, gable, merged, polygons, tube

LAMP_RADIUS: Final = 0.09
"""Of the globe of a street lamp."""

LAMP_HEIGHT: Final = 4.2
"""Of that globe's centre above the ground."""

POST_HEIGHT: Final = 1.0


@dataclass(frozen=True)
class House:
    """The parts of a house, by what they are made of.

    Attributes
    ----------
    walls, roof, frames
        Walls with their chimney; roof; frames of windows and door.
    panes, lit
        Dark windows with the door; windows with light behind them.
    """

    walls: Mesh
    roof: Mesh
    frames: Mesh
    panes: Mesh
    lit: Mesh


def house(
    width: float = 7.5,
    height: float = 3.0,
    depth: float = 10.0,
    lit_windows: Sequence[int] = (0,),
) -> House:
    """Return a house with its gable to the front.

    Parameters
    ----------
    width, height, depth
        Of the walls; the ridge is 0.42 widths higher.
    lit_windows
        Which windows have light behind them, one or more: 0 and 1 in the front, 2 above them, 3 to
        5 on the right side, 6 to 8 on the left side.
    """
    rise = 0.42 * width
    chimney = box((0.6, 1.6, 0.6), (width * 0.18, height + 0.75 * rise + 0.3, depth * 0.15))
    windows = _windows(width, height, depth)
    frames = [_frame(corners) for corners in windows]
    door = _standing((-0.1 * width + 1.0, 0.0), (1.0, 2.1), depth / 2 + 0.03)
    lit = [windows[i] for i in lit_windows]
    dark = [corners for i, corners in enumerate(windows) if i not in lit_windows]
    return House(
        merged([gable((width, height, depth), rise), chimney]),
        _roof(width, height, depth, rise),
        merged(frames),
        polygons([*dark, door]),
        polygons(lit),
    )


def _standing(foot: tuple[float, float], size: tuple[float, float], front: float) -> np.ndarray:
    """Return the corners of an upright rectangle that faces +z."""
    (x, y), (width, height) = foot, size
    return np.array(
        [
            (x - width / 2, y, front),
            (x + width / 2, y, front),
            (x + width / 2, y + height, front),
            (x - width / 2, y + height, front),
        ]
    )


def _windows(width: float, height: float, depth: float) -> list[np.ndarray]:
    front = depth / 2 + 0.04
    found = [_standing((side * width * 0.29, 0.95), (0.95, 1.25), front) for side in (-1, 1)]
    found.append(_standing((0, height + 0.45), (0.85, 1.05), front))
    for quarter in (1, 3):  # turns of the front onto the right and the left side
        turn = _quarter_turns(quarter)
        for place in (-0.3, 0.0, 0.3):
            foot = (place * depth, 0.95)
            found.append(_standing(foot, (0.95, 1.25), width / 2 + 0.04) @ turn.T)
    return found


def _quarter_turns(count: int) -> np.ndarray:
    """Return the rotation about y by quarters of a turn, that brings +z to +x."""
    quarter = np.array([(0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0)])
    return np.asarray(np.linalg.matrix_power(quarter, count))


def _frame(corners: np.ndarray) -> Mesh:
    """Return bars around a window and across it."""
    across, up = corners[1] - corners[0], corners[3] - corners[0]
    bars = [(corners[i], corners[(i + 1) % 4]) for i in range(4)]
    bars.append((corners[0] + across / 2, corners[3] + across / 2))
    bars.append((corners[0] + up / 2, corners[1] + up / 2))
    return merged([tube(bar, 0.045, sides=4) for bar in bars])


def _roof(width: float, height: float, depth: float, rise: float) -> Mesh:
    """Return two slabs that lean on each other and stand over the walls."""
    slope = np.arctan2(rise, width / 2)
    length = np.hypot(rise, width / 2) + 0.5
    slab = box((length, 0.16, depth + 0.8), (-length / 2 + 0.05, 0.09, 0))
    cosine, sine = np.cos(slope), np.sin(slope)
    lean = np.array([(cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0)])
    left = slab.rotated(lean).moved(np.array([0, height + rise, 0]))
    return merged([left, left.rotated(_quarter_turns(2))])


def church() -> tuple[Mesh, Mesh]:
    """Return a church's walls, and its roof with the spire."""
    nave = gable((9.0, 6.5, 18.0), 5.0).moved(np.array([0, 0, -13.0]))
    tower = box((5.5, 17.0, 5.5), (0, 8.5, -2.0))
    roof = _roof(9.0, 6.5, 18.0, 5.0).moved(np.array([0, 0, -13.0]))
    corners = np.array([(-3.1, 17, 1.1), (3.1, 17, 1.1), (3.1, 17, -5.1), (-3.1, 17, -5.1)])
    tip = np.array([0, 29.0, -2.0])
    spire = polygons([*((corners[i], corners[(i + 1) % 4], tip) for i in range(4)), corners[::-1]])
    louvres = [_standing((0, 12.5), (1.5, 2.6), 0.78)]
    return merged([nave, tower]), merged([roof, spire, polygons(louvres)])


def lamp_post() -> Mesh:
    """Return the post of a street lamp with the collar and the hood of its globe."""
    pole = [(0, 0, 0), (0, 0.5, 0), (0, 0.55, 0), (0, LAMP_HEIGHT - LAMP_RADIUS, 0)]
    collar = LAMP_HEIGHT - LAMP_RADIUS * 0.93
    hood = LAMP_HEIGHT + LAMP_RADIUS * 0.8
    return merged(
        [
            tube(pole, [0.09, 0.09, 0.055, 0.04], 12),
            tube([(0, collar - 0.1, 0), (0, collar, 0)], [0.03, 0.1], 12),
            tube([(0, hood, 0), (0, hood + 0.1, 0), (0, hood + 0.16, 0)], [0.15, 0.07, 0.02], 16),
        ]
    )


def marker_post() -> tuple[Mesh, Mesh]:
    """Return the white and the black part of a post that marks the edge of a lane."""
    size, band = 0.13, (0.62, 0.84)
    white = [
        box((size, band[0], size), (0, band[0] / 2, 0)),
        box((size, POST_HEIGHT - band[1], size), (0, (POST_HEIGHT + band[1]) / 2, 0)),
    ]
    black = box((size, band[1] - band[0], size), (0, sum(band) / 2, 0))
    return merged(white), black


def fence(feet: np.ndarray) -> Mesh:
    """Return a fence of two rails along the feet of its posts, `(n, 3)`."""
    up = np.array([0.0, 1.0, 0.0])
    posts = [tube([foot - 0.1 * up, foot + 1.15 * up], 0.055, 6) for foot in feet]
    rails = [tube(feet + height * up, 0.04, 5) for height in (0.55, 0.98)]
    return merged([*posts, *rails])
