"""Make docs/pictures/lab.png: the trial page of the lab runner in a real PsychoPy window.

Run it from the root of the repository, with the folder of a stimulus set that fits the study
`lights-synthetic`; it needs Xvfb and xdotool:

    python -m docs.screenshots_lab STIMULI
"""

import io
import sys
import tempfile
from pathlib import Path

from PIL import Image

from algorithms.files import write_atomically
from tests.lab.driver import Sitting, open_display, start

PICTURE = Path(__file__).parent / "pictures" / "lab.png"


def main() -> None:
    """Take the study to its first main trial and save what is on the screen."""
    stimuli = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as temporary, open_display() as display:
        folder = Path(temporary)
        sitting = Sitting("lights-synthetic", stimuli, folder / "rows.sqlite", folder)
        with start(display, sitting) as lab:
            while (page := lab.next_page()) != "trial 3":
                display.press("1" if page.startswith("trial") else "Return")
            content = io.BytesIO()
            Image.fromarray(display.screenshot()).save(content, "PNG", optimize=True)
    write_atomically(PICTURE, content.getvalue())


if __name__ == "__main__":
    main()
