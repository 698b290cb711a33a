"""The scene as it is lit inside fog: softer shadows, weaker highlights, paler colours.

The light is not known, so the picture itself is changed (Lopez-Moreno 2011, sec. 6.3.4.2 and
algorithm 2). That is done in linear light on luminance and on the mixture with the airlight's
colour, which, unlike hue, lightness and saturation, are sound for any dynamic range.
"""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.color import LUMINANCE_WEIGHTS, luminance
from algorithms.fog.parameters import Fog
from algorithms.highlights import highlight_threshold

Plane = NDArray[np.float32]

SHADOW_STOPS: Final = 5.0
"""Pixels more than this below white count as shadows."""

_WHITE_PERCENTILE: Final = 99.0
_LOWEST_HIGHLIGHT_PERCENTILE: Final = 95.0
_LIGHT_SATURATION: Final = 0.5
_SAMPLES: Final = 1 << 18
_WEIGHTS: Final = np.array(LUMINANCE_WEIGHTS, dtype=np.float32)


def white_level(image: NDArray[np.floating[Any]]) -> float:
    """Return the luminance that counts as a picture's white: its 99th percentile.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`.
    """
    return float(np.percentile(luminance(_sample(image)), _WHITE_PERCENTILE))


@dataclass(frozen=True)
class Tones:
    """What relighting has to know of a whole picture, in its own unit.

    Attributes
    ----------
    white
        See `white_level`.
    highlight
        The luminance from which on pixels are highlights.
    airlight
        Linear red, green and blue of opaque fog, `(3,)`.
    """

    white: float
    highlight: float
    airlight: Plane

    @property
    def shadow(self) -> float:
        """The luminance up to which pixels are shadows."""
        return float(self.white * 2**-SHADOW_STOPS)

    @property
    def tint(self) -> Plane:
        """The airlight's colour at a luminance of 1; grey where it is black."""
        level = float(self.airlight @ _WEIGHTS)
        return self.airlight / np.float32(level) if level > 0 else np.ones(3, dtype=np.float32)


def tones_of(image: NDArray[np.floating[Any]], fog: Fog) -> Tones:
    """Return a picture's tones.

    Parameters
    ----------
    image
        Linear light, `(height, width, 3)`.
    fog
        Gives the airlight, or leaves it to the picture: what is scattered comes from everywhere.

    Notes
    -----
    Highlights begin where the histogram falls fastest (Khan et al. 2006), but not below the 95th
    percentile: a histogram may fall fast anywhere.
    """
    sample = _sample(image)
    values = luminance(sample)
    white = white_level(image)
    lowest = float(np.percentile(values, _LOWEST_HIGHLIGHT_PERCENTILE))
    highlight = max(highlight_threshold(values), lowest)
    airlight = _mean_light(sample) if fog.airlight is None else np.multiply(fog.airlight, white)
    return Tones(white, highlight, np.asarray(airlight, dtype=np.float32))


def _mean_light(pixels: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """Return the mean of a picture, paler: half of its colour is that of surfaces, not of light."""
    mean = pixels.mean(axis=(0, 1), dtype=np.float64)
    grey = float(luminance(mean))
    return np.asarray(grey + _LIGHT_SATURATION * (mean - grey))


def relit(pixels: Plane, opacity: Plane, tones: Tones, fog: Fog) -> Plane:
    """Return pixels as they are lit inside the fog.

    Parameters
    ----------
    pixels
        Linear light, float32 `(..., 3)`, 0 or more.
    opacity
        `(...)`: how much of the fog's full effect they get, 0..1; 0 leaves them as they are.
    tones
        Of the whole picture.
    fog
        How far colours, shadows and highlights give way.
    """
    level = pixels @ _WEIGHTS
    beyond = np.maximum(level - np.float32(tones.highlight), 0)
    beyond *= opacity * np.float32(fog.highlight_attenuation)
    kept = 1 - beyond / np.maximum(level, np.float32(1e-30))
    lift = np.maximum(np.float32(tones.shadow) - level, 0)
    lift *= opacity * np.float32(fog.shadow_lift)
    grey = opacity * np.float32(fog.desaturation)
    # Of the tint there is the lift, and what the colours lose.
    tinted = lift + grey * kept * level
    changed = pixels * ((1 - grey) * kept)[..., None]
    return np.asarray(changed + tinted[..., None] * tones.tint)


def _sample(image: NDArray[np.floating[Any]]) -> NDArray[np.floating[Any]]:
    """Return rows and columns of a picture at regular steps, about `_SAMPLES` pixels."""
    step = max(1, int(np.sqrt(image.shape[0] * image.shape[1] / _SAMPLES)))
    return image[::step, ::step]
