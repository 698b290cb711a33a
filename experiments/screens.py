"""Whether a participant's screen is what a study asks for."""

from collections.abc import Mapping
from typing import Any, Final

from experiments.study_parts import Gamut, Screen

_GAMUTS: Final[tuple[Gamut, ...]] = ("srgb", "p3", "rec2020")
_ZOOMED: Final = 0.05  # browsers round window sizes, from which the zoom is known


def screen_faults(wanted: Screen, screen: Mapping[str, Any]) -> list[str]:
    """Return in what a screen falls short: any of `window`, `gamut`, `zoom`.

    Parameters
    ----------
    wanted
        The study's rules.
    screen
        What the browser tells (`window_width_px`, `window_height_px`, `color_gamut`, `zoom`); what
        it does not tell counts as right, since some hide it for privacy.
    """
    small = any(
        _number(screen, f"window_{side}_px", minimum) < minimum
        for side, minimum in (
            ("width", wanted.minimum_width_px),
            ("height", wanted.minimum_height_px),
        )
    )
    gamut = screen.get("color_gamut")
    narrow = (
        wanted.color_gamut is not None
        and gamut in _GAMUTS
        and _GAMUTS.index(gamut) < _GAMUTS.index(wanted.color_gamut)
    )
    zoomed = not wanted.allow_zoom and abs(_number(screen, "zoom", 1) - 1) > _ZOOMED
    faults = {"window": small, "gamut": narrow, "zoom": zoomed}
    return [name for name, found in faults.items() if found]


def _number(screen: Mapping[str, Any], name: str, otherwise: float) -> float:
    value = screen.get(name)
    return float(value) if isinstance(value, int | float) else otherwise
