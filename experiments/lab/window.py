"""The PsychoPy window: opening it, drawing in it, and what is pressed and when."""

import os
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any, Protocol

from PIL import Image

from algorithms.errors import InputError, UnavailableError
from experiments.lab.geometry import Area

BACKGROUND_RGB = (128, 128, 128)
"""The surround of every page and image, sRGB values 0 to 255: the web's mid-grey."""

INK_RGB = (238, 238, 238)

_LEFT_BUTTON = 1  # pyglet's

# Without vertical synchronisation frames cost nothing but time; then we make 60 a second.
_UNSYNCHRONISED_HZ = 60.0
_FASTEST_DISPLAY_HZ = 400.0

# A frame that takes longer than this many refresh periods is counted as dropped.
_LATE_FRAME = 1.5


@dataclass(frozen=True)
class WindowSettings:
    """How the window is opened.

    Attributes
    ----------
    fullscreen
        Cover the whole screen.
    size_px
        (width, height) of a window that does not; None for 1280 x 800.
    screen
        Which screen, from 0.
    monitor
        The monitor's name in PsychoPy's Monitor Center, for its size and distance, or None. Its
        gamma is not applied: the images hold sRGB values, and linearising the window would
        correct them twice.
    """

    fullscreen: bool = True
    size_px: tuple[int, int] | None = None
    screen: int = 0
    monitor: str | None = None

    def __post_init__(self) -> None:
        if self.size_px is not None and min(self.size_px) < 1:
            raise InputError(f"size_px: {self.size_px} given, 1 or more each way accepted")
        if self.screen < 0:
            raise InputError(f"screen: {self.screen} given, 0 or more accepted")


@dataclass(frozen=True)
class KeyPress:
    """A key: `1` to `9` (numeric pad included), `enter` or `escape`; on the window's clock."""

    key: str
    time_s: float


@dataclass(frozen=True)
class Click:
    """A click of the left button on a pixel counted from the window's upper left corner."""

    x_px: int
    y_px: int
    time_s: float


@dataclass(frozen=True)
class Frames:
    """What the window's frames were like since `start_frames`.

    Attributes
    ----------
    interval_s
        The median time between two frames, or None if there were fewer than two.
    dropped
        How many frames came later than 1.5 refresh periods after the one before.
    """

    interval_s: float | None
    dropped: int


class Drawable(Protocol):
    """Something that can be drawn into the next frame."""

    def draw(self) -> None:
        """Draw it."""


class Text(Drawable, Protocol):
    """A text that is ready to be drawn."""

    @property
    def boundingBox(self) -> tuple[float, float]:  # noqa: N802 - PsychoPy's name
        """Its width and height in pixels."""


