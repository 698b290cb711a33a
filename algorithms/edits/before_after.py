"""A picture before and after an edit, side by side."""

from typing import Final

import numpy as np
from PIL import Image

from algorithms.color import FloatImage, luminance, srgb_digits

_GAP_PX: Final = 8
_GREATEST_SIDE_PX: Final = 1200
_BRIGHT: Final = 0.995
_PAPER: Final = (246, 246, 244)


def before_after(before: FloatImage, after: FloatImage) -> Image.Image:
    """Put two pictures side by side, at one exposure and at most 1,200 pixels wide or high each.

    A picture that is brighter than what a display shows is darkened until 99.5 % of the first one's
    pixels fit.

    Parameters
    ----------
    before, after
        Linear light of 0 or more, `(height, width, 3)`, of one size.
    """
    bright = float(np.quantile(luminance(before), _BRIGHT))
    exposure = np.float32(1 / bright if before.max() > 1 and bright > 0 else 1)
    pictures = [_shown(image, exposure) for image in (before, after)]
    width, height = pictures[0].size
    sheet = Image.new("RGB", (2 * width + _GAP_PX, height), _PAPER)
    sheet.paste(pictures[0], (0, 0))
    sheet.paste(pictures[1], (width + _GAP_PX, 0))
    return sheet


def _shown(image: FloatImage, exposure: np.float32) -> Image.Image:
    picture = Image.fromarray(srgb_digits(image * exposure))
    picture.thumbnail((_GREATEST_SIDE_PX, _GREATEST_SIDE_PX), Image.Resampling.LANCZOS)
    return picture
