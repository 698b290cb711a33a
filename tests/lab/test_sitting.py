"""What may happen in a sitting: leaving, coming back, dying, refusing, clicking at a border."""

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from experiments.lab.buttons import BUTTON_RGB
from experiments.responses import load_responses
from experiments.storage.store import Store
from tests.lab.driver import Display, Sitting, image_area, start, take_study

pytestmark = [pytest.mark.lab, pytest.mark.slow]


def answers_in(store: Path) -> dict[int, int]:
    rows = load_responses(store)
    return dict(zip(rows["trial_index"], rows["answer"], strict=True))


def test_a_session_goes_on_after_leaving_failing_and_being_killed(
    display: Display,
    sitting: Sitting,
    regions: NDArray[np.uint8],
    answers: Mapping[int, int],
    tmp_path: Path,
) -> None:
    """Four sittings of one session: every answer is stored once, none is asked for twice."""
    with start(display, sitting) as lab:
        some = {index: answers[index] for index in (0, 1)}
        assert take_study(display, lab, regions, some)[-1] == "trial 2"
        display.close("^Trompe$")  # as a window manager does
        assert lab.next_page() == "pause"
        display.press("Return")
        assert lab.next_page() == "trial 2"
        display.press("Escape")
        assert lab.next_page() == "pause"
        display.press("Escape")
        assert lab.next_page() == "left"
    assert answers_in(sitting.store) == some

    device, line = os.openpty()
    triggers = tmp_path / "triggers.toml"
    port = f'[port]\nkind = "serial"\naddress = "{os.ttyname(line)}"\n'
    triggers.write_text(f"{port}[[answer]]\ncode = 1\n", encoding="utf-8")
    with start(display, replace(sitting, triggers=triggers)) as lab:
        pages = take_study(display, lab, regions, {2: answers[2]})
        assert pages == ["instructions", "trial 2", "feedback 2", "main", "trial 3"]
        os.close(line)
        os.close(device)  # the device is gone
        display.press(str(answers[3]))
        assert lab.exit_code() == 2
        assert lab.error().splitlines()[-1].startswith("port.address: /dev/")
    more = {index: answers[index] for index in range(4)}
    assert answers_in(sitting.store) == more

    with start(display, sitting) as lab:
        assert take_study(display, lab, regions, {}) == ["instructions", "trial 4"]
        lab.kill()
        assert lab.exit_code() != 0
    assert answers_in(sitting.store) == more

    with start(display, sitting) as lab:
        pages = take_study(display, lab, regions, answers)
        assert pages == ["instructions", "trial 4", "trial 5", "trial 6", "thanks", "completed"]
    assert answers_in(sitting.store) == answers
    with Store.open(sitting.store, must_exist=True) as store:
        kinds = [event.kind for event in store.events()]
    left = ["pause", "continue", "pause", "leave"]
    assert kinds == [*left, "resume", "triggers", "failure", "resume", "resume"]
    tables = [pd.read_csv(path) for path in sorted(sitting.folder.glob("*.csv"))]
    assert [len(table) for table in tables] == [2, 2, 3]


def test_without_consent_nothing_of_the_participant_is_stored(
    display: Display, sitting: Sitting
) -> None:
    with start(display, sitting) as lab:
        assert lab.next_page() == "consent"
        display.press("Escape")
        assert lab.next_page() == "left"
    with Store.open(sitting.store, must_exist=True) as store:
        assert (store.sessions(), store.responses(), store.events()) == ([], [], [])
    assert list(sitting.folder.iterdir()) == []


def test_the_form_asks_what_the_study_declares_and_stores_nothing_when_it_is_left(
    display: Display, sitting: Sitting
) -> None:
    """Filled in by keyboard and mouse; what is missing or wrong is pointed out in the form."""
    asked = replace(sitting, participant=None, demographics=None)
    with start(display, asked, asked) as lab:
        assert lab.next_page() == "form"
        display.do("type", "P7")
        display.press("Escape")
        assert lab.next_page() == "left"
        with Store.open(sitting.store, must_exist=True) as store:
            assert (store.sessions(), store.responses(), store.events()) == ([], [], [])
        assert lab.next_page() == "form"
        before = display.screenshot()
        display.do("key", "Return")
        assert lab.is_quiet(0.3)  # no age
        assert (display.screenshot() != before).any()
        display.do("type", "121")
        display.do("key", "Return")
        assert lab.is_quiet(0.3)  # too old
        display.do("key", "BackSpace", "BackSpace", "BackSpace")
        display.do("type", "34")
        display.do("key", "Tab", "Right", "Right")
        display.do("key", "Down")
        display.click(*middles_of_boxes(display)[-1])
        display.do("key", "Down")
        display.do("type", "P 8")
        display.do("key", "Return")
        assert lab.is_quiet(0.3)  # no name
        display.do("key", "BackSpace", "BackSpace")
        display.do("type", "8")
        display.do("key", "Return")
        for page in ("consent", "instructions", "pause"):
            assert lab.next_page() == page
            display.press("Return" if page == "consent" else "Escape")
        assert lab.next_page() == "left"
    with Store.open(sitting.store, must_exist=True) as store:
        (session,) = store.sessions()
    assert session.participant == "P8"
    assert session.demographics == {"age": 34, "gender": "male", "artistic_background": False}


