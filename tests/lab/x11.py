"""What a test asks of the X server itself, through Xlib."""

import ctypes
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from ctypes import c_int, c_long, c_ulong, c_void_p

CLIENT_MESSAGE = 33
EVENT_LONGS = 24
ALL_PLANES = c_ulong(0xFFFFFF)
Z_PIXMAP = 2


class _Monitor(ctypes.Structure):
    """XRRMonitorInfo."""

    _fields_ = (
        ("name", c_ulong),
        *((name, c_int) for name in ("primary", "automatic", "outputs_count", "x", "y")),
        *((name, c_int) for name in ("width", "height", "width_mm", "height_mm")),
        ("outputs", c_void_p),
    )


class _ClientMessage(ctypes.Structure):
    """XClientMessageEvent, as large as any XEvent."""

    _fields_ = (
        *(("type", c_int), ("serial", c_ulong), ("send_event", c_int), ("display", c_void_p)),
        *(("window", c_ulong), ("message_type", c_ulong), ("format", c_int)),
        ("data", c_long * 5),
        ("rest", c_long * EVENT_LONGS),
    )


@contextmanager
def _opened(display: str) -> Iterator[tuple[ctypes.CDLL, c_void_p]]:
    x11 = ctypes.CDLL("libX11.so.6")
    x11.XOpenDisplay.restype = c_void_p
    x11.XDefaultRootWindow.restype = x11.XInternAtom.restype = c_ulong
    opened = c_void_p(x11.XOpenDisplay(display.encode()))
    try:
        yield x11, opened
    finally:
        x11.XCloseDisplay(opened)


def split_screen(display: str, at_px: int, width_px: int, height_px: int) -> None:
    """Let a display appear as two monitors side by side, the left one first."""
    randr = ctypes.CDLL("libXrandr.so.2")
    with _opened(display) as (x11, opened):
        root = c_ulong(x11.XDefaultRootWindow(opened))
        for name, left_px, right_px in (("left", 0, at_px), ("right", at_px, width_px)):
            atom = x11.XInternAtom(opened, name.encode(), 0)
            place = (left_px, 0, right_px - left_px, height_px, 0, 0)
            monitor = _Monitor(atom, int(name == "left"), 0, 0, *place, None)
            randr.XRRSetMonitor(opened, root, ctypes.byref(monitor))


def watch_pixel(
    display: str, x_px: int, y_px: int, ended: Callable[[], bool], pause_s: float
) -> list[tuple[float, int]]:
    """Return when a pixel of the screen was seen to change, on `time.monotonic`, and to what."""
    seen: list[tuple[float, int]] = []
    with _opened(display) as (x11, opened):
        x11.XGetImage.restype = c_void_p
        x11.XGetPixel.restype = c_ulong
        root = c_ulong(x11.XDefaultRootWindow(opened))
        while not ended():
            image = c_void_p(x11.XGetImage(opened, root, x_px, y_px, 1, 1, ALL_PLANES, Z_PIXMAP))
            now_s, colour = time.monotonic(), int(x11.XGetPixel(image, 0, 0))
            x11.XDestroyImage(image)
            if not seen or seen[-1][1] != colour:
                seen.append((now_s, colour))
            time.sleep(pause_s)
    return seen


def ask_to_close(display: str, window: int) -> None:
    """Send a window what window managers send when somebody closes it."""
    with _opened(display) as (x11, opened):
        protocols, delete = (
            x11.XInternAtom(opened, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW")
        )
        event = _ClientMessage(
            type=CLIENT_MESSAGE, window=window, message_type=protocols, format=32
        )
        event.data[0] = delete
        x11.XSendEvent(opened, c_ulong(window), 0, c_long(0), ctypes.byref(event))
