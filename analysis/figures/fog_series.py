"""Pictures in fog of the published parameters: Lopez-Moreno 2011, fig. 6.6 and 6.16."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from algorithms.color import FloatImage, encode_srgb
from algorithms.depth import scaled_distance
from algorithms.fog import PRESETS, Fog, add_fog, white_level
from analysis.figures.style import SETTINGS

PUBLISHED_COEFFICIENTS: Final = ((0.2, 0.2), (0.44, 0.5), (0.75, 0.9))
"""sigma and k of fig. 6.6, a to c."""

_PANEL_INCHES: Final = 2.6
_TITLE_INCHES: Final = 0.3


@dataclass(frozen=True)
class Scene:
    """A picture, linear light, and the distance of what it shows, `(height, width)`."""

    image: FloatImage
    distance: NDArray[np.float32]


def published_series() -> dict[str, Fog]:
    """Return fog of the coefficients of fig. 6.6, by name."""
    return {
        f"sigma = {sigma}, k = {k}": Fog(k, sigma, desaturation=k)
        for sigma, k in PUBLISHED_COEFFICIENTS
    }


def presets_of(picture: str) -> dict[str, Fog]:
    """Return the fog of table 6.1 for one of its pictures: house, forest or statue."""
    return {name: fog for name, fog in PRESETS.items() if name.startswith(picture)}


def fog_series_figure(
    scenes: Mapping[str, Scene], fogs: Mapping[str, Fog], generator: np.random.Generator
) -> Figure:
    """Draw scenes without and with fog, side by side.

    Parameters
    ----------
    scenes
        By name: one row each. Distances are scaled to 0..1, as the published parameters are.
    fogs
        By name: one column each, after the picture as it was.
    generator
        Draws the clouds; the same in all pictures.
    """
    seed = int(generator.integers(2**32))
    columns = 1 + len(fogs)
    heights = [scene.image.shape[0] / scene.image.shape[1] for scene in scenes.values()]
    with mpl.rc_context(SETTINGS):
        size = (_PANEL_INCHES * columns, _PANEL_INCHES * sum(heights) + _TITLE_INCHES)
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.subplots(len(scenes), columns, squeeze=False, height_ratios=heights)
        for axes, title in zip(grid[0], ("as it was", *fogs), strict=True):
            axes.set_title(title)
        for row, (name, scene) in zip(grid, scenes.items(), strict=True):
            row[0].set_ylabel(name)
            distance = scaled_distance(scene.distance)
            pictures = [scene.image]
            for fog in fogs.values():
                clouds = np.random.default_rng(seed)
                pictures.append(add_fog(scene.image, distance, fog, generator=clouds))
            exposure = min(1.0, 1 / white_level(scene.image))
            for axes, picture in zip(row, pictures, strict=True):
                axes.imshow(encode_srgb(picture * exposure))
                axes.set_xticks([])
                axes.set_yticks([])
    return figure
