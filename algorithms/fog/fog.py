"""Fog in a picture, from the distance of what is seen at each pixel.

The picture is relit as if it stood in fog, attenuated with distance, and the light that the fog
scatters towards the viewer is added (Lopez-Moreno 2011, chapter 6, eq. 6.4):

    L = L0 exp(-k Z) + A (1 - exp(-sigma Z))

Of the scattered light, that scattered by small angles comes from near where it would come from in
clear air: it is the picture spread by the atmospheric point-spread function. The rest has the
airlight's colour A. All of it is done in strips of rows, so that memory does not limit the size.
"""

from collections.abc import Iterator
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.checks import checked_image
from algorithms.errors import InputError
from algorithms.fog.glow import Coarse, Glow
from algorithms.fog.parameters import Fog
from algorithms.fog.relighting import Tones, relit, tones_of
from algorithms.noise import PerlinNoise

Plane = NDArray[np.float32]

_STRIP_PX: Final = 1 << 18


def add_fog(
    image: NDArray[np.floating[Any]],
    distance: ArrayLike,
    fog: Fog,
    *,
    generator: np.random.Generator | None = None,
    field_of_view_deg: float = 50.0,
) -> Plane:
    """Add fog to a picture.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`, finite, 0 or more; of any dynamic range and exposure.
    distance
        `(height, width)`: from the camera, in the unit of the fog's extinction, 0 or more; infinite
        for the sky.
    fog
        What the fog is like.
    generator
        Draws the clouds of fog that is not homogeneous (`noise_amplitude` above 0).
    field_of_view_deg
        Horizontal angle of view, more than 0 and less than 180; only the glow depends on it.

    Returns
    -------
    Linear light, float32 `(height, width, 3)`, finite, 0 or more. Where the distance is 0, or if
    there is no fog, it is the image itself.

    Raises
    ------
    InputError
        If a shape or value is not as described, or a generator is missing.

    Notes
    -----
    Lopez-Moreno 2011, sec. 6.3. The airlight as printed (algorithm 4) grows with distance without
    limit; here it saturates.
    """
    pixels = checked_image(image)
    thickness = _checked_distance(distance, pixels.shape[:2])
    if not 0 < field_of_view_deg < 180:
        raise InputError(
            f"field_of_view_deg: more than 0 and less than 180 is accepted, not {field_of_view_deg}"
        )
    if fog.is_clear:
        return pixels.copy()
    if fog.noise_amplitude > 0:
        density = _density(thickness.shape, fog, generator)
        np.multiply(thickness, density, out=thickness, where=np.isfinite(thickness))
    tones = tones_of(pixels, fog)
    glow = _glow(pixels, thickness, tones, fog, field_of_view_deg) if fog.glow > 0 else None
    foggy = np.empty_like(pixels)
    for rows in _strips(pixels.shape):
        foggy[rows] = _seen_through(pixels[rows], thickness[rows], tones, fog, glow, rows.start)
    return foggy


def _seen_through(
    pixels: Plane, way: Plane, tones: Tones, fog: Fog, glow: Glow | None, first_row: int
) -> Plane:
    """Return rows of the picture in fog; `way` is the distance weighted by the density."""
    clear, scattered = _opacities(way, fog)
    seen = relit(pixels, 1 - clear, tones, fog) * clear[..., None]
    if glow is None:
        seen += scattered[..., None] * tones.airlight
        return seen
    thickness = _times(way, fog.extinction)
    forwards = _forwards(way, fog) * np.float32(fog.glow)
    seen += glow.rows(first_row, thickness) * forwards[..., None]
    seen += (scattered - forwards)[..., None] * tones.airlight
    return seen


def _glow(pixels: Plane, way: Plane, tones: Tones, fog: Fog, field_of_view_deg: float) -> Glow:
    """Spread the relit picture."""
    coarse = Coarse(pixels.shape[:2])
    for rows in _strips(pixels.shape, coarse.cell_px):
        clear, _ = _opacities(way[rows], fog)
        coarse.add(rows.start, relit(pixels[rows], 1 - clear, tones, fog))
    return Glow(coarse, pixels.shape[1], fog, field_of_view_deg)


def _opacities(way: Plane, fog: Fog) -> tuple[Plane, Plane]:
    """Return the shares of light that come through, and that build up by scattering."""
    scattering = fog.extinction if fog.scattering is None else fog.scattering
    return np.exp(-_times(way, fog.extinction)), -np.expm1(-_times(way, scattering))


def _forwards(way: Plane, fog: Fog) -> Plane:
    """Return the share of light that has been scattered, but by small angles only.

    Scattering turns light back the less, the more it goes forwards: by the similarity relation
    (van de Hulst 1980), q of it counts as not scattered at all.
    """
    scattering = fog.extinction if fog.scattering is None else fog.scattering
    turned_back = np.exp(-_times(way, scattering * (1 - fog.forward_scattering)))
    return np.asarray(turned_back - np.exp(-_times(way, scattering)))


def _times(way: Plane, rate: float) -> Plane:
    """Multiply a way, which may be infinite, by a rate, which may be 0."""
    return way * np.float32(rate) if rate > 0 else np.zeros_like(way)


def _density(shape: tuple[int, ...], fog: Fog, generator: np.random.Generator | None) -> Plane:
    """Return by how much the fog is denser than on average: 1 + noise, 0 or more."""
    if generator is None:
        raise InputError("generator: one is needed for fog with noise")
    height, width = shape
    noise = PerlinNoise(generator).image((height, width), fog.noise_period_px, fog.noise_octaves)
    noise *= np.float32(fog.noise_amplitude)
    noise += 1
    return np.maximum(noise, 0, out=noise)


def _strips(shape: tuple[int, ...], whole: int = 1) -> Iterator[slice]:
    """Yield slices of rows, each but the last of a multiple of `whole` rows."""
    rows = max(1, _STRIP_PX // shape[1] // whole) * whole
    for start in range(0, shape[0], rows):
        yield slice(start, min(start + rows, shape[0]))


def _checked_distance(distance: ArrayLike, shape: tuple[int, ...]) -> Plane:
    """Return a copy."""
    values = np.array(distance, dtype=np.float32)
    if values.shape != shape:
        raise InputError(f"distance: {shape} is accepted, the image's size, not {values.shape}")
    if not values.min() >= 0:
        raise InputError("distance: 0 or more is accepted, and infinite, but no NaN")
    return values
