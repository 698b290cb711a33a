"""Depth from outside: distance or disparity from PNG, TIFF, OpenEXR and NumPy files."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.deep_images import bits_per_channel, read_deep, size_px
from algorithms.errors import InputError
from algorithms.images import MAX_PIXELS, read_channels

_DIGITS: Final = (".png", ".tif", ".tiff")
_ARRAYS: Final = (".npy", ".npz")
_SUFFIXES: Final = (*_DIGITS, ".exr", *_ARRAYS)


@dataclass(frozen=True)
class Stereo:
    """How disparity becomes distance: `baseline * focal_px / (disparity + offset_px)`.

    Attributes
    ----------
    focal_px
        The focal length in pixels, more than 0.
    baseline
        Between the cameras, more than 0; distance has its unit.
    offset_px
        The difference of the principal points in x, which is added to every disparity.
    """

    focal_px: float
    baseline: float
    offset_px: float = 0.0

    def __post_init__(self) -> None:
        for name in ("focal_px", "baseline"):
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"{name}: a finite number of more than 0 is accepted")
        if not np.isfinite(self.offset_px):
            raise InputError("offset_px: a finite number is accepted")

    def distance(
        self, disparity_px: NDArray[np.floating[Any]]
    ) -> tuple[NDArray[np.floating[Any]], NDArray[np.bool_]]:
        """Return distances, and where they are known: where disparities are finite and not behind.

        Parameters
        ----------
        disparity_px
            Of any shape.
        """
        shifted = disparity_px + self.offset_px
        known = (shifted > 0) & np.isfinite(shifted)
        return self.baseline * self.focal_px / np.where(known, shifted, 1), known


def read_distance(
    path: str | Path, *, scale: float = 1.0, stereo: Stereo | None = None
) -> NDArray[np.float32]:
    """Read the distance of every pixel from the camera.

    Parameters
    ----------
    path
        A grey PNG or TIFF of 8 or 16 bits (the digits are distances, 0 stands for unknown), a TIFF
        or OpenEXR file of one channel, or a NumPy array `(height, width)`: .npy, or the only one of
        an .npz.
    scale
        Distances, or disparities, are the file's values times this; more than 0.
    stereo
        If the file holds disparities in pixels.

    Returns
    -------
    float32 `(height, width)`, larger is farther; infinite where the file says so, as for the sky.
    Unknown pixels (not a number, or not more than 0) take the value of the nearest known one.

    Raises
    ------
    InputError
        If the file is not as described, or nothing in it is known.
    """
    path = Path(path)
    if not 0 < scale < np.inf:
        raise InputError("scale: a finite number of more than 0 is accepted")
    values = _values(path).astype(np.float64) * scale
    distance: NDArray[np.floating[Any]]
    if stereo is None:
        known = values > 0
        distance = values
    else:
        distance, known = stereo.distance(values)
    if not known.any():
        raise InputError(f"{path}: no pixel has a distance; numbers of more than 0 are accepted")
    return fill_unknown(distance, known).astype(np.float32)


def read_relief(path: str | Path, *, scale: float = 1.0) -> NDArray[np.float32]:
    """Read the relief of an object, in pixels, larger is nearer.

    Parameters
    ----------
    path
        As for `read_distance`; here 0 is a value, and only what is not a number is unknown.
    scale
        Pixels are the file's values times this; negative where the file grows with distance.

    Returns
    -------
    float32 `(height, width)`, not a number where unknown.

    Raises
    ------
    InputError
        If the file is not as described.
    """
    path = Path(path)
    if not np.isfinite(scale) or scale == 0:
        raise InputError("scale: a finite number other than 0 is accepted")
    values = (_values(path).astype(np.float64) * scale).astype(np.float32)
    values[~np.isfinite(values)] = np.nan
    return values


def fill_unknown(
    values: NDArray[np.floating[Any]], known: NDArray[np.bool_]
) -> NDArray[np.floating[Any]]:
    """Give unknown pixels the value of the nearest known one."""
    if known.all():
        return values
    nearest = ndimage.distance_transform_edt(~known, return_distances=False, return_indices=True)
    return np.asarray(values[tuple(nearest)])


def _values(path: Path) -> NDArray[np.floating[Any]]:
    """Return the numbers of a file, `(height, width)`."""
    suffix = path.suffix.lower()
    if suffix not in _SUFFIXES:
        raise InputError(f"{path}: a file ending in {', '.join(_SUFFIXES)} is accepted")
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    if suffix in _ARRAYS:
        values = _array(path)
    elif suffix == ".exr":
        values = read_channels(path)
    else:
        values = _digits(path)
    if values.ndim == 3 and values.shape[2] == 1:
        values = values[..., 0]
    if values.ndim != 2 or values.size == 0:
        raise InputError(f"{path}: one channel is accepted, not {values.shape}")
    return values


def _digits(path: Path) -> NDArray[np.float32]:
    width_px, height_px = size_px(path)
    if width_px * height_px > MAX_PIXELS:
        raise InputError(
            f"{path}: {width_px} x {height_px} pixels; at most {MAX_PIXELS} pixels are accepted"
        )
    bits = bits_per_channel(path)
    values = read_deep(path)
    return values if bits == 32 else np.round(values * np.float32(2**bits - 1))


def _array(path: Path) -> NDArray[np.floating[Any]]:
    try:
        loaded = np.load(path, allow_pickle=False)
        if isinstance(loaded, np.ndarray):
            arrays = {path.name: loaded}
        else:
            with loaded:
                arrays = {name: loaded[name] for name in loaded.files}
    except (OSError, ValueError, EOFError) as error:
        raise InputError(f"{path}: not a readable NumPy file") from error
    if len(arrays) != 1:
        raise InputError(f"{path}: a file of one array is accepted, not of {', '.join(arrays)}")
    (values,) = arrays.values()
    if values.dtype.kind not in "fiu":
        raise InputError(f"{path}: real numbers are accepted, not {values.dtype}")
    return np.asarray(values, dtype=np.float64)
