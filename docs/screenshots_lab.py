"""Make docs/pictures/lab*.png: pages of the lab runner in real PsychoPy windows.

Run it from the root of the repository, with the folder of a stimulus set that fits the study
`lights-synthetic`; it needs Xvfb and xdotool:

    python -m docs.screenshots_lab STIMULI

`lab.png` is a main trial, `lab-form.png` the form that asks who takes part, and `lab-screens.png` a
trial with the photodiode's square beside the experimenter's screen.
"""

import io
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from algorithms.files import write_atomically
from experiments.lab.photodiode import Photodiode
from tests.lab.driver import Display, LabProcess, Sitting, open_display, start
from tests.lab.x11 import split_screen

PICTURES = Path(__file__).parent / "pictures"
SIZE_PX = (1280, 800)
BESIDE_PX = 700
SQUARE = Photodiode("bottom-right", 50)
_SETTLED_S = 1.0


def main() -> None:
    """Take the pictures one after the other."""
    stimuli = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        sitting = Sitting("lights-synthetic", stimuli, folder / "rows.sqlite", folder)
        with open_display(*SIZE_PX) as display:
            save("lab.png", trial(display, sitting))
            asked = replace(sitting, participant=None, demographics=None)
            save("lab-form.png", form(display, asked))
        with open_display(SIZE_PX[0] + BESIDE_PX, SIZE_PX[1]) as display:
            split_screen(display.name, SIZE_PX[0], SIZE_PX[0] + BESIDE_PX, SIZE_PX[1])
            settings = {"photodiode": vars(SQUARE)}
            watched = replace(
                sitting, participant="P0002", settings=settings, experimenter_screen=1
            )
            save("lab-screens.png", trial(display, watched))


def trial(display: Display, sitting: Sitting) -> NDArray[np.uint8]:
    """Take the study to its first main trial, and return what is on the display."""
    with start(display, sitting) as lab:
        while (page := lab.next_page()) != "trial 3":
            display.press("1" if page.startswith("trial") else "Return")
        return settled(display, lab)


def form(display: Display, sitting: Sitting) -> NDArray[np.uint8]:
    """Fill in some of the form, and return what is on the display."""
    with start(display, sitting) as lab:
        lab.next_page()
        display.do("type", "P12")
        display.do("key", "Tab")
        display.do("type", "34")
        display.do("key", "Tab", "Right", "Return")
        return settled(display, lab)


def settled(display: Display, lab: LabProcess) -> NDArray[np.uint8]:
    """Return what is on the display a moment later."""
    lab.is_quiet(_SETTLED_S)
    return display.screenshot()


def save(name: str, picture: NDArray[np.uint8]) -> None:
    """Write a picture."""
    content = io.BytesIO()
    Image.fromarray(picture).save(content, "PNG", optimize=True)
    write_atomically(PICTURES / name, content.getvalue())


if __name__ == "__main__":
    main()
