"""What fog is like: its parameters, and those of the thesis' pictures."""

import colorsys
import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from algorithms.color import LUMINANCE_WEIGHTS
from algorithms.errors import InputError

Colour = tuple[float, float, float]

HUE_DEG: Final = 215.0
"""The airlight's hue in the presets; the thesis states only that it is the same in all of them."""


@dataclass(frozen=True)
class Fog:
    """A participating medium between camera and scene, and how the scene is relit by it.

    Attributes
    ----------
    extinction
        k, in the inverse of the distance's unit, 0 or more: the light of what lies behind falls as
        exp(-k Z).
    scattering
        sigma, likewise: light scattered towards the viewer builds up as 1 - exp(-sigma Z). None for
        as much as the extinction, fog that does not absorb.
    airlight
        Linear red, green and blue of fog too dense to look through, relative to the picture's
        white (`white_level`), so that the exposure does not matter; each 0 or more. None for the
        mean of the picture with half of its saturation: what is scattered comes from everywhere.
    desaturation, shadow_lift, highlight_attenuation
        How far colours, shadows and highlights give way where the fog is opaque, 0..1. Colours turn
        to the airlight's; shadows are filled up to `SHADOW_STOPS` below white.
    forward_scattering
        q of the point-spread function, 0..1 without 1: 0.75 for haze, 0.85 for fog.
    glow
        How much of the light scattered by small angles is seen around its source instead of being
        spread evenly, 0..1.
    glow_scale
        By how much the angles of the point-spread function are scaled, more than 0. The series is
        wide even where light is scattered once only; 0.25 comes closest to path-traced fog. Less
        makes halos smaller, and what is behind them more blurred.
    noise_amplitude
        How much the density varies, 0..1; 0 for homogeneous fog.
    noise_octaves, noise_period_px
        Of Perlin's noise: how many, 1..12; size of the largest clouds in the picture, more than 0.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    extinction: float
    scattering: float | None = None
    airlight: Colour | None = None
    desaturation: float = 0.2
    shadow_lift: float = 0.5
    highlight_attenuation: float = 0.5
    forward_scattering: float = 0.75
    glow: float = 1.0
    glow_scale: float = 0.25
    noise_amplitude: float = 0.0
    noise_octaves: int = 5
    noise_period_px: float = 300.0

    def __post_init__(self) -> None:
        rates = ("extinction",) if self.scattering is None else ("extinction", "scattering")
        shares = ("desaturation", "shadow_lift", "highlight_attenuation", "glow", "noise_amplitude")
        for name in rates:
            self._check(name, 0 <= getattr(self, name) < math.inf, "a finite number of 0 or more")
        for name in shares:
            self._check(name, 0 <= getattr(self, name) <= 1, "0..1")
        for name in ("glow_scale", "noise_period_px"):
            self._check(name, 0 < getattr(self, name) < math.inf, "a finite number of more than 0")
        self._check("forward_scattering", 0 <= self.forward_scattering < 1, "0..1 without 1")
        self._check("noise_octaves", self.noise_octaves in range(1, 13), "1..12")
        if self.airlight is not None:
            valid = len(self.airlight) == 3 and all(0 <= each < math.inf for each in self.airlight)
            self._check("airlight", valid, "three finite numbers of 0 or more")

    def _check(self, name: str, valid: bool, accepted: str) -> None:
        if not valid:
            raise InputError(f"{name}: {accepted} is accepted, not {getattr(self, name)}")

    @property
    def is_clear(self) -> bool:
        """Whether there is no fog at all, so that pictures stay as they are."""
        return self.extinction == 0 and not self.scattering


def airlight_colour(luminance: float, saturation: float, hue_deg: float = HUE_DEG) -> Colour:
    """Return linear red, green and blue of a luminance, hue and saturation.

    Parameters
    ----------
    luminance
        Relative to white, 0 or more.
    saturation
        Of the hue-lightness-saturation space, 0..1: 0 is grey.
    hue_deg
        0 is red, 120 green, 240 blue.

    Raises
    ------
    InputError
        If a value is outside its range.
    """
    if not (0 <= luminance < math.inf and 0 <= saturation <= 1 and math.isfinite(hue_deg)):
        raise InputError("airlight: a luminance of 0 or more and a saturation of 0..1 are accepted")
    colour = colorsys.hls_to_rgb(hue_deg % 360 / 360, 0.5, saturation)
    scale = luminance / sum(
        weight * channel for weight, channel in zip(LUMINANCE_WEIGHTS, colour, strict=True)
    )
    red, green, blue = (channel * scale for channel in colour)
    return red, green, blue


def _preset(k: float, sigma: float, luminance: float, saturation: float, *noise: int) -> Fog:
    octaves, period_px = noise
    return Fog(
        extinction=k,
        scattering=sigma,
        airlight=airlight_colour(luminance, saturation),
        desaturation=min(k, 1.0),
        noise_amplitude=1.0,
        noise_octaves=octaves,
        noise_period_px=period_px,
    )


PRESETS: Final[Mapping[str, Fog]] = MappingProxyType(
    {
        "house-left": _preset(1.2, 0.8, 0.6, 0.2, 5, 250),
        "house-centre": _preset(0.6, 0.35, 0.25, 0.2, 6, 450),
        "house-right": _preset(0.7, 0.5, 0.5, 0.3, 3, 300),
        "forest-left": _preset(1.0, 0.8, 0.4, 0.35, 6, 250),
        "forest-centre": _preset(0.5, 0.35, 0.15, 0.35, 5, 400),
        "forest-right": _preset(0.9, 0.65, 0.5, 0.35, 4, 400),
        "statue-left": _preset(0.5, 0.3, 0.01, 0.025, 5, 900),
        "statue-centre": _preset(0.65, 0.45, 0.15, 0.025, 4, 1500),
        "statue-right": _preset(0.75, 0.5, 0.025, 0.04, 5, 750),
    }
)
"""Lopez-Moreno 2011, table 6.1: for distances scaled to 0..1 (`algorithms.depth.scaled_distance`).

The saturation factor 1 - k of algorithm 2 is kept at 0 or more. The airlight's luminance counts
relative to the picture's white, as the scale of the thesis' high-dynamic-range values is not
stated."""
