"""Filters that keep edges, for kernels of any size."""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.errors import InputError

Array = NDArray[np.float64]

_CELLS: Final = 2.0
_STRIP_PX: Final = 1 << 18


def bilateral(
    values: NDArray[np.floating[Any]],
    sigma_px: float,
    sigma_range: float,
    *,
    mask: NDArray[np.bool_] | None = None,
    guide: NDArray[np.floating[Any]] | None = None,
    cells_per_sigma: float = _CELLS,
) -> NDArray[np.float32]:
    """Average over neighbours in space whose guide is alike.

    Parameters
    ----------
    values
        `(height, width)`.
    sigma_px
        Standard deviation in space, pixels, more than 0; the larger, the faster.
    sigma_range
        Standard deviation in the guide's unit, more than 0.
    mask
        bool `(height, width)`: which pixels count, and are filtered; None for all.
    guide
        `(height, width)`: what decides whether pixels are alike; None for the values themselves.
    cells_per_sigma
        How fine the grid is; 1 for a quick look.

    Returns
    -------
    float32 `(height, width)`, 0 outside the mask.

    Raises
    ------
    InputError
        If shapes differ, a value in the mask is not finite, or a standard deviation is not
        more than 0.

    Notes
    -----
    The bilateral grid (Chen, Paris and Durand 2007): pixels fall into cells of space and guide, the
    cells are blurred, and read between. Its time hardly depends on `sigma_px`.
    """
    inside = np.ones(np.shape(values), bool) if mask is None else np.asarray(mask, bool)
    guide = values if guide is None else guide
    _check(values, sigma_px, sigma_range, inside, guide)
    smooth = np.zeros(values.shape, dtype=np.float32)
    if not inside.any():
        return smooth
    sigmas = np.array([sigma_px, sigma_px, sigma_range])
    steps = np.maximum(sigmas / cells_per_sigma, [1, 1, 0])
    grid = _Grid(guide, inside, steps)
    sums, counts = (
        ndimage.gaussian_filter(cells, sigmas / steps, mode="constant")
        for cells in grid.filled(values)
    )
    for strip in grid.strips():
        places = grid.places(strip)
        weight = ndimage.map_coordinates(counts, places, order=1)
        mean = ndimage.map_coordinates(sums, places, order=1) / np.maximum(weight, 1e-12)
        smooth.reshape(-1)[strip] = mean
    return smooth


class _Grid:
    """The cells of space and guide, and which of them a pixel is in.

    Parameters
    ----------
    guide
        `(height, width)`.
    inside
        bool `(height, width)`: the pixels that fall into cells.
    steps
        The size of a cell in rows, columns and guide.
    """

    def __init__(
        self, guide: NDArray[np.floating[Any]], inside: NDArray[np.bool_], steps: Array
    ) -> None:
        self._guide = guide.reshape(-1)
        self._width_px = guide.shape[1]
        self._chosen = np.flatnonzero(inside)
        self._steps = steps[:, None]
        within = guide[inside]
        lowest, highest = (float(end) / steps[2] for end in (within.min(), within.max()))
        # One cell is left free on each side, for reading between cells.
        self._offset = np.array([[1.0], [1.0], [1.0 - np.floor(lowest)]])
        extents = [*(np.array(guide.shape) / steps[:2]), highest - np.floor(lowest)]
        self._shape = tuple(int(np.ceil(extent)) + 3 for extent in extents)

    def strips(self) -> Iterator[NDArray[np.intp]]:
        """Yield the indices of the pixels, some at a time: their places take a lot of memory."""
        for start in range(0, self._chosen.size, _STRIP_PX):
            yield self._chosen[start : start + _STRIP_PX]

    def places(self, strip: NDArray[np.intp]) -> Array:
        """Return where pixels are in the grid, `(3, n)`, in cells."""
        rows, columns = np.divmod(strip, self._width_px)
        places = np.stack([rows, columns, self._guide[strip]]) / self._steps + self._offset
        return np.asarray(places)

    def filled(self, values: NDArray[np.floating[Any]]) -> tuple[Array, Array]:
        """Return sum and number of the values that fall into each cell."""
        flat, size = values.reshape(-1), int(np.prod(self._shape))
        sums, counts = np.zeros(size), np.zeros(size)
        for strip in self.strips():
            cells = np.round(self.places(strip)).astype(int)
            index = np.ravel_multi_index(tuple(cells), self._shape)
            sums += np.bincount(index, flat[strip], minlength=size)
            counts += np.bincount(index, minlength=size)
        return sums.reshape(self._shape), counts.reshape(self._shape)


def _check(
    values: NDArray[np.floating[Any]],
    sigma_px: float,
    sigma_range: float,
    inside: NDArray[np.bool_],
    guide: NDArray[np.floating[Any]],
) -> None:
    if values.ndim != 2:
        raise InputError(f"values: (height, width) is accepted, not {values.shape}")
    for name, plane in (("mask", inside), ("guide", guide)):
        if plane.shape != values.shape:
            raise InputError(f"{name}: {values.shape} is accepted, not {plane.shape}")
    for name, sigma in (("sigma_px", sigma_px), ("sigma_range", sigma_range)):
        if not 0 < sigma < np.inf:
            raise InputError(f"{name}: a finite number of more than 0 is accepted, not {sigma}")
    for name, plane in (("values", values), ("guide", guide)):
        if not np.isfinite(plane[inside]).all():
            raise InputError(f"{name}: finite values are accepted")
