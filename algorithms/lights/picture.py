"""The picture that `trompe lights` writes: directions drawn over the image, lit spheres beside it.

Display-referred and for the eye: the image is scaled to a bright 1. An arrow points from the middle
of a probe to a light, the longer the closer that light is to the image plane, and is filled for a
light in front of the object and hollow for one behind it. Beside the image stands, for each probe,
a sphere lit by its lights.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from algorithms.color import FloatImage, luminance, srgb_digits
from algorithms.lights.estimate import LightEstimate

# Okabe and Ito 2008, as in all figures.
COLOURS: Final = ("#E69F00", "#56B4E9", "#009E73", "#CC79A7", "#F0E442", "#0072B2", "#D55E00")

_BRIGHT: Final = 99.0
_MARGIN: Final = 0.06
_LEAST_SIDE_PX: Final = 320
_BACKDROP: Final = 0.18


def light_picture(
    image: NDArray[np.floating[Any]],
    masks: Sequence[NDArray[np.bool_]],
    estimates: Sequence[LightEstimate],
) -> Image.Image:
    """Draw the lights of each probe over the image, and spheres lit by them beside it.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`.
    masks
        Of each probe, bool `(height, width)`.
    estimates
        Of each probe.

    Returns
    -------
    An RGB picture, the image on its left.
    """
    exposed = image / max(float(np.percentile(luminance(image), _BRIGHT)), 1e-9)
    left = Image.fromarray(srgb_digits(exposed))
    scale = max(1, -(-_LEAST_SIDE_PX // min(left.size)))
    left = left.resize((left.width * scale, left.height * scale))
    for number, (mask, estimate) in enumerate(zip(masks, estimates, strict=True)):
        _draw_probe(left, np.kron(mask, np.ones((scale, scale), bool)), estimate, number)
    side = min(left.height, max(_LEAST_SIDE_PX // 2, left.height // len(estimates)))
    columns = -(-len(estimates) * side // left.height)
    picture = Image.new("RGB", (left.width + columns * side, left.height))
    picture.paste(left)
    rows = max(1, left.height // side)
    for number, estimate in enumerate(estimates):
        sphere = _framed(lit_sphere(estimate, side), number)
        picture.paste(sphere, (left.width + number // rows * side, number % rows * side))
    return picture


def lit_sphere(estimate: LightEstimate, side_px: int) -> FloatImage:
    """Render a matt sphere under the lights found, float32 `(side_px, side_px, 3)`, 0..1.

    It is scaled so that its brightest point is 1, and stands before a grey backdrop.
    """
    places = (np.arange(side_px) + 0.5) / side_px * 2 - 1
    x, y = np.meshgrid(places / (1 - _MARGIN), -places / (1 - _MARGIN))
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0))
    normals = np.stack([x, y, z], axis=-1)
    shading = np.full(inside.shape, estimate.ambient)
    for light in estimate.lights:
        shading += light.intensity * np.maximum(normals @ light.direction, 0)
    shown = np.where(inside, shading / max(float(shading[inside].max()), 1e-12), _BACKDROP)
    return np.repeat(shown[..., None], 3, axis=2).astype(np.float32)


def _framed(sphere: FloatImage, number: int) -> Image.Image:
    picture = Image.fromarray(srgb_digits(sphere))
    ImageDraw.Draw(picture).rectangle(
        (1, 1, picture.width - 2, picture.height - 2), outline=_colour(number), width=3
    )
    return picture


def _draw_probe(
    picture: Image.Image, mask: NDArray[np.bool_], estimate: LightEstimate, number: int
) -> None:
    """Draw the outline of a probe and an arrow to each light."""
    pixels = np.array(picture)
    inner = mask.copy()
    width = max(1, round(min(mask.shape) / 250))
    for axis in (0, 1):
        for step in (-width, width):
            inner &= np.roll(mask, step, axis=axis)
    pixels[mask & ~inner] = tuple(
        int(_colour(number)[place : place + 2], 16) for place in (1, 3, 5)
    )
    picture.paste(Image.fromarray(pixels))
    rows, columns = np.nonzero(mask)
    centre = np.array([columns.mean(), rows.mean()])
    reach = 0.75 * float(np.sqrt(rows.size / np.pi))
    strongest = max((light.intensity for light in estimate.lights), default=1.0)
    for light in estimate.lights:
        along = light.direction[:2] * np.array([1, -1])
        thickness = max(2, round(reach / 14 * (0.4 + 0.6 * light.intensity / strongest)))
        _draw_arrow(
            ImageDraw.Draw(picture),
            centre,
            centre + reach * (0.25 * along / max(float(np.linalg.norm(along)), 1e-9) + along),
            thickness,
            _colour(number),
            filled=light.elevation_deg >= 0,
        )


def _draw_arrow(
    draw: ImageDraw.ImageDraw,
    start: NDArray[np.float64],
    end: NDArray[np.float64],
    thickness: int,
    colour: str,
    *,
    filled: bool,
) -> None:
    along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-9)
    across = np.array([-along[1], along[0]])
    neck = end - 3 * thickness * along
    head = [end, neck + 2 * thickness * across, neck - 2 * thickness * across]
    points = [(float(x), float(y)) for x, y in head]
    for edge, shade in ((thickness + 4, "black"), (thickness, colour)):
        draw.line([*map(float, start), *map(float, neck)], fill=shade, width=edge)
    draw.polygon(points, fill=colour if filled else "black", outline="black", width=2)
    if not filled:
        draw.line([*points, points[0]], fill=colour, width=max(2, thickness // 2))


def _colour(number: int) -> str:
    return COLOURS[number % len(COLOURS)]
