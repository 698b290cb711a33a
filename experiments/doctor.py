"""What this machine can run, and for each thing missing the line that installs it."""

import ctypes
import ctypes.util
import importlib.metadata
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from stimuli.engine import engine_report

_RENDERER = """
import pyglet
window = pyglet.window.Window(8, 8, visible=False)
print(window.context.get_info().get_renderer())
"""

BUNDLE = Path(__file__).parent / "web" / "bundle"


@dataclass(frozen=True)
class Check:
    """One thing that some part of Trompe needs.

    Attributes
    ----------
    name, needed_for
        What it is, and what does not work without it.
    works
        Whether it was found and works.
    detail
        Which version, or what is wrong.
    remedy
        The line that installs it; empty where it works or nothing can be installed.
    """

    name: str
    needed_for: str
    works: bool
    detail: str
    remedy: str


def examine() -> tuple[Check, ...]:
    """Look at everything that Trompe can use on this machine."""
    return (
        *_engines(),
        *(_psychopy(), _opengl(), _display(), _vertical_blank(), _ports()),
        *(_chromium(), _front_end()),
    )


def _engines() -> tuple[Check, ...]:
    return tuple(
        Check(
            f"engine {status.name}",
            "rendering stimuli",
            status.works,
            status.detail,
            "" if status.works else status.remedy,
        )
        for status in engine_report()
    )


def _psychopy() -> Check:
    try:
        version = importlib.metadata.version("psychopy")
    except importlib.metadata.PackageNotFoundError:
        return Check("PsychoPy", "the lab runner", False, "not installed", "pip install psychopy")
    return Check("PsychoPy", "the lab runner", True, version, "")


def _opengl() -> Check:
    library = ctypes.util.find_library("GL")
    remedy = "" if library else "apt install libgl1 libglu1-mesa libgl1-mesa-dri"
    return Check("OpenGL", "the lab runner", library is not None, library or "no libGL", remedy)


def _display() -> Check:
    remedy = "apt install xvfb, then xvfb-run trompe ... (or log in at a screen)"
    library = ctypes.util.find_library("X11")
    if library is None:
        return Check(
            "display", "the lab runner", False, "no libX11", f"apt install libx11-6; {remedy}"
        )
    x11 = ctypes.CDLL(library)
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if display is None:
        return Check("display", "the lab runner", False, "no X display can be opened", remedy)
    x11.XDisplayString.restype = ctypes.c_char_p
    x11.XDisplayString.argtypes = x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    name = x11.XDisplayString(display).decode()
    x11.XCloseDisplay(display)
    return Check("display", "the lab runner", True, name, "")


def _vertical_blank() -> Check:
    """Ask what draws a window, in a process of its own: a driver that fails may end it."""
    from experiments.lab.window import SOFTWARE_RENDERERS

    name, needed_for = "graphics card", "times in the lab"
    remedy = "the driver of a graphics card: software waits for no display"
    asked = subprocess.run(
        [sys.executable, "-c", _RENDERER], capture_output=True, text=True, check=False, timeout=60
    )
    renderer = asked.stdout.strip()
    if asked.returncode or not renderer:
        return Check(name, needed_for, False, "no window with OpenGL can be opened", remedy)
    hardware = not any(software in renderer for software in SOFTWARE_RENDERERS)
    return Check(name, needed_for, hardware, renderer, "" if hardware else remedy)


def _ports() -> Check:
    try:
        from serial.tools import list_ports
    except ImportError:
        return Check(
            "ports", "trigger codes", False, "no pyserial", "pip install pyserial (psychopy has it)"
        )
    found = [port.device for port in list_ports.comports()]
    found += [str(path) for path in sorted(Path("/dev").glob("parport*"))]
    return Check("ports", "trigger codes", True, ", ".join(found) or "none connected", "")


def _chromium() -> Check:
    for name in ("chromium", "chromium-browser", "google-chrome"):
        path = shutil.which(name)
        if path is not None:
            answer = subprocess.run(
                [path, "--version"], capture_output=True, text=True, check=False, timeout=30
            )
            return Check("Chromium", "browser tests", True, answer.stdout.strip() or path, "")
    return Check("Chromium", "browser tests", False, "not found", "apt install chromium")


def _front_end() -> Check:
    built = (BUNDLE / "index.html").is_file()
    detail = "built" if built else "the web runner's front end is not built"
    return Check(
        "front end", "the web runner", built, detail, "" if built else "pip install --editable ."
    )
