"""How the number of directions makes caustics more complex: Lopez-Moreno 2011, fig. 7.6."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from algorithms.caustics import caustic_map
from algorithms.depth.inflation import bounding_box

PUBLISHED_DIRECTIONS: Final = (1, 2, 4, 12, 20)

_PANEL_INCHES: Final = 1.55
_TITLE_INCHES: Final = 0.3
_RESPONSE_EXPONENT: Final = 1 / 2.2  # light as it would look


@dataclass(frozen=True)
class Shape:
    """What caustics are made from: the relief, pixels, and the mask of an object."""

    relief: NDArray[np.floating[Any]]
    mask: NDArray[np.bool_]


def caustic_maps_figure(
    shapes: Mapping[str, Shape], directions: Sequence[int] = PUBLISHED_DIRECTIONS
) -> Figure:
    """Draw objects' reliefs and their maps of caustics, side by side.

    Parameters
    ----------
    shapes
        By name: one row each.
    directions
        Numbers of directions: one column each, after the relief.
    """
    columns = 1 + len(directions)
    size = (_PANEL_INCHES * columns, _PANEL_INCHES * len(shapes) + _TITLE_INCHES)
    figure = Figure(figsize=size, layout="constrained")
    grid = figure.subplots(len(shapes), columns, squeeze=False)
    titles = ["relief", *(f"d = {count}" for count in directions)]
    for axes, title in zip(grid[0], titles, strict=True):
        axes.set_title(title, fontsize=9)
    for row, (name, shape) in zip(grid, shapes.items(), strict=True):
        row[0].set_ylabel(name, fontsize=9)
        heights = np.where(shape.mask, shape.relief, 0)[bounding_box(shape.mask)]
        pictures = [heights / heights.max()]
        pictures += list(caustic_map(shape.relief, shape.mask, directions) ** _RESPONSE_EXPONENT)
        for axes, picture in zip(row, pictures, strict=True):
            _show(axes, picture)
    return figure


def _show(axes: Axes, picture: NDArray[np.floating[Any]]) -> None:
    """Show a picture in a square, black around it."""
    rows, columns = picture.shape
    side = max(rows, columns)
    axes.imshow(picture, cmap="gray", vmin=0, vmax=1, extent=(0, columns, rows, 0))
    axes.set_xlim((columns - side) / 2, (columns + side) / 2)
    axes.set_ylim((rows + side) / 2, (rows - side) / 2)
    axes.set_facecolor("black")
    axes.set_xticks([])
    axes.set_yticks([])
