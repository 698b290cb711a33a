"""Masks from files: pictures that are white, and opaque, where an object is."""

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.images import read_image_and_alpha, require_size

_WHITE: Final = 0.2  # linear: about half of the way from black to white as displayed
_OPAQUE: Final = 0.5


def read_mask(path: Path, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Read a mask, bool, of an image's height and width.

    Raises
    ------
    InputError
        If its size is another one.
    """
    image, alpha = read_image_and_alpha(path)
    mask = np.asarray(image.max(axis=2) > _WHITE)
    if alpha is not None:
        mask &= alpha > _OPAQUE
    require_size(path, mask.shape, shape)
    return mask
