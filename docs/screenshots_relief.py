"""Make docs/pictures/relief.jpg: what is guessed of shapes, as in fig. 4.2 of Lopez-Moreno 2011.

    python -m docs.screenshots_relief

Of two objects in photographs that scikit-image ships, from left to right: the object, normals of
the outline alone spread over it (Lumo), of the inflated silhouette, and of the perceptual relief;
then the perceptual relief lit from the upper left.
"""

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from skimage import data

from algorithms.color import decode_srgb
from algorithms.depth import (
    contour_normals,
    perceptual_relief,
    relief_normals,
    silhouette_relief,
)
from algorithms.images import write_picture
from algorithms.light import Light
from docs.screenshots_edits import mask_of

PICTURE: Final = Path(__file__).parent / "pictures" / "relief.jpg"
OBJECTS: Final = {"cup": data.coffee, "tank": lambda: data.stereo_motorcycle()[0]}
HEIGHT_PX: Final = 230
LIGHT: Final = Light(azimuth_deg=135, elevation_deg=40)
PAPER: Final = 0.96


def row(name: str) -> Image.Image:
    """Return the pictures of one object, side by side."""
    photograph = np.asarray(OBJECTS[name]())
    mask = mask_of(name, photograph.shape)
    image = decode_srgb(photograph / 255).astype(np.float32)
    perceptual = relief_normals(perceptual_relief(image, mask), mask)
    normals = (
        contour_normals(mask),
        relief_normals(silhouette_relief(mask), mask),
        perceptual,
    )
    lit = np.repeat(np.maximum(perceptual @ LIGHT.direction, 0)[..., None], 3, axis=2)
    pictures = [photograph / 255, *((each + 1) / 2 for each in normals), lit]
    return _beside([_cut(np.asarray(each), mask) for each in pictures])


def _cut(picture: NDArray[np.floating], mask: NDArray[np.bool_]) -> Image.Image:
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    box = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    shown = np.where(mask[box][..., None], picture[box], PAPER)
    digits = Image.fromarray(np.round(shown * 255).clip(0, 255).astype(np.uint8))
    width_px = round(digits.width * HEIGHT_PX / digits.height)
    return digits.resize((width_px, HEIGHT_PX), Image.Resampling.LANCZOS)


def _beside(pictures: list[Image.Image]) -> Image.Image:
    sheet = Image.new("RGB", (sum(each.width + 8 for each in pictures), HEIGHT_PX), (245,) * 3)
    x = 0
    for each in pictures:
        sheet.paste(each, (x, 0))
        x += each.width + 8
    return sheet


def main() -> None:
    """Save the sheet."""
    rows = [row(name) for name in OBJECTS]
    sheet = Image.new("RGB", (max(each.width for each in rows), len(rows) * (HEIGHT_PX + 8)))
    sheet.paste((245, 245, 245), (0, 0, *sheet.size))
    for number, each in enumerate(rows):
        sheet.paste(each, (0, number * (HEIGHT_PX + 8)))
    sheet.thumbnail((1400, 1400), Image.Resampling.LANCZOS)
    write_picture(PICTURE, sheet)


if __name__ == "__main__":
    main()
