"""A window for the experimenter, on another screen, that tells how far a sitting is.

It is a process of its own: it can neither delay the participant's frames nor end their sitting.
"""

import json
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress

from algorithms.errors import InputError, UserError
from experiments.lab.geometry import Area
from experiments.lab.inputs import KeyPress
from experiments.lab.opening import open_window
from experiments.lab.progress import Status
from experiments.lab.window import Drawable, LabWindow, WindowSettings

SIZE_PX = (640, 400)
TRACK_RGB = (112, 112, 112)
DONE_RGB = (240, 200, 60)

_MARGIN_PX = 30
_TEXT_PX = 26
_LINE_PX = 62
_BAR_PX = 16
_READY = "ready"
_PAUSE_S = 0.1


@contextmanager
def experimenter_window(screen: int) -> Iterator[Callable[[Status], None]]:
    """Open the window; what is yielded shows a status in it, while it is open.

    Parameters
    ----------
    screen
        Which screen, from 0.

    Raises
    ------
    InputError
        If the window cannot be opened there.
    """
    with subprocess.Popen(
        # Our own modules, whatever lies in the folder where the command was given.
        [sys.executable, "-P", "-m", __name__, str(screen)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        assert process.stderr is not None
        if process.stdout.readline().strip() != _READY:
            said = process.stderr.read().strip().splitlines() or ["it could not be opened"]
            raise InputError(f"experimenter_screen: {said[-1]}")
        threading.Thread(target=process.stderr.read, daemon=True).start()
        pipe = process.stdin.fileno()
        os.set_blocking(pipe, False)
        try:
            yield lambda status: _tell(pipe, status)
        finally:
            process.stdin.close()


def _tell(pipe: int, status: Status) -> None:
    # The experimenter may have closed the window, and a window that hangs is not waited for.
    with suppress(BrokenPipeError, BlockingIOError):
        os.write(pipe, json.dumps(vars(status)).encode() + b"\n")


def main(screen: int) -> None:
    """Show what comes on the standard input, until it ends or the window is closed."""
    statuses: queue.SimpleQueue[Status | None] = queue.SimpleQueue()
    threading.Thread(target=_read, args=(statuses,), daemon=True).start()
    settings = WindowSettings(
        fullscreen=False, size_px=SIZE_PX, screen=screen, title="Trompe: experimenter"
    )
    with open_window(settings, lambda _page: None) as window:
        print(_READY, flush=True)  # noqa: T201 - what the other process waits for
        parts: Sequence[Drawable] = ()
        while True:
            window.show(parts)
            if "escape" in _keys(window):
                return
            with suppress(queue.Empty):
                status = statuses.get(timeout=_PAUSE_S)
                if status is None:
                    return
                parts = _parts(window, status)


def _read(statuses: "queue.SimpleQueue[Status | None]") -> None:
    for line in sys.stdin:
        statuses.put(Status(**json.loads(line)))
    statuses.put(None)


def _keys(window: LabWindow) -> set[str]:
    return {press.key for press in window.take_presses() if isinstance(press, KeyPress)}


def _parts(window: LabWindow, status: Status) -> list[Drawable]:
    """Prepare the lines and a bar of the share that is done."""
    width_px = window.width_px - 2 * _MARGIN_PX
    bar = Area(_MARGIN_PX, window.height_px - _MARGIN_PX - _BAR_PX, width_px, _BAR_PX)
    done = Area(bar.left_px, bar.top_px, round(status.done * width_px), _BAR_PX)
    return [
        *(
            window.text(line, _MARGIN_PX, _MARGIN_PX + n * _LINE_PX, _TEXT_PX, width_px=width_px)
            for n, line in enumerate(status.lines())
        ),
        window.bar(bar, TRACK_RGB),
        *([window.bar(done, DONE_RGB)] if done.width_px else []),
    ]


if __name__ == "__main__":
    try:
        main(int(sys.argv[1]))
    except UserError as error:
        sys.exit(str(error))
