"""A real Chromium, and a participant who uses the study's pages in it."""

import re
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

from experiments.planning.trials import Answer
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet

# No GPU and no user namespaces are needed, and nothing is asked of other machines.
OPTIONS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--force-color-profile=srgb",
    # A name for this machine that is not `localhost`: there browsers grant fewer rights.
    "--host-resolver-rules=MAP study.example 127.0.0.1",
)

DESKTOP: dict[str, Any] = {"viewport": {"width": 1280, "height": 800}}
PHONE: dict[str, Any] = {
    "viewport": {"width": 390, "height": 844},
    "device_scale_factor": 3,
    "is_mobile": True,
    "has_touch": True,
}

# What Chromium itself says of requests that a test cuts off or lets fail.
_CUT_OFF = re.compile(r"Failed to load resource: (net::ERR_|the server responded with a status)")


@contextmanager
def open_chromium(executable: str) -> Iterator[Browser]:
    """Run the Chromium of that path."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=executable, args=list(OPTIONS))
        try:
            yield browser
        finally:
            browser.close()


@dataclass
class Participant:
    """Someone in front of a study's pages; remembers what they did and what the browser said."""

    context: BrowserContext
    address: str
    given: dict[int, tuple[int, str]] = field(default_factory=dict)
    complaints: list[str] = field(default_factory=list)
    page: Page = field(init=False)

    def __post_init__(self) -> None:
        self.page = self.context.new_page()
        self.page.set_default_timeout(15_000)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("console", lambda message: self._listen(message.type, message.text))

    def _listen(self, kind: str, text: str) -> None:
        if kind in ("error", "warning") and not _CUT_OFF.match(text):
            self.complaints.append(text)

    def arrive(self) -> None:
        self.page.goto(self.address)
        self.page.wait_for_selector("main.page h1")

    def consent(self) -> None:
        self.press("I have read this")

    def describe_themself(self, age: int = 33) -> None:
        self.page.get_by_label("Age in years").fill(str(age))
        self.page.get_by_label("Prefer not to say").check()
        self.page.get_by_label("Yes").check()
        self.press("Continue")

    def begin(self) -> None:
        """Go from the consent page to the first trial."""
        self.arrive()
        self.consent()
        self.describe_themself()
        self.press("Begin")
        self.wait_for_picture()

    def press(self, name: str) -> None:
        self.page.get_by_role("button", name=name).click()

    def wait_for_picture(self) -> None:
        """Wait for the picture of a trial that is still to be answered."""
        self.page.wait_for_selector(".trial .hint")
        self.page.wait_for_selector(".trial .picture:not(.hidden)")
        self.page.wait_for_timeout(60)  # the answer is awaited from the frame after the onset

    @property
    def position(self) -> str:
        """Where the trial on the page stands, as `Image 3 of 6`."""
        return self.page.locator(".position span").inner_text()

    def answer_by_key(self, index: int, answer: int, key: str | None = None) -> None:
        before = self.position
        self.page.keyboard.press(key or str(answer))
        self._remember(index, answer, "keyboard", before)

    def answer_by_mouse(self, index: int, answer: int, at: tuple[float, float]) -> None:
        before = self.position
        self.page.mouse.click(*at)
        self._remember(index, answer, "mouse", before)

    def _remember(self, index: int, answer: int, how: str, before: str) -> None:
        self.given[index] = (answer, how)
        self.page.wait_for_function(
            "before => document.querySelector('.position span')?.textContent !== before"
            " || document.querySelector('.told') !== null",
            arg=before,
        )

    def pass_practice(self, trials: int = 3) -> None:
        """Answer the practice trials and read their feedback."""
        for index in range(trials):
            self.wait_for_picture()
            self.answer_by_key(index, index + 1)
            self.read_feedback()
        self.wait_for_picture()

    def read_feedback(self) -> str:
        """Return what the feedback says, and go on."""
        button = self.page.get_by_role("button", name="Continue")
        button.wait_for()
        told = self.page.locator(".told").inner_text()
        button.click()
        return told

    def picture_box(self) -> tuple[float, float, float, float]:
        """Return left, top, width and height of the picture in CSS pixels."""
        box = self.page.locator(".picture img").bounding_box()
        assert box is not None
        return box["x"], box["y"], box["width"], box["height"]

    def point_of(self, stimuli: StimulusSet, label: int) -> tuple[float, float]:
        """Return a point of the page in the middle of an object."""
        regions = stimuli.stimuli[0].regions
        assert regions is not None
        labels = np.asarray(Image.open(stimuli.path(regions)))
        rows, columns = np.nonzero(labels == label)
        left, top, width, height = self.picture_box()
        return (
            left + (columns.mean() + 0.5) / labels.shape[1] * width,
            top + (rows.mean() + 0.5) / labels.shape[0] * height,
        )

    def code(self) -> str:
        """Wait for the completion code and return it."""
        return self.page.locator(".code output").inner_text()


# Takes a study, a stimulus set and Playwright's options of a window; each has a default.
OpenPage = Callable[..., AbstractContextManager[Participant]]


def changed(study: Study, **parts: object) -> Study:
    """Return a study with some of its parts replaced."""
    return Study.model_validate({**study.model_dump(), **parts})


def stored(store: Store) -> dict[int, tuple[Answer, str]]:
    """Return the stored answers as `Participant.given` has them."""
    return {row.trial_index: (row.answer, row.input) for row in store.responses()}
