"""The experimenter's window on a second screen, and what it is told."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from experiments.answers import Measurement
from experiments.lab.experimenter import DONE_RGB, TRACK_RGB
from experiments.lab.progress import Progress, Status
from tests.lab.driver import Display, Sitting, open_display, start, take_study
from tests.lab.x11 import split_screen

LEFT_PX, RIGHT_PX, HEIGHT_PX = 1280, 700, 800
PATIENCE_S = 20.0


@pytest.fixture
def two_screens() -> Iterator[Display]:
    """A virtual display that appears as two monitors."""
    with open_display(LEFT_PX + RIGHT_PX, HEIGHT_PX) as display:
        split_screen(display.name, LEFT_PX, LEFT_PX + RIGHT_PX, HEIGHT_PX)
        yield display


def share_done(display: Display) -> float:
    """Return which share of its bar the experimenter's window shows as done."""
    right = display.screenshot()[:, LEFT_PX:]
    done, track = ((right == rgb).all(axis=2).sum() for rgb in (DONE_RGB, TRACK_RGB))
    return float(done / max(1, done + track))


@pytest.mark.lab
@pytest.mark.slow
def test_the_second_screen_follows_the_sitting_and_cannot_end_it(
    two_screens: Display,
    sitting: Sitting,
    regions: NDArray[np.uint8],
    answers: Mapping[int, int],
) -> None:
    """The bar is as long as the share of answers; closing the window leaves the sitting alone."""
    nowhere = replace(sitting, experimenter_screen=9)
    with start(two_screens, nowhere, replace(sitting, experimenter_screen=1)) as lab:
        for count in (0, 2):
            pages = take_study(
                two_screens, lab, regions, {index: answers[index] for index in range(count)}
            )
            assert pages[-1] == f"trial {count}"
            until_s = time.monotonic() + PATIENCE_S
            while abs(share_done(two_screens) - count / len(answers)) > 0.01:
                assert time.monotonic() < until_s
                time.sleep(0.1)
            left = two_screens.screenshot()[:, :LEFT_PX]
            assert not (left == DONE_RGB).all(axis=2).any()
            if count == 0:
                two_screens.press(str(answers[0]))
        two_screens.close("Trompe: experimenter")
        two_screens.press(str(answers[2]))
        assert lab.next_page() == "feedback 2"
        lab.kill()
        assert lab.error().splitlines()[0].startswith("experimenter_screen: screen: 9 given, 0 to")


def test_the_time_left_is_that_of_the_median_pace() -> None:
    """Theory: trials of 10, 20 and 90 s, so 20 s for each of the four that are left."""
    times_s = iter((100.0, 110.0, 130.0, 220.0, 225.0))
    told: list[Status] = []
    progress = Progress(told.append, lambda: next(times_s))
    progress.announce("consent")
    progress.begin("P1", answers=1, trials=8)
    for late in (0, 2, 1):
        progress.answered(Measurement(1.0, 0.0, 0.0, 0.016, late, "mouse"), trials=8)
    progress.announce("trial 4")
    assert told[0].lines() == ["consent"]
    assert told[1] == Status("trial 4", "P1", 4, 8, 3, 1, 125.0, 80.0)
    assert told[1].lines() == [
        "P1: trial 4",
        "4 of 8 answers",
        "3 late frames, 1 in the last trial",
        "2:05 min so far, about 1:20 min left",
    ]
