"""Every task with the same trials and answers: simulated, in the lab's window, in a browser."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page
from scipy import ndimage

from experiments import load_responses
from experiments.item_observers import ItemObserver, simulate_comparisons
from experiments.ordering import Order
from experiments.responses import DEVICE_COLUMNS, TIMING_COLUMNS
from experiments.store import Store
from experiments.study import Study
from experiments.trials import Answer
from experiments.web import create_app, running_server
from experiments.web.pages import BUNDLE
from stimuli.manifest import StimulusSet
from tests.comparison_studies import ITEMS, as_toml, comparison_study
from tests.conftest import require
from tests.drawn_set import draw_set
from tests.lab.driver import DRAWN_BACKGROUND, Display, LabProcess, Sitting, start
from tests.web.browser import DESKTOP, Participant, open_chromium

pytestmark = [pytest.mark.lab, pytest.mark.browser, pytest.mark.slow]

KEYS = {1: ("1", "Left"), 2: ("2", "Right")}
BRIEF = {"blank_s": 0.05}
IN_TURN = BRIEF | {"image_s": 0.1, "mask_s": 0.05}
TIMINGS = {"two-alternative": BRIEF, "in-turn": IN_TURN, "yes-no": BRIEF, "ranking": BRIEF}


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Six main stimuli: three placements of two materials."""
    return draw_set(tmp_path_factory.mktemp("tasks"), levels_deg=(90,))


@pytest.fixture(scope="module")
def studies(study: Study) -> list[Study]:
    """A short study of each task, and one whose pairs come one after the other."""
    studies = []
    for name, timing in TIMINGS.items():
        task = "two-alternative" if name == "in-turn" else name
        content = comparison_study(study, task).model_dump(mode="json")  # type: ignore[arg-type]
        changes = {"name": name, "timing": timing, "demographics": [], "screen": {}}
        studies.append(Study.model_validate(content | changes))
    return studies


@pytest.fixture(scope="module")
def simulated(
    studies: list[Study], few: StimulusSet, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, pd.DataFrame]:
    """What one simulated participant answers, by study."""
    data = tmp_path_factory.mktemp("simulated") / "rows.sqlite"
    observer = ItemObserver(dict.fromkeys(ITEMS, 0.0))
    with Store.open(data) as store:
        for study in studies:
            simulate_comparisons(study, few, store, observer, 1, np.random.default_rng(7))
    return {study.name: load_responses(data, study.name) for study in studies}


