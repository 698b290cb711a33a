"""The one exposure of a set: from scene-referred radiance to pictures that are hardly clipped."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.color import FloatImage
from algorithms.errors import InputError
from algorithms.images import read_image, write_image

CLIPPED_SHARE: Final = 0.0005
"""The share of a set's pixels that an exposure aims to clip; the design accepts 0.001."""


def exposure_for(
    images: Iterable[NDArray[np.floating[Any]]], share: float = CLIPPED_SHARE
) -> float:
    """Return the exposure at which a share of all pixels is clipped.

    Parameters
    ----------
    images
        Radiance, `(height, width, 3)` each; small versions of a set's images, without much noise.
    share
        Of pixels that may reach the top of the scale in one channel or more, 0 to 1.

    Raises
    ------
    InputError
        If there is no image, or all of them are dark.
    """
    peaks = [np.asarray(image).max(axis=-1).ravel() for image in images]
    top = float(np.quantile(np.concatenate(peaks), 1 - share)) if peaks else 0.0
    if not 0 < top < np.inf:
        raise InputError("images: one or more with light in them are accepted; is there no light?")
    return 1 / top


def clipped_share(files: Iterable[Path]) -> float:
    """Return the share of the pixels of pictures that reached the top of the scale, 0..1."""
    return float(np.mean([(read_image(file) >= 1).any(axis=-1).mean() for file in files]))


def write_shown(
    path: Path,
    radiance: FloatImage,
    exposure: float,
    coverage: NDArray[np.floating[Any]] | None = None,
    background: float = 0.0,
) -> None:
    """Write an image as it is shown.

    Parameters
    ----------
    path
        Ends in .png.
    radiance
        `(height, width, 3)`, zero where there is no object.
    exposure
        The set's.
    coverage
        The share of each pixel that objects cover, `(height, width)`; None where all is covered.
    background
        Display-referred linear light behind the objects.
    """
    shown = radiance * np.float32(exposure)
    if coverage is not None:
        shown = shown + (1 - coverage[..., None]).astype(np.float32) * np.float32(background)
    write_image(path, shown)
