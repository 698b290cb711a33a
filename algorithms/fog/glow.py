"""The glow around lights in fog: the picture spread by the point-spread function, by depth.

The function depends on the optical thickness of the fog in front of each pixel. The picture is
convolved with it at a few thicknesses, on a coarse copy, as the function is wide and smooth; each
pixel reads between the two nearest. So there are no layers to be seen (Lopez-Moreno 2011, fig. 6.8,
has three regions of depth instead).
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from algorithms.fog.apsf import apsf_kernel
from algorithms.fog.parameters import Fog

Plane = NDArray[np.float32]

_THICKNESSES: Final = np.array([1.05, 1.3, 1.8, 2.8, 5.0])
_COARSE_PX: Final = 192


class Coarse:
    """A coarse copy of a picture, filled row by row.

    Parameters
    ----------
    shape
        Height and width of the picture.
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        self.cell_px = max(1, -(-max(shape) // _COARSE_PX))
        self.means = np.zeros((*(-(-extent // self.cell_px) for extent in shape), 3), np.float32)

    def add(self, first_row: int, pixels: Plane) -> None:
        """Add rows of the picture, the first one being a multiple of `cell_px`."""
        rows, columns = (np.arange(0, extent, self.cell_px) for extent in pixels.shape[:2])
        sums = np.add.reduceat(np.add.reduceat(pixels, rows, axis=0), columns, axis=1)
        heights, widths = (
            np.diff(starts, append=extent)
            for starts, extent in zip((rows, columns), pixels.shape[:2], strict=True)
        )
        start = first_row // self.cell_px
        self.means[start : start + rows.size] = sums / (heights[:, None] * widths)[..., None]


class Glow:
    """The spread picture at several optical thicknesses.

    Parameters
    ----------
    coarse
        The picture.
    width_px
        Its width.
    fog
        The medium.
    field_of_view_deg
        Horizontal angle of view.
    """

    def __init__(self, coarse: Coarse, width_px: int, fog: Fog, field_of_view_deg: float) -> None:
        self._cell_px = coarse.cell_px
        rows, columns = coarse.means.shape[:2]
        half = np.radians(field_of_view_deg) / 2
        focal_length = width_px / coarse.cell_px / 2 / np.tan(half)
        # Beyond its border the picture is taken to go on as its mirror image.
        mirrored = np.pad(coarse.means, ((rows, rows), (columns, columns), (0, 0)), "symmetric")
        shape = mirrored.shape[:2]
        spectrum = fft.rfft2(mirrored, axes=(0, 1), workers=2)
        spread = []
        for thickness in _THICKNESSES:
            kernel = apsf_kernel(
                shape, focal_length, thickness, fog.forward_scattering, fog.glow_scale
            )
            product = spectrum * fft.rfft2(kernel)[..., None]
            plane = fft.irfft2(product, s=shape, axes=(0, 1), workers=2)
            spread.append(plane[rows : 2 * rows, columns : 2 * columns])
        before, after, share = _between(width_px, coarse.cell_px, columns)
        planes = np.maximum(np.stack(spread), 0)
        share = share[:, None]
        self._planes = (1 - share) * planes[:, :, before] + share * planes[:, :, after]

    def rows(self, first_row: int, optical_thickness: Plane) -> Plane:
        """Return rows of the spread picture, each pixel at its own thickness.

        Parameters
        ----------
        first_row
            Where they begin.
        optical_thickness
            `(n, width)`, 0 or more, also infinite.

        Returns
        -------
        float32 `(n, width, 3)`.
        """
        count = first_row + len(optical_thickness)
        before, after, share = (
            each[first_row:] for each in _between(count, self._cell_px, self._planes.shape[1])
        )
        share = share[:, None, None]
        place = np.interp(optical_thickness, _THICKNESSES, np.arange(_THICKNESSES.size))
        total = np.zeros((*optical_thickness.shape, 3), dtype=np.float32)
        for number, plane in enumerate(self._planes):
            weight = np.maximum(1 - np.abs(place - number), 0).astype(np.float32)
            if weight.any():
                total += weight[..., None] * ((1 - share) * plane[before] + share * plane[after])
        return total


def _between(
    extent_px: int, cell_px: int, cells: int
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.float32]]:
    """Return for each pixel the cells whose centres are next to it, and the share of the second."""
    place = np.clip((np.arange(extent_px) + 0.5) / cell_px - 0.5, 0, cells - 1)
    before = np.minimum(place.astype(np.intp), max(cells - 2, 0))
    return before, np.minimum(before + 1, cells - 1), (place - before).astype(np.float32)
