"""The PsychoPy window: what is drawn in it, when it is shown, and how its frames were."""

import math
import statistics
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Protocol

from PIL import Image

from algorithms.errors import InputError
from experiments.lab.geometry import Area
from experiments.lab.inputs import Press, Presses, Typed
from experiments.lab.monitor import Monitor
from experiments.lab.photodiode import DARK_RGB, LIT_RGB, Photodiode

BACKGROUND_RGB = (128, 128, 128)
"""The surround of every page and image, sRGB values 0 to 255: the web's mid-grey."""

INK_RGB = (238, 238, 238)

SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "Software Rasterizer", "GDI Generic")
"""Parts of the names of what draws without a graphics card, and waits for no display."""

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
    photodiode
        The square that is white while a stimulus is shown, or None.
    title
        What the window is called.
    """

    fullscreen: bool = True
    size_px: tuple[int, int] | None = None
    screen: int = 0
    monitor: str | None = None
    photodiode: Photodiode | None = None
    title: str = "Trompe"

    def __post_init__(self) -> None:
        if self.size_px is not None and min(self.size_px) < 1:
            raise InputError(f"size_px: {self.size_px} given, 1 or more each way accepted")
        if self.screen < 0:
            raise InputError(f"screen: {self.screen} given, 0 or more accepted")


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


class Movable(Drawable, Protocol):
    """An image that can be drawn elsewhere in the next frame."""

    pos: tuple[float, float]
    size: tuple[float, float]


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
    monitor
        What is known of the monitor.
    settings
        How the window is opened.
    announce
        Called with the name of each page once it is on the screen.
    """

    def __init__(
        self,
        visual: ModuleType,
        monitor: Monitor,
        settings: WindowSettings,
        announce: Callable[[str], None],
    ) -> None:
        self._visual = visual
        self._settings = settings
        self.monitor = monitor
        self._window = visual.Window(
            size=settings.size_px or (1280, 800),
            fullscr=settings.fullscreen,
            screen=settings.screen,
            monitor=monitor.uncorrected(),
            color=BACKGROUND_RGB,
            colorSpace="rgb255",
            units="pix",
            allowGUI=True,
            checkTiming=False,
            title=settings.title,
        )
        self.next_frame_s = 0.0
        """When the next frame can be on the screen, on the window's clock."""
        self.announce = announce
        self.width_px, self.height_px = (int(side) for side in self._window.size)
        self._presses = Presses(self._window.winHandle, self.height_px, self.time_s)
        self._squares = self._prepare_squares()
        self.refresh_hz = self._measured_refresh_hz()
        self._window.refreshThreshold = _LATE_FRAME * self.frame_s

    def _measured_refresh_hz(self) -> float | None:
        """Return how often the display shows a frame, or None where frames wait for nothing."""
        if any(name in self._renderer for name in SOFTWARE_RENDERERS):
            return None  # on a busy machine its speed can look like a display's
        measured_hz: float | None = self._window.getActualFrameRate(infoMsg="")
        synchronised = measured_hz is not None and measured_hz < _FASTEST_DISPLAY_HZ
        return measured_hz if synchronised else None

    @property
    def _renderer(self) -> str:
        return str(self._window.winHandle.context.get_info().get_renderer())

    @property
    def psychopy_window(self) -> object:
        """PsychoPy's own window, for its other parts."""
        return self._window

    def hide_pointer(self) -> None:
        """Show the mouse's pointer no more, where nothing is clicked and it would draw the eyes."""
        self._window.mouseVisible = False

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

        rate = f"{self.refresh_hz:.2f} Hz" if self.refresh_hz else "no vertical synchronisation"
        return f"PsychoPy {psychopy.__version__}; {self._renderer}; {rate}"

    @property
    def pixels_per_cm(self) -> float | None:
        """How many pixels of the screen a centimetre has, or None if its width is not known."""
        width_cm = self.monitor.width_cm
        return self._window.winHandle.screen.width / width_cm if width_cm else None

    @property
    def screen(self) -> dict[str, Any]:
        """What a session keeps of screen, window and monitor."""
        screen, settings = self._window.winHandle.screen, self._settings
        return {
            "width_px": screen.width,
            "height_px": screen.height,
            "window_width_px": self.width_px,
            "window_height_px": self.height_px,
            "fullscreen": settings.fullscreen,
            "refresh_hz": self.refresh_hz,
            "monitor": self.monitor.name,
            "monitor_width_cm": self.monitor.width_cm,
            "distance_cm": self.monitor.distance_cm,
            "monitor_gamma": self.monitor.gamma,
            "photodiode": vars(settings.photodiode) if settings.photodiode else None,
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

    def image(self, image: Image.Image, area: Area) -> Movable:
        """Prepare an image; its texture is on the graphics card when this returns."""
        image_stimulus = self._visual.ImageStim(self._window, image=image, interpolate=True)
        _keep_to_its_edges(image_stimulus)
        movable: Movable = image_stimulus
        self.move(movable, area)
        return movable

    def move(self, image: Movable, area: Area) -> None:
        """Let an image fill an area from the next frame on."""
        image.size = (area.width_px, area.height_px)
        image.pos = self._middle(area)

    def bar(self, area: Area, rgb: tuple[int, int, int]) -> Drawable:
        """Prepare a filled rectangle."""
        rectangle: Drawable = self._visual.Rect(
            self._window,
            width=area.width_px,
            height=area.height_px,
            pos=self._middle(area),
            fillColor=rgb,
            lineColor=None,
            colorSpace="rgb255",
        )
        return rectangle

    def frame(self, area: Area, rgb: tuple[int, int, int], width_px: int) -> Drawable:
        """Prepare a line around an area."""
        around = area.grown(width_px)
        rectangle: Drawable = self._visual.Rect(
            self._window,
            width=around.width_px,
            height=around.height_px,
            pos=self._middle(around),
            fillColor=None,
            lineColor=rgb,
            lineWidth=width_px,
            colorSpace="rgb255",
        )
        return rectangle

    def flip(self, *, lit: bool = False) -> float:
        """Show what was drawn and return the time of that, on the window's clock.

        Parameters
        ----------
        lit
            Whether the photodiode's square is white in this frame, instead of black.
        """
        if self._squares is not None:
            self._squares[lit].draw()
        if self.refresh_hz is None:
            time.sleep(max(0.0, self.next_frame_s - self.time_s()))
        shown_s = float(self._window.flip())
        if self.refresh_hz is None:  # a late frame moves no later one, as on a display
            missed = max(1, math.ceil((shown_s - self.next_frame_s) / self.frame_s))
            self.next_frame_s += missed * self.frame_s
        else:
            self.next_frame_s = shown_s + self.frame_s
        return shown_s

    def show(self, parts: Iterable[Drawable], *, lit: bool = False) -> float:
        """Draw the parts from back to front, show them and return the time of that."""
        for part in parts:
            part.draw()
        return self.flip(lit=lit)

    def on_flip(self, call: Callable[[], None]) -> None:
        """Let something be called at once when the next frame is on the screen."""
        self._window.callOnFlip(call)

    def discard(self) -> None:
        """Forget what was drawn; the graphics card has its shaders and textures ready then."""
        self._window.clearBuffer()

    def time_s(self) -> float:
        """Return the time on the window's clock, in seconds."""
        from psychopy import logging

        return float(logging.defaultClock.getTime())

    def take_presses(self) -> list[Press]:
        """Return what was pressed since the last call, oldest first; known once a frame."""
        return self._presses.take()

    def take_typed(self) -> list[Press | Typed]:
        """Return what was pressed since the last call with the characters that keys stand for."""
        return self._presses.take_typed()

    @property
    def pointer_px(self) -> tuple[int, int]:
        """Where the pointer was last pressed, dragged or released, from the upper left corner."""
        return self._presses.pointer_px

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

    def _prepare_squares(self) -> tuple[Drawable, Drawable] | None:
        """Return the photodiode's square, dark and lit."""
        if self._settings.photodiode is None:
            return None
        area = self._settings.photodiode.area(self.width_px, self.height_px)
        return self.bar(area, DARK_RGB), self.bar(area, LIT_RGB)

    def _middle(self, area: Area) -> tuple[float, float]:
        return self._centred(area.left_px + area.width_px / 2, area.top_px + area.height_px / 2)

    def _centred(self, x_px: float, y_px: float) -> tuple[float, float]:
        return x_px - self.width_px / 2, self.height_px / 2 - y_px


def _keep_to_its_edges(image: Any) -> None:  # noqa: ANN401 - published without types
    """Let an enlarged image's outermost pixels mix with nothing; PsychoPy mixes them with black."""
    from pyglet import gl

    gl.glBindTexture(gl.GL_TEXTURE_2D, image._texID)
    for direction in (gl.GL_TEXTURE_WRAP_S, gl.GL_TEXTURE_WRAP_T):
        gl.glTexParameteri(gl.GL_TEXTURE_2D, direction, gl.GL_CLAMP_TO_EDGE)
    gl.glBindTexture(gl.GL_TEXTURE_2D, 0)
