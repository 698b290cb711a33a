"""Every task with the same trials and answers: simulated, in the lab's window, in a browser."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page
from scipy import ndimage

from algorithms.images import read_labels
from analysis import fixations_by_velocity
from experiments import load_responses
from experiments.exports.collection import load_collection
from experiments.gaze import load_gaze
from experiments.lab.geometry import Area
from experiments.ordering import Order
from experiments.planning.replay import replay_session
from experiments.planning.trials import Answer
from experiments.responses import DECISION, DEVICE_COLUMNS, ESTIMATES, POOL, TIMING_COLUMNS
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer, simulate_responses
from experiments.simulated.simulation import simulate_in_process
from experiments.simulated.viewers import Viewer, simulate_viewing
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.pages import BUNDLE
from stimuli.manifest import StimulusSet
from tests.comparison_studies import (
    ITEMS,
    as_toml,
    comparison_study,
    pick_study,
    viewing_study,
)
from tests.conftest import require
from tests.drawn_set import HEIGHT_PX, WIDTH_PX, draw_set
from tests.lab.driver import (
    DRAWN_BACKGROUND,
    MOUSE_TRACKER,
    Display,
    LabProcess,
    Sitting,
    point_in,
    start,
)
from tests.web.browser import DESKTOP, Participant, open_chromium

pytestmark = [pytest.mark.lab, pytest.mark.browser, pytest.mark.slow]

KEYS = {1: ("1", "Left"), 2: ("2", "Right")}
BRIEF = {"blank_s": 0.05}
IN_TURN = BRIEF | {"image_s": 0.1, "mask_s": 0.05}
TIMINGS = {
    "two-alternative": BRIEF,
    "in-turn": IN_TURN,
    "yes-no": BRIEF,
    "ranking": BRIEF,
    "active-pairs": BRIEF,
    "pick": BRIEF,
    "free-viewing": BRIEF | {"image_s": 1.2},
}
LAB_ONLY = ("free-viewing",)
VIEWED = Area(480, 322, WIDTH_PX, HEIGHT_PX)  # where an image that is only looked at lies
# The mouse stands for the eyes while objects are picked, and while images are looked at.
TRACKED = ("pick", "free-viewing")
PICKS = (1, 2)
ACTIVE: dict[str, Any] = {"kind": "active-pairs", "active_pairs": {"trials": 6}}


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Six main stimuli: three placements of two materials."""
    return draw_set(tmp_path_factory.mktemp("tasks"), levels_deg=(90,))


@pytest.fixture(scope="module")
def studies(study: Study) -> list[Study]:
    """A short study of each task, and one whose pairs come one after the other."""
    studies = []
    for name, timing in TIMINGS.items():
        changes: dict[str, Any] = {"name": name, "timing": timing, "demographics": [], "screen": {}}
        if name == "pick":
            asked = pick_study(study, PICKS)
        elif name == "free-viewing":
            asked = viewing_study(study, timing["image_s"])
        else:
            task: Any = "two-alternative" if name in ("in-turn", "active-pairs") else name
            design = ACTIVE if name == "active-pairs" else {}
            asked = comparison_study(study, task, **design)
        content = asked.model_dump(mode="json")
        studies.append(Study.model_validate(content | changes))
    return studies


@pytest.fixture(scope="module")
def simulated(
    studies: list[Study], few: StimulusSet, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, pd.DataFrame]:
    """What one simulated participant answers, by study."""
    data = tmp_path_factory.mktemp("simulated") / "rows.sqlite"
    observer = ItemObserver(dict.fromkeys(ITEMS, 0.0))
    compared = [study for study in studies if study.name not in TRACKED]
    pick, viewing = (study for study in studies if study.name in TRACKED)
    generator = np.random.default_rng(7)
    with Store.open(data) as store:
        for study in compared:
            simulate_in_process(study, few, store, observer, 1, np.random.default_rng(2))
        simulate_viewing(viewing, few, store, Viewer(), 1, generator, data.parent)
    rows = {study.name: load_responses(data, study.name) for study in [*compared, viewing]}
    rows["pick"] = simulate_responses(pick, few, Observer(90, 30), 1, np.random.default_rng(7))
    assert set(rows["pick"]["answer"].map(len)) == set(PICKS)
    return rows


