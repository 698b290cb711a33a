"""Make docs/pictures/trial*.png and web-*.png: the web runner's pages in a real Chromium.

Run it from the root of the repository, with the folder of a stimulus set that fits the study
`lights-synthetic`; it needs Chromium:

    python -m docs.screenshots_web STIMULI
"""

import io
import shutil
import sys
import tempfile
from pathlib import Path

import httpx
from PIL import Image
from playwright.sync_api import Browser, Page

import stimuli
from algorithms.files import make_folder, write_atomically
from experiments.storage.store import Store
from experiments.study import Study, load_study
from experiments.web import create_app, running_server
from experiments.web.service import researcher_token
from tests.web.browser import DESKTOP, PHONE, Participant, changed, open_chromium
from tests.web.visitor import Visitor

PICTURES = Path(__file__).parent / "pictures"


def main() -> None:
    """Walk through the study at a desk and on a phone, and save what is on the screen."""
    # Phones held upright are narrower than the study allows; they are shown all the same.
    study = changed(load_study("lights-synthetic"), screen={})
    with (
        tempfile.TemporaryDirectory() as temporary,
        Store.open(Path(temporary) / "responses.sqlite") as store,
        running_server(create_app(study, stimuli.load(sys.argv[1]), store)) as url,
        open_chromium(shutil.which("chromium") or "chromium") as browser,
    ):
        show_desk(browser, study, url, researcher_token(store))
        show_phone(browser, study, url)


def show_desk(browser: Browser, study: Study, url: str, token: str) -> None:
    """Save instructions, feedback, a main trial and the researcher's page."""
    context = browser.new_context(**DESKTOP)
    participant = Participant(context, f"{url}/s/{study.name}/")
    page = participant.page
    participant.arrive()
    participant.consent()
    participant.describe_themself()
    page.locator("figure .outline").wait_for()
    save(page, "web-instructions")
    participant.press("Begin")
    participant.wait_for_picture()
    participant.answer_by_key(0, 2)
    page.locator(".outline").wait_for()
    save(page, "web-feedback")
    participant.read_feedback()
    for index in range(1, study.practice.trials):
        participant.wait_for_picture()
        participant.answer_by_key(index, 2)
        participant.read_feedback()
    participant.wait_for_picture()
    save(page, "trial")
    with httpx.Client(base_url=url) as client:
        for answers in (63, 63, 40):
            simulated = Visitor(client).begin(simulated=True)
            for index in range(answers):
                simulated.answer(index)
            simulated.post("/complete", {})
    page.goto(f"{url}/researcher/{study.name}/#{token}")
    page.locator("tbody tr").first.wait_for()
    save(page, "web-researcher")
    context.close()


def show_phone(browser: Browser, study: Study, url: str) -> None:
    """Save a trial on a phone."""
    context = browser.new_context(**PHONE)
    participant = Participant(context, f"{url}/s/{study.name}/")
    participant.begin()
    save(participant.page, "trial-phone")
    context.close()


def save(page: Page, name: str) -> None:
    """Save what the window shows, as small as PNG goes."""
    content = io.BytesIO()
    Image.open(io.BytesIO(page.screenshot())).convert("RGB").save(content, "PNG", optimize=True)
    write_atomically(make_folder(PICTURES) / f"{name}.png", content.getvalue())


if __name__ == "__main__":
    main()
