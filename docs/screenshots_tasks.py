"""Make docs/pictures/tasks-*.jpg: every task that compares, picks or only looks at images.

Run it from the root of the repository, with the folders of the sets `caustics` and `divergence`; it
needs Chromium, Xvfb and xdotool:

    python -m docs.screenshots_tasks CAUSTICS DIVERGENCE
"""

import io
import shutil
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Browser

import stimuli
from algorithms.files import make_folder, write_atomically
from experiments.storage.store import Store
from experiments.study import Study, load_study
from experiments.web import create_app, running_server
from stimuli.manifest import StimulusSet
from tests.comparison_studies import as_toml
from tests.lab.driver import MOUSE_TRACKER, Display, Sitting, open_display, save_monitor, start
from tests.web.browser import DESKTOP, PHONE, Participant, open_chromium

PICTURES = Path(__file__).parent / "pictures"
METHODS = ["photon-mapped", "revolved"]
KEYS = {"ranking": ("Right", "3", "space"), "pick": ("3", "6")}


def main() -> None:
    """Take every study to its first trial and its feedback, and save what is on the screen."""
    caustics, divergence = (stimuli.load(Path(folder).resolve()) for folder in sys.argv[1:])
    comparisons(caustics)
    objects(divergence)


def objects(stimulus_set: StimulusSet) -> None:
    """Save pictures of objects being picked, and of an image that is only looked at."""
    pick = _objects_study("pick", {"answers": {"picks": [1, 2]}, "practice": {"trials": 1}})
    view = _objects_study("free-viewing", {"timing": {"image_s": 2}})
    with open_chromium(shutil.which("chromium") or "chromium") as browser:
        desk = web(browser, pick, stimulus_set, DESKTOP)
        phone = web(browser, pick, stimulus_set, PHONE)
    save("tasks-objects-web", desk, columns=2, width_px=640)
    save("tasks-objects-phone", phone, columns=3, width_px=320)
    with open_display() as display:
        lab = [look for each in (view, pick) for look in window(display, each, stimulus_set)]
    save("tasks-gaze", lab, columns=2, width_px=640)


def _objects_study(task: str, parts: Mapping[str, Any]) -> Study:
    content: dict[str, Any] = load_study("lights-synthetic").model_dump(mode="json")
    own = {"name": task, "task": task, "demographics": [], "screen": {}, "exclusion": {}}
    content |= {"practice": {"trials": 0}} | own | dict(parts)
    if task == "free-viewing":
        content["stimuli"]["choices"] = None
    return Study.model_validate(content)


def comparisons(stimulus_set: StimulusSet) -> None:
    """Save pictures of pairs, judgements and rankings."""
    with open_chromium(shutil.which("chromium") or "chromium") as browser:
        desk = [look for each in studies() for look in web(browser, each, stimulus_set, DESKTOP)]
        phone = [web(browser, each, stimulus_set, PHONE)[0] for each in studies()]
    with open_display() as display:
        lab = [look for each in studies() for look in window(display, each, stimulus_set)]
    save("tasks-web", desk, columns=2, width_px=640)
    save("tasks-phone", phone, columns=4, width_px=320)
    save("tasks-lab", lab, columns=2, width_px=640)


def studies() -> list[Study]:
    """Return a study of each task about the pictures of caustics."""
    in_turn = {"blank_s": 0.5, "image_s": 0.8, "mask_s": 2.0}
    labels = {"labels": ["Photon-mapped", "Made up"]}
    lights = {"item": "light_deg", "within": ["object", "method"], "only": {"method": METHODS}}
    ranked = {"answers": {"labels": ["most real", "least real"], "ties": True}}
    practice = {"trials": 1, "best_first": METHODS}
    by_light = {"trials": 1, "best_first": ["120", "0", "180"]}
    return [
        _study("caustics-pairs", {}, practice=practice),
        _study("caustics-pairs", {}, name="in-turn", practice=practice, timing=in_turn),
        _study("fog-realism", {}, answers=labels),
        _study("caustics-ranking", lights, **ranked, practice=by_light),
    ]