@pytest.fixture(scope="module")
def in_window(
    display: Display,
    studies: list[Study],
    few: StimulusSet,
    simulated: Mapping[str, pd.DataFrame],
    monitors: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    """The store of the lab's window after the same answers."""
    folder = tmp_path_factory.mktemp("window")
    (folder / "tracker.toml").write_text(MOUSE_TRACKER, encoding="utf-8")
    sittings = []
    for study in studies:
        file = folder / f"{study.name}.toml"
        file.write_text(as_toml(study), encoding="utf-8")
        store = folder / "rows.sqlite"
        sitting = Sitting(file, few.folder, store, folder / study.name, demographics={})
        if study.name in TRACKED:
            settings = {"monitor": "lab"}
            sitting = replace(sitting, tracker=folder / "tracker.toml", settings=settings)
        sittings.append(sitting)
    with start(display, *sittings, home=monitors) as lab:
        for study in studies:
            answers = dict(enumerate(simulated[study.name]["answer"]))
            take_in_window(display, lab, study, answers, read_labels(few.path("regions.png")))
    return folder / "rows.sqlite"


def take_in_window(
    display: Display,
    lab: LabProcess,
    study: Study,
    answers: Mapping[int, Answer],
    regions: NDArray[np.uint8],
) -> None:
    """Take a study from consent to thanks, by mouse and keyboard in turns."""
    while (page := lab.next_page()) != "completed":
        kind, _, number = page.partition(" ")
        if kind != "trial":
            display.press("Return")
            continue
        index, answer = int(number), answers[int(number)]
        if study.task == "free-viewing":
            display.do("mousemove", *map(str, point_in(regions, looked_at(index), VIEWED)))
        elif study.task == "pick" and isinstance(answer, tuple):
            pick_in_window(display, answer, regions, by_mouse=index % 2 == 1)
        elif isinstance(answer, tuple):
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


def pick_in_window(
    display: Display, labels: tuple[int, ...], regions: NDArray[np.uint8], *, by_mouse: bool
) -> None:
    """Pick objects, one of them after another that is taken back."""
    taken_back = 8 if 8 not in labels else 7
    display.press("Return")  # nothing is picked: no answer yet
    display.press(str(taken_back))
    display.press(str(taken_back))
    if not by_mouse:
        for label in labels:
            display.press(str(label))
        display.press("Return")
        return
    for label in reversed(labels):
        display.click(*point_of(display, regions, label))
    display.click(640, 712)  # the button below the image


def point_of(display: Display, regions: NDArray[np.uint8], label: int) -> tuple[int, int]:
    """Return a point of the screen in the middle of an object of the only image."""
    ((x, y),) = middles(display.screenshot())
    area = Area(x - WIDTH_PX // 2, y - HEIGHT_PX // 2, WIDTH_PX, HEIGHT_PX)
    return point_in(regions, label, area)


def looked_at(index: int) -> int:
    """Return the object that the mouse, for the eyes, goes to in a trial."""
    return index + 2


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
            if study.name in LAB_ONLY:
                continue
            answers = dict(enumerate(simulated[study.name]["answer"]))
            with running_server(create_app(study, few, store)) as url:
                take_in_browser(browser, f"{url}/s/{study.name}/", study, few, answers)
    return data


def take_in_browser(
    browser: Browser,
    address: str,
    study: Study,
    stimuli: StimulusSet,
    answers: Mapping[int, Answer],
) -> None:
    """Take a study from consent to thanks, by mouse and keyboard in turns."""
    participant = Participant(browser.new_context(**DESKTOP), address)
    page = participant.page
    participant.arrive()
    participant.consent()
    participant.press("Begin")
    for index, answer in answers.items():
        of = ", at most" if study.design.is_adaptive else " of"
        page.get_by_text(f"Image {index + 1}{of} {len(answers)}").wait_for()
        page.locator(".trial .picture:not(.hidden)").first.wait_for()
        if study.task != "pick":
            page.locator(".trial footer button:enabled").first.wait_for()
        page.wait_for_timeout(40)  # the answer is awaited from the frame after the onset
        if study.task == "pick" and isinstance(answer, tuple):
            pick_in_browser(participant, answer, stimuli, by_mouse=index % 2 == 1)
        elif isinstance(answer, tuple):
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


def pick_in_browser(
    participant: Participant, labels: tuple[int, ...], stimuli: StimulusSet, *, by_mouse: bool
) -> None:
    """Pick objects, one of them after another that is taken back."""
    page, taken_back = participant.page, 8 if 8 not in labels else 7
    done = page.get_by_role("button", name="Done")
    assert done.is_disabled()
    page.keyboard.press(str(taken_back))
    page.keyboard.press(str(taken_back))
    for label in labels:
        if by_mouse:
            page.mouse.click(*participant.point_of(stimuli, label))
        else:
            page.keyboard.press(str(label))
    assert page.locator(".outline").count() == len(labels)
    if by_mouse:
        done.click()
    else:
        page.keyboard.press("Enter")


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
    asked = name != "free-viewing"
    assert len(set(expected["answer"].astype(str))) > 1 or not asked
    for store, runner in ((in_window, "lab"), (in_browser, "web")):
        if runner == "web" and name in LAB_ONLY:
            continue
        rows = load_responses(store, name)
        pd.testing.assert_frame_equal(rows.drop(columns=different), expected)
        assert set(rows["runner"]) == {runner}
        assert not rows["simulated"].any()
        assert rows["reaction_time_s"].isna().all() or (rows["reaction_time_s"] >= 0).all()
        assert rows["reaction_time_s"].notna().all() == asked
        if name in ("two-alternative", "ranking", "pick") and runner == "lab":
            assert set(rows["input"]) == {"keyboard"} | ({"mouse"} if name != "ranking" else set())


def test_decisions_of_an_adaptive_design_agree_and_are_replayed(
    in_window: Path, in_browser: Path
) -> None:
    logged = []
    for store in (in_window, in_browser):
        held = load_collection(store, "active-pairs")
        (session,) = held.sessions
        replayed = replay_session(held.study, held.stimuli, session, held.responses, held.events)
        assert (replayed.trials, replayed.difference) == (6, None)
        logged.append([e.detail for e in held.events if e.kind in (POOL, DECISION, ESTIMATES)])
    assert logged[0] == logged[1]
    assert len(logged[0]) == 8


def test_gaze_is_kept_trial_by_trial_on_the_image(few: StimulusSet, in_window: Path) -> None:
    """The mouse rests on another object in each trial: there the tracker must have seen it."""
    regions = read_labels(few.path("regions.png"))
    with Store.open(in_window, must_exist=True) as store:
        events = {name: store.events(study=name) for name in TRACKED}
    for name in TRACKED:
        gaze, degree_px = load_gaze(events[name])
        trials = gaze.groupby("trial_index")["stimulus"].first().reset_index()
        assert len(trials) == 6
        assert gaze["valid"].all()
        assert (gaze["time_s"] >= 0).all()
        degrees = list(degree_px.values())
        assert degrees == pytest.approx([25.3] * 6, abs=0.1)  # 1280 px on 53 cm, seen from 60 cm
        if name == "free-viewing":
            durations_s = gaze.groupby("trial_index")["time_s"].max()
            assert durations_s.between(1.1, 2).all()
            last = fixations_by_velocity(gaze, degrees[0]).table.groupby("trial_index").last()
            rested = [regions[int(y), int(x)] for x, y in zip(last.x_px, last.y_px, strict=True)]
            assert rested == [looked_at(index) for index in range(6)]
