"""A participant for the lab runner: a virtual display, real X11 input, and what is seen."""

import json
import os
import queue
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import ImageGrab

from experiments.lab.geometry import Area
from tests.conftest import require
from tests.lab.x11 import ask_to_close

ROOT = Path(__file__).parents[2]
DEMOGRAPHICS = {"age": 30, "gender": "undisclosed", "artistic_background": False}
PATIENCE_S = 60.0
DRAWN_BACKGROUND = 96  # of the images of tests.drawn_set; no other pixel of the window has it


@dataclass(frozen=True)
class Display:
    """A virtual X11 display."""

    name: str

    def do(self, *command: str) -> None:
        """Send real X11 input with xdotool."""
        subprocess.run(["xdotool", *command], env=os.environ | {"DISPLAY": self.name}, check=True)

    def press(self, key: str) -> None:
        self.do("key", key)

    def click(self, x_px: int, y_px: int) -> None:
        self.do("mousemove", str(x_px), str(y_px), "click", "1")

    def close(self, title: str) -> None:
        """Ask a window to close, as a window manager does."""
        found = subprocess.run(
            ["xdotool", "search", "--name", title],
            env=os.environ | {"DISPLAY": self.name},
            check=True,
            capture_output=True,
            text=True,
        )
        (window,) = found.stdout.split()
        ask_to_close(self.name, int(window))

    def screenshot(self) -> NDArray[np.uint8]:
        return np.array(ImageGrab.grab(xdisplay=self.name).convert("RGB"))


@contextmanager
def open_display(width_px: int = 1280, height_px: int = 800) -> Iterator[Display]:
    """Start Xvfb on a free display and end it afterwards."""
    require(shutil.which("Xvfb"), "needs Xvfb (apt install xvfb)")
    require(shutil.which("xdotool"), "needs xdotool (apt install xdotool)")
    reading, writing = os.pipe()
    with subprocess.Popen(
        [
            *("Xvfb", "-noreset", "-displayfd", str(writing)),
            *("-screen", "0", f"{width_px}x{height_px}x24"),
        ],
        pass_fds=[writing],
        stderr=subprocess.DEVNULL,
    ) as server:
        os.close(writing)
        try:
            with os.fdopen(reading) as pipe:
                yield Display(f":{pipe.readline().strip()}")
        finally:
            server.terminate()


MOUSE_TRACKER = """
["eyetracker.hw.mouse.EyeTracker"]
runtime_settings = { sampling_rate = 100 }
"""
"""The mouse in place of an eye tracker, as `--eye-tracker` takes it."""


def save_monitor(home: Path) -> None:
    """Let the Monitor Center of a home know the monitor `lab`: 53 cm, 60 cm, gamma 2.2."""
    make = (
        "from psychopy import monitors; monitor = monitors.Monitor('lab', width=53, distance=60,"
        " gamma=2.2); monitor.setSizePix((1280, 800)); monitor.save()"
    )
    environment = os.environ | {"HOME": str(home)}
    command = [sys.executable, "-c", make]
    subprocess.run(command, env=environment, check=True, capture_output=True)


@dataclass(frozen=True)
class Sitting:
    """What a sitting in the lab is given, as `run_lab` takes it."""

    study: Path | str
    stimuli: Path
    store: Path
    folder: Path
    participant: str | None = "P0001"
    participant_number: int | None = None
    demographics: Mapping[str, Any] | None = field(default_factory=lambda: DEMOGRAPHICS)
    settings: Mapping[str, Any] = field(default_factory=dict)
    triggers: Path | None = None
    tracker: Path | None = None
    experimenter_screen: int | None = None
    observed: Path | None = None
    """Where each frame's colours are written (`tests.lab.observed`)."""


class LabProcess:
    """A running sitting: what it announces, line by line."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self._process = process
        self._lines: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.put(line.strip())
        self._lines.put("ended")

    def next_page(self) -> str:
        """Return the name of the next page once it is on the screen."""
        page = self._lines.get(timeout=PATIENCE_S)
        if page == "ended":
            raise AssertionError(f"the window process ended: {self.error()}")
        return page

    def is_quiet(self, duration_s: float) -> bool:
        """Return whether no page is announced for so long."""
        try:
            self._lines.get(timeout=duration_s)
        except queue.Empty:
            return True
        return False

    def exit_code(self) -> int:
        """Wait for the end and return the exit status."""
        return self._process.wait(timeout=PATIENCE_S)

    def error(self) -> str:
        """Wait for the end and return what stands on the standard error."""
        assert self._process.stderr is not None
        return self._process.stderr.read()

    def kill(self) -> None:
        self._process.kill()


@contextmanager
def start(
    display: Display | None, *sittings: Sitting, home: Path | None = None
) -> Iterator[LabProcess]:
    """Start sittings, one after the other, on a display; they are ended if they still run.

    Parameters
    ----------
    display
        None for a process without any.
    sittings
        At least one.
    home
        The home directory, where PsychoPy keeps its monitors; None for the user's own.
    """
    environment = {key: value for key, value in os.environ.items() if key != "DISPLAY"}
    if display is not None:
        environment["DISPLAY"] = display.name
    if home is not None:
        environment["HOME"] = str(home)
    arguments = json.dumps([vars(sitting) for sitting in sittings], default=str)
    with subprocess.Popen(
        [sys.executable, "-m", "tests.lab.window_process", arguments],
        cwd=ROOT,
        env=environment | {"LIBGL_ALWAYS_SOFTWARE": "1"},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        try:
            yield LabProcess(process)
        finally:
            with suppress(ProcessLookupError):  # with the eye tracker's process, which would stay
                os.killpg(process.pid, signal.SIGKILL)


def image_area(screenshot: NDArray[np.uint8]) -> Area:
    """Find where a drawn image is on the screen, by its background."""
    rows, columns = np.nonzero((screenshot == DRAWN_BACKGROUND).all(axis=2))
    left_px, top_px = int(columns.min()), int(rows.min())
    return Area(left_px, top_px, int(columns.max()) + 1 - left_px, int(rows.max()) + 1 - top_px)


def point_in(regions: NDArray[np.uint8], label: int, area: Area) -> tuple[int, int]:
    """Return a point of the screen in the middle of a region of an image shown in an area."""
    rows, columns = np.nonzero(regions == label)
    x = (float(columns.mean()) + 0.5) / regions.shape[1]
    y = (float(rows.mean()) + 0.5) / regions.shape[0]
    return int(area.left_px + x * area.width_px), int(area.top_px + y * area.height_px)


def take_study(
    display: Display,
    lab: LabProcess,
    regions: NDArray[np.uint8],
    answers: Mapping[int, int],
    look: Callable[[str], None] = lambda _page: None,
) -> list[str]:
    """Take a study until all the answers are given, by mouse and keyboard in turns.

    Parameters
    ----------
    display, lab
        Where it runs.
    regions
        The label image of all the drawn stimuli.
    answers
        By trial index.
    look
        Called with each page's name while it is on the screen.

    Returns
    -------
    The pages seen; the last one is `completed`, or that of the first trial without an answer,
    still to be answered.
    """
    pages: list[str] = []
    while True:
        page = lab.next_page()
        pages.append(page)
        look(page)
        kind, _, number = page.partition(" ")
        if kind == "trial":
            index = int(number)
            if index not in answers:
                return pages
            if index % 2:
                display.press(str(answers[index]))
            else:
                area = image_area(display.screenshot())
                display.click(*point_in(regions, answers[index], area))
        elif kind in ("completed", "left"):
            return pages
        else:
            display.press("Return")