def _study(ready_made: str, changes: Mapping[str, object], **parts: object) -> Study:
    content: dict[str, Any] = load_study(ready_made).model_dump(mode="json") | parts
    content["stimuli"] |= {"set": "caustics", "only": {"method": METHODS}, "conditions": []}
    content["stimuli"] |= changes
    return Study.model_validate(content | {"demographics": [], "screen": {}})


def web(
    browser: Browser, study: Study, stimulus_set: StimulusSet, size: Mapping[str, Any]
) -> list[Image.Image]:
    """Return the first trial in a browser, its mask where there is one, and the feedback."""
    with (
        tempfile.TemporaryDirectory() as temporary,
        Store.open(Path(temporary) / "responses.sqlite") as store,
        running_server(create_app(study, stimulus_set, store)) as url,
    ):
        context = browser.new_context(**size)
        participant = Participant(context, f"{url}/s/{study.name}/")
        page, looks = participant.page, []

        def look() -> None:
            looks.append(Image.open(io.BytesIO(page.screenshot())).convert("RGB"))

        participant.arrive()
        participant.consent()
        participant.press("Begin")
        page.locator(".trial .picture:not(.hidden)").first.wait_for()
        look()
        if study.timing.in_turn:
            page.locator("canvas").first.wait_for(state="visible")
            look()
        if study.task == "pick":
            page.wait_for_timeout(100)
            page.keyboard.press("3")
            page.keyboard.press("6")
            page.wait_for_timeout(100)
            look()
        page.locator(".trial footer button:enabled").first.wait_for()
        if study.practice.trials:
            if study.task == "pick":
                participant.press("Done")
            elif study.task == "ranking":
                page.locator(".ranked").nth(2).focus()
                page.keyboard.press("1")
                page.keyboard.press("Space")
                page.wait_for_timeout(300)
                look()
                participant.press("Done")
            else:
                page.keyboard.press("2")
            page.locator(".told[data-correct]").wait_for()
            page.wait_for_timeout(300)
            look()
        context.close()
        return looks


def window(display: Display, study: Study, stimulus_set: StimulusSet) -> list[Image.Image]:
    """Return the first trial in the lab's window, and its feedback."""
    with tempfile.TemporaryDirectory() as temporary:
        folder, looks = Path(temporary), []
        (folder / "study.toml").write_text(as_toml(study), encoding="utf-8")
        store, files = folder / "rows.sqlite", folder / "files"
        sitting = Sitting(folder / "study.toml", stimulus_set.folder, store, files, demographics={})
        if study.task == "free-viewing":
            (folder / "tracker.toml").write_text(MOUSE_TRACKER, encoding="utf-8")
            save_monitor(folder)
            known = {"monitor": "lab"}
            sitting = replace(sitting, tracker=folder / "tracker.toml", settings=known)
        with start(display, sitting, home=folder) as lab:
            while (page := lab.next_page()) not in ("feedback 0", "trial 1"):
                time.sleep(0.3)
                if page == "trial 0":
                    for key in KEYS.get(study.task, ()):
                        display.press(key)
                    time.sleep(0.3)
                    looks.append(Image.fromarray(display.screenshot()))
                if study.task == "free-viewing" and page == "trial 0":
                    continue
                chosen = page == "trial 0" and study.task not in KEYS
                display.press("2" if chosen else "Return")
            if page == "feedback 0":
                looks.append(Image.fromarray(display.screenshot()))
        return looks


def save(name: str, looks: Sequence[Image.Image], columns: int, width_px: int) -> None:
    """Save pictures as one sheet."""
    small = [each.resize((width_px, each.height * width_px // each.width)) for each in looks]
    high_px, gap_px = max(each.height for each in small), 8
    rows = -(-len(small) // columns)
    size = (columns * (width_px + gap_px) - gap_px, rows * (high_px + gap_px) - gap_px)
    sheet = Image.new("RGB", size, "white")
    for number, each in enumerate(small):
        row, column = divmod(number, columns)
        sheet.paste(each, (column * (width_px + gap_px), row * (high_px + gap_px)))
    content = io.BytesIO()
    sheet.save(content, "JPEG", quality=88, optimize=True)
    write_atomically(make_folder(PICTURES) / f"{name}.jpg", content.getvalue())


if __name__ == "__main__":
    main()