class LabWindow:
    """An open PsychoPy window with pixels counted from its upper left corner.

    Parameters
    ----------
    visual
        PsychoPy's module of windows and stimuli.
    settings
        How the window is opened.
    announce
        Called with the name of each page once it is on the screen.
    """

    def __init__(
        self, visual: ModuleType, settings: WindowSettings, announce: Callable[[str], None]
    ) -> None:
        self._visual = visual
        self._settings = settings
        self._window = visual.Window(
            size=settings.size_px or (1280, 800),
            fullscr=settings.fullscreen,
            screen=settings.screen,
            monitor=_uncorrected_monitor(settings.monitor),
            color=BACKGROUND_RGB,
            colorSpace="rgb255",
            units="pix",
            allowGUI=True,
            checkTiming=False,
            title="Trompe",
        )
        self._presses: list[KeyPress | Click] = []
        self._next_frame_s = 0.0
        self._keys = _key_names()
        self.announce = announce
        self.width_px, self.height_px = (int(side) for side in self._window.size)
        self._window.winHandle.push_handlers(
            on_key_press=self._on_key, on_mouse_press=self._on_click, on_close=self._on_close
        )
        measured_hz = self._window.getActualFrameRate(infoMsg="")
        synchronised = measured_hz is not None and measured_hz < _FASTEST_DISPLAY_HZ
        self.refresh_hz: float | None = float(measured_hz) if synchronised else None
        self._window.refreshThreshold = _LATE_FRAME * self.frame_s

    def check_screen(self) -> None:
        """Check that the window is on the screen asked for; PsychoPy takes the first if not.

        Raises
        ------
        InputError
            If there is no such screen.
        """
        last = len(self._window.winHandle.display.get_screens()) - 1
        if self._settings.screen > last:
            raise InputError(f"screen: {self._settings.screen} given, 0 to {last} accepted")

    def close(self) -> None:
        """Close the window."""
        self._window.close()

    @property
    def area(self) -> Area:
        """The whole window."""
        return Area(0, 0, self.width_px, self.height_px)

    @property
    def frame_s(self) -> float:
        """The time between two frames that the display is meant to keep."""
        return 1 / (self.refresh_hz or _UNSYNCHRONISED_HZ)

    @property
    def device(self) -> str:
        """PsychoPy's version, the graphics renderer and the measured refresh rate."""
        import psychopy

        renderer = self._window.winHandle.context.get_info().get_renderer()
        rate = f"{self.refresh_hz:.2f} Hz" if self.refresh_hz else "no vertical synchronisation"
        return f"PsychoPy {psychopy.__version__}; {renderer}; {rate}"

    @property
    def screen(self) -> dict[str, Any]:
        """What a session keeps of screen, window and monitor."""
        screen, monitor = self._window.winHandle.screen, self._window.monitor
        return {
            "width_px": screen.width,
            "height_px": screen.height,
            "window_width_px": self.width_px,
            "window_height_px": self.height_px,
            "fullscreen": self._settings.fullscreen,
            "refresh_hz": self.refresh_hz,
            "monitor": self._settings.monitor,
            "monitor_width_cm": monitor.getWidth(),
            "distance_cm": monitor.getDistance(),
        }

    def text(
        self, text: str, x_px: float, y_px: float, size_px: float, *, width_px: float | None = None
    ) -> Text:
        """Prepare a text: with a width a paragraph from its upper left corner, else one centred."""
        anchors = ("left", "top") if width_px else ("center", "center")
        text_stimulus: Text = self._visual.TextStim(
            self._window,
            text=text,
            pos=self._centred(x_px, y_px),
            height=size_px,
            wrapWidth=width_px or self.width_px,
            anchorHoriz=anchors[0],
            anchorVert=anchors[1],
            alignText=anchors[0],
            color=INK_RGB,
            colorSpace="rgb255",
        )
        return text_stimulus

    def image(self, image: Image.Image, area: Area) -> Drawable:
        """Prepare an image; its texture is on the graphics card when this returns."""
        image_stimulus: Drawable = self._visual.ImageStim(
            self._window,
            image=image,
            size=(area.width_px, area.height_px),
            pos=self._centred(area.left_px + area.width_px / 2, area.top_px + area.height_px / 2),
            interpolate=True,
        )
        return image_stimulus

    def bar(self, area: Area, rgb: tuple[int, int, int]) -> Drawable:
        """Prepare a filled rectangle."""
        rectangle: Drawable = self._visual.Rect(
            self._window,
            width=area.width_px,
            height=area.height_px,
            pos=self._centred(area.left_px + area.width_px / 2, area.top_px + area.height_px / 2),
            fillColor=rgb,
            lineColor=None,
            colorSpace="rgb255",
        )
        return rectangle

    def flip(self) -> float:
        """Show what was drawn and return the time of that, on the window's clock."""
        if self.refresh_hz is None:
            time.sleep(max(0.0, self._next_frame_s - self.time_s()))
        shown_s = float(self._window.flip())
        self._next_frame_s = max(self._next_frame_s + self.frame_s, shown_s)
        return shown_s

    def discard(self) -> None:
        """Forget what was drawn; the graphics card has its shaders and textures ready then."""
        self._window.clearBuffer()

    def time_s(self) -> float:
        """Return the time on the window's clock, in seconds."""
        from psychopy import logging

        return float(logging.defaultClock.getTime())

    def take_presses(self) -> list[KeyPress | Click]:
        """Return what was pressed since the last call, oldest first; known once a frame."""
        taken, self._presses = self._presses, []
        return taken

    def start_frames(self) -> None:
        """Begin to record the intervals between frames."""
        self._window.frameIntervals.clear()
        self._window.nDroppedFrames = 0
        self._window.recordFrameIntervals = True

    def end_frames(self) -> Frames:
        """End the recording and return what it says."""
        self._window.recordFrameIntervals = False
        intervals_s = self._window.frameIntervals
        return Frames(
            float(statistics.median(intervals_s)) if intervals_s else None,
            int(self._window.nDroppedFrames),
        )

    def _centred(self, x_px: float, y_px: float) -> tuple[float, float]:
        return x_px - self.width_px / 2, self.height_px / 2 - y_px

    def _on_key(self, symbol: int, _modifiers: int) -> None:
        key = self._keys.get(symbol)
        if key is not None:
            self._presses.append(KeyPress(key, self.time_s()))

    def _on_click(self, x_px: int, y_px: int, button: int, _modifiers: int) -> None:
        # pyglet counts rows from the lower edge, on X11 from 1 instead of 0 when a button is
        # pressed (its motion events count from 0).
        from_below = y_px - 1 if sys.platform.startswith("linux") else y_px
        if button == _LEFT_BUTTON:
            row = self.height_px - 1 - from_below
            self._presses.append(Click(x_px, row, self.time_s()))

    def _on_close(self) -> bool:
        self._presses.append(KeyPress("escape", self.time_s()))
        return True  # handled: the window stays open until the run has ended


