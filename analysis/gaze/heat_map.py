"""Heat maps: how long each place of an image was looked at."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.errors import InputError
from analysis.estimates import software_version

SIGMA_DEG = 1.0


@dataclass(frozen=True)
class HeatMap:
    """How long each place of an image was looked at.

    Attributes
    ----------
    density
        Shape (height, width), float32: the share of the time, summing to 1 over the image.
    sigma_deg
        The standard deviation of the Gaussian that spreads each fixation.
    duration_s, fixations
        How long was looked at the image, in how many fixations.
    outside
        Fixations beside the image, which are left out.
    version
        By which Trompe.
    """

    density: NDArray[np.float32]
    sigma_deg: float
    duration_s: float
    fixations: int
    outside: int
    version: str
    method: str = "fixations weighted by duration, Gaussian"


def heat_map(
    table: pd.DataFrame,
    shape: tuple[int, int],
    pixels_per_degree: float,
    *,
    sigma_deg: float = SIGMA_DEG,
) -> HeatMap:
    """Return where an image was looked at.

    Parameters
    ----------
    table
        Rows of `Fixations.table`, of one participant or many; only rows of trials that showed the
        image make sense.
    shape
        Height and width of the image in pixels.
    pixels_per_degree
        Of the image as shown, above 0.
    sigma_deg
        Above 0: 1 degree is about what the fovea sees and what trackers are wrong by (Blignaut
        2010).

    Raises
    ------
    InputError
        If no fixation is on the image, or an argument is impossible.
    """
    if min(shape) < 1 or not pixels_per_degree > 0 or not sigma_deg > 0:
        raise InputError("shape, pixels_per_degree, sigma_deg: numbers above 0 accepted")
    row, column, inside = image_pixels(table, shape)
    duration_s = table["duration_s"].to_numpy(float)[inside]
    if not len(duration_s):
        raise InputError("table: no fixation on the image, one or more accepted")
    weights = np.zeros(shape)
    np.add.at(weights, (row[inside], column[inside]), duration_s)
    spread = ndimage.gaussian_filter(weights, sigma_deg * pixels_per_degree, mode="constant")
    return HeatMap(
        density=(spread / spread.sum()).astype(np.float32),
        sigma_deg=sigma_deg,
        duration_s=float(duration_s.sum()),
        fixations=len(duration_s),
        outside=int((~inside).sum()),
        version=software_version(),
    )


def image_pixels(
    table: pd.DataFrame, shape: tuple[int, ...]
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
    """Return the row and column of each fixation, and whether it is on the image.

    Parameters
    ----------
    table
        Rows of `Fixations.table`.
    shape
        Height and width of the image in pixels.
    """
    row, column = (
        np.floor(table[name].to_numpy(float)).astype(np.intp) for name in ("y_px", "x_px")
    )
    inside = (row >= 0) & (row < shape[0]) & (column >= 0) & (column < shape[1])
    return row, column, inside
