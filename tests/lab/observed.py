"""A window that writes down, just before each frame is shown, what is in it."""

import json
import time
from pathlib import Path
from typing import Any

from experiments.lab.window import LabWindow


def observed_window(path: Path) -> type[LabWindow]:
    """Return a kind of window that adds a line to a file for each frame.

    Each is a JSON list: the time on the window's clock just before the frame is shown, and the
    colours in the middle of the photodiode's square and in the middle of the window, and the time
    on the clock that all processes share.
    """

    class ObservedWindow(LabWindow):
        def __init__(self, *arguments: Any) -> None:  # noqa: ANN401
            super().__init__(*arguments)
            square = arguments[2].photodiode.area(self.width_px, self.height_px)
            corner = (
                square.left_px + square.width_px // 2,
                square.top_px + square.height_px // 2,
            )
            places = (corner, (self.width_px // 2, self.height_px // 2))
            file = path.open("a", encoding="ascii", buffering=1)
            backend = self._window.backend
            swap = backend.swapBuffers

            def observe(flip: bool) -> None:
                colours = [self.colour_at(*place) for place in places]
                line = [self.time_s(), *colours, time.monotonic()]
                file.write(json.dumps(line) + "\n")
                swap(flip)

            backend.swapBuffers = observe

        def colour_at(self, x_px: int, y_px: int) -> list[int]:
            """Read a pixel of the next frame; on Xvfb the one that is shown cannot be read."""
            from pyglet import gl

            colour = (gl.GLubyte * 3)()
            from_below = self.height_px - 1 - y_px
            gl.glReadBuffer(gl.GL_BACK)
            gl.glReadPixels(x_px, from_below, 1, 1, gl.GL_RGB, gl.GL_UNSIGNED_BYTE, colour)
            return list(colour)

    return ObservedWindow
