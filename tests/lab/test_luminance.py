"""Equal luminance: what the lab's window and the browser's page send to the display."""

from collections.abc import Mapping
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from algorithms.files import sha256_of
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.pages import BUNDLE
from stimuli.manifest import StimulusSet
from tests.conftest import require
from tests.drawn_set import HEIGHT_PX, WIDTH_PX, draw_set
from tests.lab.conftest import sitting_in
from tests.lab.driver import Display, start
from tests.web.browser import DESKTOP, Participant, open_chromium

pytestmark = [pytest.mark.lab, pytest.mark.browser, pytest.mark.slow]

GREYS = (16, 64, 128, 192, 240)
BAND_PX = WIDTH_PX // len(GREYS)
ROW_PX = 4  # above all objects and their numbers


@pytest.fixture(scope="module")
def greys_set(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """A set whose images are five greys side by side."""
    drawn = draw_set(tmp_path_factory.mktemp("greys"), levels_deg=(0, 90), placements=("front",))
    bands = np.repeat(np.array(GREYS, np.uint8), BAND_PX)
    image = Image.fromarray(np.tile(bands, (HEIGHT_PX, 1))).convert("RGB")
    for stimulus in drawn.stimuli:
        image.save(drawn.path(stimulus.file))
    files = {name: sha256_of(drawn.path(name)) for name in drawn.files}
    return drawn.model_copy(update={"files": files}).write(drawn.folder)


@pytest.mark.parametrize("settings", [{}, {"monitor": "lab"}], ids=["unknown", "gamma 2.2"])
def test_the_window_sends_the_greys_that_the_files_hold(
    display: Display,
    greys_set: StimulusSet,
    monitors: Path,
    tmp_path: Path,
    settings: Mapping[str, Any],
) -> None:
    """Read back from the window, with and without a monitor whose gamma is known.

    sRGB images in a window that is linearised would be corrected twice. Xvfb has no gamma table:
    PsychoPy would end with an error if it were asked to set one.
    """
    sitting = replace(sitting_in(tmp_path, greys_set), settings=settings)
    with start(display, sitting, home=monitors) as lab:
        while lab.next_page() != "trial 0":
            display.press("Return")
        shown = display.screenshot()
    left, top = (1280 - WIDTH_PX) // 2, _top_of_greys(shown)
    assert _bands(shown, left, top) == GREYS
    with Store.open(sitting.store, must_exist=True) as store:
        (session,) = store.sessions()
    keys = ("monitor", "monitor_width_cm", "distance_cm", "monitor_gamma")
    known = ["lab", 53, 60, [2.2]] if settings else [None] * 4
    assert [session.screen[key] for key in keys] == known


def test_the_browser_sends_the_same_greys(
    chromium: str, greys_set: StimulusSet, study: Study, store: Store
) -> None:
    require((BUNDLE / "index.html").is_file(), "needs the built front end (pip install -e .)")
    with (
        running_server(create_app(study, greys_set, store)) as url,
        open_chromium(chromium) as browser,
    ):
        participant = Participant(browser.new_context(**DESKTOP), f"{url}/s/{study.name}/")
        participant.begin()
        left, top, width, _ = participant.picture_box()
        assert width == WIDTH_PX
        shown = np.array(Image.open(BytesIO(participant.page.screenshot())).convert("RGB"))
    assert _bands(shown, round(left), round(top)) == GREYS


def _top_of_greys(shown: NDArray[np.uint8]) -> int:
    """Return the first row of the image, by its darkest grey."""
    column = (1280 - WIDTH_PX) // 2 + BAND_PX // 2
    return int(np.flatnonzero((shown[:, column] == GREYS[0]).all(axis=1))[0])


def _bands(shown: NDArray[np.uint8], left_px: int, top_px: int) -> tuple[int, ...]:
    """Return the grey of each band; its three colours must be equal."""
    middles = left_px + BAND_PX // 2 + BAND_PX * np.arange(len(GREYS))
    colours = shown[top_px + ROW_PX, middles]
    assert (colours == colours[:, :1]).all()
    return tuple(colours[:, 0].tolist())