def middles_of_boxes(display: Display) -> list[tuple[int, int]]:
    """Return the middle of each field's or answer's box in the form, from top left."""
    labels, _ = ndimage.label((display.screenshot() == BUTTON_RGB).all(axis=2))
    return [
        ((box[1].start + box[1].stop) // 2, (box[0].start + box[0].stop) // 2)
        for box in ndimage.find_objects(labels)
        if box[1].stop - box[1].start > 100
    ]


WIDTH_DEG = 18.8
PARTS = "minimum_width_px = 640\nminimum_height_px = 400"
SMALL = "minimum_width_px = 300\nminimum_height_px = 200"


@pytest.mark.parametrize(
    ("screen", "settings", "width_px"),
    [
        (PARTS, {}, 320),
        (SMALL, {"fullscreen": False, "size_px": (301, 223)}, 301),
        (
            f"{PARTS}\n[display]\nwidth_deg = {WIDTH_DEG}",
            {"monitor": "lab"},
            # Theory: what is so wide at that distance, in pixels of that screen.
            round(2 * 60 * math.tan(math.radians(WIDTH_DEG / 2)) * 1280 / 53),
        ),
    ],
    ids=["as stored", "shrunk", "in degrees"],
)
def test_a_click_counts_from_the_first_to_the_last_pixel_of_a_region(
    display: Display,
    sitting: Sitting,
    regions: NDArray[np.uint8],
    write_study: Callable[[str, str], Path],
    monitors: Path,
    screen: str,
    settings: Mapping[str, Any],
    width_px: int,
) -> None:
    """Theory: a pixel belongs to the object on which its centre lies; its neighbour does not."""
    study = write_study(PARTS, screen)
    with start(display, replace(sitting, study=study, settings=settings), home=monitors) as lab:
        pages = take_study(display, lab, regions, {0: 1, 1: 2, 2: 3})
        assert image_area(display.screenshot()).width_px == width_px
        for label, side in zip((2, 3, 6, 7), ("left", "right", "top", "bottom"), strict=True):
            assert pages[-1] == f"trial {len(answers_in(sitting.store))}"
            inside, outside = border(display, regions, label, side)
            display.click(*outside)
            assert lab.is_quiet(0.3)
            display.click(*inside)
            pages.append(lab.next_page())
    assert list(answers_in(sitting.store).values()) == [1, 2, 3, 2, 3, 6, 7]


def border(
    display: Display, regions: NDArray[np.uint8], label: int, side: str
) -> tuple[tuple[int, int], tuple[int, int]]:
    """Return the last pixel of the screen on a region and the next one, on one of its sides."""
    area = image_area(display.screenshot())
    # By label, the object under the centre of every pixel of the image's area on the screen.
    rows = np.floor((np.arange(area.height_px) + 0.5) / area.height_px * regions.shape[0])
    columns = np.floor((np.arange(area.width_px) + 0.5) / area.width_px * regions.shape[1])
    labels = regions[np.ix_(rows.astype(int), columns.astype(int))]
    ys, xs = np.nonzero(labels == label)
    ys, xs = ys + area.top_px, xs + area.left_px
    x, y = int(np.median(xs)), int(np.median(ys))
    match side:
        case "left":
            x = int(xs[ys == y].min())
            return (x, y), (x - 1, y)
        case "right":
            x = int(xs[ys == y].max())
            return (x, y), (x + 1, y)
        case "top":
            y = int(ys[xs == x].min())
            return (x, y), (x, y - 1)
        case _:
            y = int(ys[xs == x].max())
            return (x, y), (x, y + 1)


def test_a_trial_without_an_answer_in_time_is_stored_as_such(
    display: Display, sitting: Sitting, write_study: Callable[[str, str], Path]
) -> None:
    study = write_study("blank_s = 0.5", "blank_s = 0.05\ntime_limit_s = 0.2")
    with start(display, replace(sitting, study=study)) as lab:
        while lab.next_page() != "thanks":
            display.press("Return")
        display.press("Return")
        assert lab.next_page() == "completed"
    rows = load_responses(sitting.store)
    assert len(rows) == 7
    assert rows["answer"].isna().all()
    assert rows["reaction_time_s"].isna().all()
    assert set(rows["input"]) == {"none"}


def test_keys_of_row_and_pad_answer_once_the_stimulus_is_there(
    display: Display, sitting: Sitting
) -> None:
    """Keys that name no object, and keys during the blank before a stimulus, are no answers."""
    with start(display, sitting) as lab:
        while lab.next_page() != "trial 0":
            display.press("Return")
        for index, key in enumerate(("KP_4", "KP_Left", "8")):
            display.press("9")
            assert lab.is_quiet(0.2)
            display.press(key)
            assert lab.next_page() == f"feedback {index}"
            display.press("Return")
            if index < 2:
                display.press("5")
                assert lab.next_page() == f"trial {index + 1}"
    assert answers_in(sitting.store) == {0: 4, 1: 4, 2: 8}
