"""The tasks of comparison in a real Chromium: what only a browser can show."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page

from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.comparison_studies import comparison_study
from tests.drawn_set import draw_set
from tests.web.browser import PHONE, OpenPage, changed

pytestmark = pytest.mark.browser

BRIEF = {"timing": {"blank_s": 0.05}, "screen": {}, "demographics": []}


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Three placements of two materials, and three placements for practice."""
    return draw_set(tmp_path_factory.mktemp("few"), levels_deg=(90,))


def drag_by_touch(page: Page, source: int, target: int) -> None:
    """Drag the image in one place to another with a finger, by way of the middle."""
    boxes = [page.locator(".ranked").nth(place).bounding_box() for place in (source, target)]
    (x, y), (to_x, to_y) = [
        (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2) for box in boxes if box
    ]
    moved = page.locator(".ranked img").nth(source).get_attribute("src")
    touch = page.context.new_cdp_session(page)
    for kind, points in (
        ("touchStart", [{"x": x, "y": y}]),
        ("touchMove", [{"x": (x + to_x) / 2, "y": (y + to_y) / 2}]),
        ("touchMove", [{"x": to_x, "y": to_y}]),
        ("touchEnd", []),
    ):
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    arrived = page.locator(".ranked").nth(target).locator(f"img[src='{moved}']")
    arrived.wait_for()
    page.wait_for_function("document.getAnimations().length === 0")  # the others have made room


def test_a_finger_orders_images_and_ties_them(
    open_page: OpenPage, study: Study, few: StimulusSet, store: Store
) -> None:
    ranking = changed(comparison_study(study, "ranking"), answers={"ties": True}, **BRIEF)
    with open_page(ranking, few, PHONE) as participant:
        page = participant.page
        participant.arrive()
        participant.consent()
        page.get_by_role("button", name="Begin").tap()
        page.locator("button.primary:enabled").wait_for()
        drag_by_touch(page, 2, 0)  # the third image first
        tie = page.locator(".tie").nth(1)  # and the other two alike
        tie.tap()
        if tie.get_attribute("aria-pressed") != "true":
            # A busy browser takes a tap that follows a drag at once for a part of it.
            page.wait_for_timeout(1000)
            tie.tap()
        page.get_by_role("button", name="Done").tap()
        page.get_by_text("Image 2 of 2").wait_for()
        page.locator("button.primary:enabled").wait_for()
        page.get_by_role("button", name="Done").tap()
        participant.code()
    rows = store.responses()
    assert [row.answer for row in rows] == [(2, 2, 1), (1, 2, 3)]
    assert {row.input for row in rows} == {"touch"}


def practised(study: Study) -> Iterator[tuple[Study, str, str]]:
    order = {"trials": 1, "best_first": ["back", "front", "front-back"]}
    within = {"set": "divergence", "item": "placement"}
    for task in ("two-alternative", "ranking"):
        compared = comparison_study(study, task)
        yield (
            changed(compared, practice=order, stimuli=within | {"within": ["material"]}, **BRIEF),
            "1" if task == "two-alternative" else "Done",
            "the image to choose is" if task == "two-alternative" else "this is the order",
        )


def test_practice_with_comparisons_tells_the_declared_order(
    open_page: OpenPage, study: Study, few: StimulusSet, store: Store
) -> None:
    for practice, answer, told in practised(study):
        with open_page(practice, few) as participant:
            participant.arrive()
            participant.consent()
            participant.press("Begin")
            participant.page.locator(".trial footer button:enabled").first.wait_for()
            participant.page.wait_for_timeout(60)
            if answer == "1":
                participant.page.keyboard.press(answer)
                marked = participant.page.locator(".picture.marked")
                marked.wait_for()
                right = marked.evaluate("it => [...it.parentElement.children].indexOf(it)") + 1
                verdict = "Right" if right == 1 else "Not quite"
            else:
                participant.press(answer)
                verdict = "Not quite"  # shown as front, back, front-back
            assert participant.read_feedback().startswith(f"{verdict}: {told}")
    assert len(store.responses()) == 2
