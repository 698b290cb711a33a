"""Buttons below a stimulus, numbered from 1 as their keys are."""

from collections.abc import Sequence

from experiments.lab.geometry import Area
from experiments.lab.inputs import Click, KeyPress, Press
from experiments.lab.window import Drawable, LabWindow

BUTTON_RGB = (38, 38, 38)

# Shares of the window's height and width.
_BAND = 0.1
_HEIGHT = 0.06
_WIDTH = 0.2
_GAP = 0.02
_MARGIN = 0.01
_TEXT = 0.026

_ARROWS = {"left": 1, "right": 2}


def above_buttons(area: Area, window: LabWindow) -> Area:
    """Return the part of an area that is left above a row of buttons, with a margin beside it."""
    band_px, margin_px = round(_BAND * window.height_px), round(_MARGIN * window.width_px)
    width_px = area.width_px - 2 * margin_px
    return Area(area.left_px + margin_px, area.top_px, width_px, area.height_px - band_px)


class Buttons:
    """A row of buttons at the lower edge of an area.

    Parameters
    ----------
    window, area
        Where they are.
    labels
        What they say, after their number where there are several.
    """

    def __init__(self, window: LabWindow, area: Area, labels: Sequence[str]) -> None:
        width_px, height_px = round(_WIDTH * window.width_px), round(_HEIGHT * window.height_px)
        step_px = width_px + round(_GAP * window.width_px)
        left_px = area.left_px + (area.width_px - len(labels) * step_px + step_px - width_px) // 2
        band_px = round(_BAND * window.height_px)
        top_px = area.top_px + area.height_px - (band_px + height_px) // 2
        self._areas = [
            Area(left_px + number * step_px, top_px, width_px, height_px)
            for number in range(len(labels))
        ]
        texts = (
            labels if len(labels) == 1 else [f"{n}   {text}" for n, text in enumerate(labels, 1)]
        )
        self.parts: tuple[Drawable, ...] = tuple(
            part
            for each, text in zip(self._areas, texts, strict=True)
            for part in (
                window.bar(each, BUTTON_RGB),
                window.text(
                    text,
                    each.left_px + each.width_px / 2,
                    each.top_px + each.height_px / 2,
                    _TEXT * window.height_px,
                ),
            )
        )

    def number_of(self, press: Press) -> int | None:
        """Return the number of the button that a click or a key (digit, arrow) means, or None."""
        if isinstance(press, KeyPress):
            number = int(press.key) if press.key.isdigit() else _ARROWS.get(press.key)
            return number if number is not None and number <= len(self._areas) else None
        if isinstance(press, Click):
            for number, area in enumerate(self._areas, start=1):
                if area.holds(press.x_px, press.y_px):
                    return number
        return None