@pytest.fixture(scope="module")
def in_window(
    display: Display,
    studies: list[Study],
    few: StimulusSet,
    simulated: Mapping[str, pd.DataFrame],
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """The store of the lab's window after the same answers."""
    folder = tmp_path_factory.mktemp("window")
    sittings = []
    for study in studies:
        file = folder / f"{study.name}.toml"
        file.write_text(as_toml(study), encoding="utf-8")
        store = folder / "rows.sqlite"
        sittings.append(Sitting(file, few.folder, store, folder / study.name, demographics={}))
    with start(display, *sittings) as lab:
        for study in studies:
            answers = dict(enumerate(simulated[study.name]["answer"]))
            take_in_window(display, lab, study, answers)
    return folder / "rows.sqlite"


def take_in_window(
    display: Display, lab: LabProcess, study: Study, answers: Mapping[int, Answer]
) -> None:
    """Take a study from consent to thanks, by mouse and keyboard in turns."""
    while (page := lab.next_page()) != "completed":
        kind, _, number = page.partition(" ")
        if kind != "trial":
            display.press("Return")
            continue
        index, answer = int(number), answers[int(number)]
        if isinstance(answer, tuple):
            rank_in_window(display, answer, by_mouse=index % 2 == 1)
            display.press("Return")
        elif study.name == "two-alternative" and index % 2:
            display.click(*middles(display.screenshot())[int(answer or 0) - 1])
        else:
            button = 2 - int(answer or 0) if study.task == "yes-no" else int(answer or 0)
            display.press(KEYS[button][index % 2])


def middles(screenshot: NDArray[np.uint8]) -> list[tuple[int, int]]:
    """Return the middle of each drawn image on the screen, from left to right."""
    labels, _ = ndimage.label((screenshot == DRAWN_BACKGROUND).all(axis=2))
    found = [
        ((box[1].start + box[1].stop) // 2, (box[0].start + box[0].stop) // 2)
        for box in ndimage.find_objects(labels)
        if box[1].stop - box[1].start > 100
    ]
    return sorted(found)


def rank_in_window(display: Display, ranks: tuple[int, ...], *, by_mouse: bool) -> None:
    """Bring the images into order, the best first and so on."""
    places, selected = middles(display.screenshot()), -1
    for source, target in steps_to(ranks):
        if by_mouse:
            (x, y), (to_x, to_y) = places[source], places[target]
            display.do("mousemove", f"{x}", f"{y}", "mousedown", "1")
            display.do("mousemove", f"{(x + to_x) // 2}", f"{y}", "mousemove", f"{to_x}", f"{to_y}")
            display.do("mouseup", "1")
        else:
            for _ in range(source - selected):
                display.press("Right")
            display.press(str(target + 1))
            selected = target


def steps_to(ranks: tuple[int, ...]) -> Iterator[tuple[int, int]]:
    """Yield from where to where images go, so that their ranks are these."""
    order = Order.as_shown(len(ranks))
    for place in range(len(ranks)):
        source = order.images.index(ranks.index(place + 1))
        yield source, place
        order = order.moved(source, place)


@pytest.fixture(scope="module")
def in_browser(
    chromium: str,
    studies: list[Study],
    few: StimulusSet,
    simulated: Mapping[str, pd.DataFrame],
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """The store of the web server after the same answers."""
    require((BUNDLE / "index.html").is_file(), "needs the built front end (pip install -e .)")
    data = tmp_path_factory.mktemp("browser") / "rows.sqlite"
    with Store.open(data) as store, open_chromium(chromium) as browser:
        for study in studies:
            answers = dict(enumerate(simulated[study.name]["answer"]))
            with running_server(create_app(study, few, store)) as url:
                take_in_browser(browser, f"{url}/s/{study.name}/", study, answers)
    return data


def take_in_browser(
    browser: Browser, address: str, study: Study, answers: Mapping[int, Answer]
) -> None:
    """Take a study from consent to thanks, by mouse and keyboard in turns."""
    participant = Participant(browser.new_context(**DESKTOP), address)
    page = participant.page
    participant.arrive()
    participant.consent()
    participant.press("Begin")
    for index, answer in answers.items():
        page.get_by_text(f"Image {index + 1} of {len(answers)}").wait_for()
        page.locator(".trial footer button:enabled").first.wait_for()
        page.wait_for_timeout(40)  # the answer is awaited from the frame after the onset
        if isinstance(answer, tuple):
            rank_in_browser(page, answer, by_mouse=index % 2 == 1)
            participant.press("Done")
        elif study.name == "two-alternative" and index % 2:
            page.locator(".picture").nth(int(answer or 0) - 1).click()
        else:
            button = 2 - int(answer or 0) if study.task == "yes-no" else int(answer or 0)
            key, arrow = KEYS[button]
            page.keyboard.press(f"Arrow{arrow}" if index % 2 else key)
    participant.code()
    assert participant.complaints == []


def rank_in_browser(page: Page, ranks: tuple[int, ...], *, by_mouse: bool) -> None:
    """Bring the images into order, the best first and so on."""
    for source, target in steps_to(ranks):
        moved, there = (page.locator(".ranked").nth(place) for place in (source, target))
        if by_mouse:
            moved.drag_to(there)
        else:
            moved.focus()
            page.keyboard.press(str(target + 1))


@pytest.mark.parametrize("name", TIMINGS)
def test_rows_agree_in_all_but_time_device_and_runner(
    name: str, simulated: Mapping[str, pd.DataFrame], in_window: Path, in_browser: Path
) -> None:
    different = [*TIMING_COLUMNS, *DEVICE_COLUMNS, "simulated"]
    expected = simulated[name].drop(columns=different)
    assert len(set(expected["answer"].astype(str))) > 1
    for store, runner in ((in_window, "lab"), (in_browser, "web")):
        rows = load_responses(store, name)
        pd.testing.assert_frame_equal(rows.drop(columns=different), expected)
        assert set(rows["runner"]) == {runner}
        assert not rows["simulated"].any()
        assert (rows["reaction_time_s"] >= 0).all()
        if name in ("two-alternative", "ranking") and runner == "lab":
            assert set(rows["input"]) == {"keyboard"} | ({"mouse"} if "two" in name else set())
