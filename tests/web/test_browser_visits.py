"""Coming, going and coming back in a real Chromium: windows, recruitment, withdrawal, screens."""

import math
import random
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Route

from experiments.storage.store import Store
from experiments.study import Study, Task
from stimuli.manifest import StimulusSet
from tests.comparison_studies import comparison_study
from tests.drawn_set import draw_set
from tests.web.browser import DESKTOP, OpenPage, Participant, changed, stored

pytestmark = pytest.mark.browser

SHORT = {
    "timing": {"blank_s": 0.05},
    "screen": {},
    "demographics": [],
    "practice": {"trials": 0},
}
LOST = 0.3


@pytest.fixture(scope="module")
def two(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Two main images."""
    return draw_set(tmp_path_factory.mktemp("two"), levels_deg=(0,), placements=("front",))


def heading(page: Page, text: str) -> None:
    page.get_by_role("heading", name=text).wait_for()


def test_one_window_at_a_time_until_the_way_back_to_the_recruitment_service(
    open_page: OpenPage, browser: Browser, study: Study, two: StimulusSet, store: Store
) -> None:
    address = "https://service.example/done?cc={completion_code}&p={PID}"
    declared = {"parameters": ["PID"], "completion_url": address}
    recruiting = changed(study, recruitment=declared, **SHORT)
    with open_page(recruiting, two) as participant:
        participant.arrive()
        participant.page.get_by_text("follow the link").wait_for()  # it told nobody's name
        participant.address += "?PID=a%20b"
        participant.arrive()
        participant.consent()
        participant.press("Begin")
        participant.wait_for_picture()

        second = participant.context.new_page()
        second.goto(participant.address)
        other_context = browser.new_context(**DESKTOP)
        other = Participant(other_context, participant.address)
        other.arrive()
        for page in (second, other.page):
            heading(page, "The study is open in another window")
        participant.answer_by_key(0, 3)
        participant.page.reload()
        participant.press("Go on")
        participant.wait_for_picture()
        assert participant.position == "Image 2 of 2"
        heading(second, "The study is open in another window")
        heading(other.page, "The study is open in another window")

        second.close()  # or it might be the faster one
        participant.page.goto("about:blank")
        heading(other.page, "Welcome back")  # by itself, within some seconds
        other.press("Go on")
        other.wait_for_picture()
        arrived: list[str] = []

        def welcome(route: Route) -> None:
            arrived.append(route.request.url)
            route.fulfill(body="done")

        other_context.route("https://service.example/**", welcome)
        other.answer_by_key(1, 4)
        code = other.code()
        other.page.get_by_role("link", name="Go back to service.example").click()
        other.page.get_by_text("done").wait_for()
        assert arrived == [f"https://service.example/done?cc={code}&p=a%20b"]
        assert other.complaints == []
        other_context.close()
    assert stored(store) == {0: (3, "keyboard"), 1: (4, "keyboard")}
    assert len(store.sessions()) == 1


def test_a_screen_is_measured_and_filled_and_who_withdraws_leaves_nothing(
    open_page: OpenPage, study: Study, two: StimulusSet, store: Store
) -> None:
    screen = {"fullscreen": True, "calibrate": True, "distance": True, "color_gamut": "srgb"}
    with open_page(changed(study, **SHORT | {"screen": screen}), two) as participant:
        page = participant.page
        participant.arrive()
        participant.consent()
        slider = page.get_by_label("Width of the card")
        assert slider.bounding_box() is not None
        slider.press("End")
        for _ in range(4):
            slider.press("ArrowLeft")
        drawn = page.locator(".card").bounding_box()
        assert drawn is not None
        assert drawn["width"] / drawn["height"] == pytest.approx(85.6 / 53.98, rel=0.01)
        participant.press("They are equally wide")
        for number in range(1, 6):
            page.get_by_role("button", name=f"It has vanished ({number} of 5)").wait_for()
            page.wait_for_timeout(150)
            page.keyboard.press("Space")
        participant.press("Begin")
        participant.wait_for_picture()
        assert page.evaluate("document.fullscreenElement !== null")
        participant.answer_by_key(0, 3)
        participant.wait_for_picture()

        (session,) = store.sessions()
        told = session.screen
        px_per_mm = drawn["width"] / 85.6
        assert told["px_per_mm"] == pytest.approx(px_per_mm)
        # The dot moves 20 mm/s; five presses some 0.15 s after its start.
        assert 0.1 * 20 < told["distance_mm"] * math.tan(math.radians(13.5)) < 20
        assert told["color_gamut"] == "srgb"
        assert told["zoom"] == pytest.approx(1, abs=0.3)
        assert 20 < told["refresh_hz"] < 200
        assert {"kind": "fullscreen", "on": True} in [
            {"kind": event.kind, "on": event.detail.get("on")} for event in store.events()
        ]

        page.once("dialog", lambda dialog: dialog.dismiss())
        participant.press("Withdraw")
        assert participant.position == "Image 2 of 2"
        page.once("dialog", lambda dialog: dialog.accept())
        participant.press("Withdraw")
        heading(page, "You have withdrawn")
        page.keyboard.press("4")  # nothing runs on unseen
        page.wait_for_timeout(200)
        page.reload()
        page.get_by_role("button", name="I have read this").wait_for()
    (session,) = store.sessions()
    assert session.withdrawn_at is not None
    assert (session.screen, store.responses()) == ({}, [])
    assert [event.kind for event in store.events()] == ["withdrawal"]


def bad_network(page: Page, generator: random.Random) -> list[str]:
    """Lose a part of what is asked for: half of it on the way there, half on the way back."""
    lost: list[str] = []

    def carry(route: Route) -> None:
        luck = generator.random()
        if luck >= LOST:
            route.continue_()
            return
        lost.append(route.request.url)
        if luck < LOST / 2:
            route.fetch()
        route.abort()

    page.route(re.compile("/api/"), carry)
    return lost


def answered(participant: Participant, study: Study, index: int) -> None:
    """Give an answer, however the study asks for it, and wait for what follows."""
    page, before = participant.page, participant.position
    if study.task == "ranking":
        page.locator("button.primary:enabled").click()
    else:
        participant.wait_for_picture()
        page.keyboard.press(str(1 + index % 2))
    page.wait_for_function(
        "before => document.querySelector('.position span')?.textContent !== before", arg=before
    )


def network_studies(study: Study) -> Iterator[Study]:
    yield changed(study, **SHORT)
    tasks: tuple[Task, ...] = ("two-alternative", "ranking", "yes-no")
    for task in tasks:
        yield changed(comparison_study(study, task), **SHORT)


def test_all_tasks_are_complete_behind_a_network_that_loses_a_third_and_reloads(
    open_page: OpenPage, study: Study, tmp_path: Path
) -> None:
    few = draw_set(tmp_path, levels_deg=(90,))
    generator = random.Random(5)
    for asked in network_studies(study):
        with Store.open(tmp_path / f"{asked.name}.sqlite") as store:
            with open_page(asked, few, store=store) as participant:
                lost = bad_network(participant.page, generator)
                # The shortest waits before another try.
                participant.page.add_init_script("Math.random = () => 0.999;")
                participant.arrive()
                participant.consent()
                participant.press("Begin")
                participant.page.locator(".position").wait_for()
                total = int(participant.position.split()[-1])
                for index in range(total):
                    answered(participant, asked, index)
                    if index == total // 2 - 1:
                        participant.page.reload()
                        participant.press("Go on")
                        participant.page.locator(".position").wait_for()
                code = participant.code()
            assert lost
            (session,) = store.sessions()
            assert session.completion_code == code
            rows = store.responses()
            assert [row.trial_index for row in rows] == list(range(total))
            assert all(row.answer is not None for row in rows)
