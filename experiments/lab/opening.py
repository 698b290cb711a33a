"""Opening the PsychoPy window, or saying in one line what is missing for it."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from types import ModuleType

from algorithms.errors import UnavailableError
from experiments.lab.monitor import find_monitor
from experiments.lab.window import LabWindow, WindowSettings


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
        visual = _import_visual()
        window = LabWindow(visual, find_monitor(settings.monitor), settings, announce)
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
            f"the lab runner needs PsychoPy ({error}): pip install psychopy"
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
