"""What a real Chromium shows is what it lets one hit, in windows of any size and on a phone."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from algorithms.files import sha256_of
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.drawn_set import draw_set
from tests.web.browser import PHONE, OpenPage, stored

pytestmark = pytest.mark.browser


def shapes_set(folder: Path) -> StimulusSet:
    """Return the drawn set with black objects on white: what is seen tells what is a region."""
    drawn = draw_set(folder, levels_deg=(0, 40, 90), placements=("front",))
    for stimulus in drawn.stimuli:
        assert stimulus.regions is not None
        labels = np.asarray(Image.open(drawn.path(stimulus.regions)))
        Image.fromarray(np.where(labels > 0, 0, 255).astype(np.uint8)).save(
            drawn.path(stimulus.file)
        )
    digests = {stimulus.file: sha256_of(drawn.path(stimulus.file)) for stimulus in drawn.stimuli}
    return drawn.model_copy(update={"files": {**drawn.files, **digests}})


@pytest.mark.parametrize(
    ("width_px", "height_px", "pixel_ratio"),
    [(1280, 800, 1), (641, 403, 1), (333, 480, 1), (1001, 700, 1.25), (391, 640, 2), (297, 560, 3)],
)
def test_regions_are_exact_on_the_screen(
    open_page: OpenPage,
    tmp_path: Path,
    width_px: int,
    height_px: int,
    pixel_ratio: float,
) -> None:
    """Compare what the pointer hits with what a screenshot shows, device pixel by device pixel."""
    shapes = shapes_set(tmp_path)
    size = {"width": width_px, "height": height_px}
    window = {"viewport": size, "device_scale_factor": pixel_ratio}
    with open_page(stimuli=shapes, window=window) as participant:
        participant.begin()
        page = participant.page
        left, _, width, _ = participant.picture_box()
        page.screenshot(path=tmp_path / "screen.png")
        seen = np.asarray(Image.open(tmp_path / "screen.png").convert("L")).astype(int)
        row = int(participant.point_of(shapes, 2)[1] * pixel_ratio)
        columns = np.arange(round(left * pixel_ratio), round((left + width) * pixel_ratio))
        columns = columns[near_a_border(seen[row, columns])]
        shown = seen[row, columns]
        # Scaling mixes colours at a border: only pixels of one colour tell where they belong.
        natural = pixel_ratio == 1 and width == 320
        black, white = shown < (128 if natural else 10), shown > (127 if natural else 245)
        assert min(black.sum(), white.sum()) > 20
        hit = []
        for column in columns:
            page.mouse.move((column + 0.5) / pixel_ratio, (row + 0.5) / pixel_ratio)
            hit.append(page.locator(".picture.over-object").count() > 0)
        np.testing.assert_array_equal(np.array(hit)[black], True)
        np.testing.assert_array_equal(np.array(hit)[white], False)


def near_a_border(shown: np.ndarray) -> np.ndarray:
    """Mark what is within eight pixels of a change between dark and bright."""
    changes = np.flatnonzero(np.diff((shown < 128).astype(int)))
    distances = np.abs(np.arange(shown.size)[:, None] - changes[None, :])
    near: np.ndarray = distances.min(axis=1) <= 8
    return near


def test_a_click_beside_an_object_is_no_answer(open_page: OpenPage, store: Store) -> None:
    with open_page() as participant:
        participant.begin()
        left, top, _, _ = participant.picture_box()
        # Object 1 has its centre at pixel (40, 45) and a radius of 24: its row ends at pixel 64.
        participant.page.mouse.click(left + 65.5, top + 45.5)
        participant.page.mouse.click(left - 5, top + 45.5)
        assert participant.position == "Practice 1 of 3"
        participant.answer_by_mouse(0, 1, (left + 64.5, top + 45.5))
        participant.read_feedback()
        participant.wait_for_picture()
    assert stored(store) == {0: (1, "mouse")}


def test_a_window_that_is_too_small_cannot_begin(open_page: OpenPage, study: Study) -> None:
    with open_page(study=study, window={"viewport": {"width": 600, "height": 700}}) as participant:
        participant.arrive()
        button = participant.page.get_by_role("button", name="I have read this")
        assert button.is_disabled()
        assert "at least 640" in participant.page.locator(".fault").inner_text()
        participant.page.set_viewport_size({"width": 700, "height": 700})
        button.click()
        participant.page.get_by_label("Age in years").wait_for()


def test_a_phone_takes_the_study(open_page: OpenPage, store: Store, small_set: StimulusSet) -> None:
    def nothing_sticks_out() -> bool:
        wide = "document.scrollingElement.scrollWidth <= window.innerWidth"
        return bool(participant.page.evaluate(wide))

    with open_page(window=PHONE) as participant:
        participant.arrive()
        assert nothing_sticks_out()
        participant.consent()
        assert nothing_sticks_out()
        participant.describe_themself()
        participant.page.locator("figure .outline").wait_for()
        assert nothing_sticks_out()
        participant.press("Begin")
        participant.wait_for_picture()
        assert nothing_sticks_out()
        participant.page.touchscreen.tap(*participant.point_of(small_set, 3))
        participant.read_feedback()
        participant.wait_for_picture()
    assert stored(store) == {0: (3, "touch")}