@contextmanager
def open_window(settings: WindowSettings, announce: Callable[[str], None]) -> Iterator[LabWindow]:
    """Open the window and close it afterwards, whatever happens.

    Raises
    ------
    InputError
        If there is no such screen, or PsychoPy does not know the monitor.
    UnavailableError
        If PsychoPy or a display is missing; the message says how to get it.
    """
    with _told_in_one_line():
        window = LabWindow(_import_visual(), settings, announce)
    try:
        window.check_screen()
        yield window
    finally:
        window.close()


@contextmanager
def _told_in_one_line() -> Iterator[None]:
    """Turn the absence of PsychoPy, of a display or of OpenGL on it into a line that helps."""
    needs = "start it in a desktop session, or try it out with xvfb-run"
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        raise UnavailableError(f"the lab runner needs a display (DISPLAY is not set): {needs}")
    try:
        yield
    except ImportError as error:
        raise UnavailableError(
            f"the lab runner needs PsychoPy ({error}): pip install 'trompe[lab]'"
        ) from error
    except Exception as error:
        # pyglet has an exception of its own for each thing that a display may lack.
        if type(error).__module__.partition(".")[0] != "pyglet":
            raise
        raise UnavailableError(
            f"the lab runner needs a display with OpenGL ({error}): {needs}"
        ) from error


def _import_visual() -> ModuleType:
    """Import PsychoPy, quietly and without sound."""
    from psychopy import logging, prefs

    prefs.hardware["audioLib"] = []
    logging.console.setLevel(logging.ERROR)
    return import_module("psychopy.visual")


def _uncorrected_monitor(name: str | None) -> object:
    """Return a monitor of the named one's size and distance, without its gamma."""
    from psychopy import monitors

    known = monitors.getAllMonitors()
    if name is not None and name not in known:
        raise InputError(
            f"monitor: {name!r} is not in PsychoPy's Monitor Center; there are: {', '.join(known)}"
        )
    monitor = monitors.Monitor("uncorrected")
    if name is not None:
        calibrated = monitors.Monitor(name)
        monitor.setWidth(calibrated.getWidth())
        monitor.setDistance(calibrated.getDistance())
    return monitor


def _key_names() -> dict[int, str]:
    from pyglet.window import key

    # The numeric pad, from 1 to 9, when Num Lock is off.
    pad = ("END", "DOWN", "PAGE_DOWN", "LEFT", "BEGIN", "RIGHT", "HOME", "UP", "PAGE_UP")
    names = {key.ESCAPE: "escape", key.RETURN: "enter", key.NUM_ENTER: "enter"}
    for digit, unlocked in enumerate(pad, start=1):
        names[getattr(key, f"_{digit}")] = str(digit)
        names[getattr(key, f"NUM_{digit}")] = str(digit)
        names[getattr(key, f"NUM_{unlocked}")] = str(digit)
    return names
