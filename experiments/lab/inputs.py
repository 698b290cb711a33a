"""What is pressed in the window, where and when."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

_LEFT_BUTTON = 1  # pyglet's


@dataclass(frozen=True)
class KeyPress:
    """A key by its name in `KEYS`, `1` to `9` from row or numeric pad; on the window's clock."""

    key: str
    time_s: float


@dataclass(frozen=True)
class Click:
    """A click of the left button on a pixel counted from the window's upper left corner."""

    x_px: int
    y_px: int
    time_s: float


@dataclass(frozen=True)
class Release:
    """The end of a click."""

    x_px: int
    y_px: int
    time_s: float


@dataclass(frozen=True)
class Typed:
    """A character that was typed."""

    character: str


Press = KeyPress | Click | Release

KEYS = (
    *("escape", "enter", "space", "equal", "left", "right", "up", "down"),
    *("tab", "backspace"),
)


class Presses:
    """The keys and clicks that a window receives, in their order.

    Parameters
    ----------
    pyglet_window
        The window to listen to.
    height_px
        Its height.
    time_s
        The clock for the presses. A press is noticed once a frame, so its time is exact to that.
    """

    def __init__(
        self,
        pyglet_window: Any,  # noqa: ANN401 - published without types
        height_px: int,
        time_s: Callable[[], float],
    ) -> None:
        self._height_px = height_px
        self._time_s = time_s
        self._keys = _key_names()
        self._waiting: list[Press | Typed] = []
        self.pointer_px = (0, 0)
        """Where the pointer is, counted from the window's upper left corner."""
        pyglet_window.push_handlers(
            on_key_press=self._on_key,
            on_text=self._on_text,
            on_mouse_press=self._on_click,
            on_mouse_release=self._on_release,
            on_mouse_drag=self._on_drag,
            on_close=self._on_close,
        )

    def take(self) -> list[Press]:
        """Return what was pressed since the last call, oldest first."""
        return [press for press in self.take_typed() if not isinstance(press, Typed)]

    def take_typed(self) -> list[Press | Typed]:
        """Return what was pressed since the last call with the characters that keys stand for."""
        taken, self._waiting = self._waiting, []
        return taken

    def _on_key(self, symbol: int, _modifiers: int) -> None:
        key = self._keys.get(symbol)
        if key is not None:
            self._waiting.append(KeyPress(key, self._time_s()))

    def _on_text(self, characters: str) -> None:
        self._waiting += [Typed(each) for each in characters if each.isprintable()]

    def _on_click(self, x_px: int, y_px: int, button: int, _modifiers: int) -> None:
        if button == _LEFT_BUTTON:
            self.pointer_px = x_px, self._from_above(y_px)
            self._waiting.append(Click(*self.pointer_px, self._time_s()))

    def _on_release(self, x_px: int, y_px: int, button: int, _modifiers: int) -> None:
        if button == _LEFT_BUTTON:
            self.pointer_px = x_px, self._from_above(y_px)
            self._waiting.append(Release(*self.pointer_px, self._time_s()))

    def _on_drag(
        self, x_px: int, y_px: int, _dx: int, _dy: int, _buttons: int, _modifiers: int
    ) -> None:
        self.pointer_px = x_px, self._height_px - 1 - y_px

    def _from_above(self, y_px: int) -> int:
        """Return the row of a button's event, counted from the upper edge."""
        # pyglet counts rows from the lower edge, on X11 from 1 instead of 0 when a button is
        # pressed (its motion events count from 0).
        from_below = y_px - 1 if sys.platform.startswith("linux") else y_px
        return self._height_px - 1 - from_below

    def _on_close(self) -> bool:
        self._waiting.append(KeyPress("escape", self._time_s()))
        return True  # handled: the window stays open until the run has ended


def _key_names() -> dict[int, str]:
    from pyglet.window import key

    # The numeric pad, from 1 to 9, when Num Lock is off.
    pad = ("END", "DOWN", "PAGE_DOWN", "LEFT", "BEGIN", "RIGHT", "HOME", "UP", "PAGE_UP")
    names = {getattr(key, name.upper()): name for name in KEYS}
    names |= {key.RETURN: "enter", key.NUM_ENTER: "enter", key.NUM_EQUAL: "equal"}
    for digit, unlocked in enumerate(pad, start=1):
        names[getattr(key, f"_{digit}")] = str(digit)
        names[getattr(key, f"NUM_{digit}")] = str(digit)
        names[getattr(key, f"NUM_{unlocked}")] = str(digit)
    return names
