"""Make docs/pictures/stimulus.png, stimuli.png and report.png: a stimulus, the set, the report.

Run it from the root of the repository, with the folder of a stimulus set that fits the study
`lights-synthetic`; it needs Chromium. The report is one of simulated answers, and says so:

    python -m docs.screenshots_report STIMULI
"""

import io
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import stimuli
from algorithms.files import make_folder, write_atomically
from analysis import analyse
from experiments.simulated.observers import Observer
from experiments.storage.store import Store
from experiments.study import load_study
from experiments.web import create_app, running_server
from experiments.web.simulate import simulate_over_http
from stimuli.contact_sheet import draw_contact_sheet
from stimuli.manifest import StimulusSet
from tests.web.browser import open_chromium

PICTURES = Path(__file__).parent / "pictures"
PAGE_PX = {"width": 1000, "height": 1500}


def main() -> None:
    """Save a stimulus, the contact sheet, and the first page of a report of simulated answers."""
    stimulus_set = stimuli.load(sys.argv[1])
    shown = next(s for s in stimulus_set.stimuli if s.factors["divergence_deg"] == 60)
    save(Image.open(stimulus_set.path(shown.file)), "stimulus")
    save(draw_contact_sheet(stimulus_set, columns=8, thumbnail_px=200), "stimuli")
    with tempfile.TemporaryDirectory() as temporary:
        show_report(stimulus_set, Path(temporary))


def show_report(stimulus_set: StimulusSet, folder: Path) -> None:
    """Let simulated observers take the study, and save the top of its report."""
    study, data = load_study("lights-synthetic"), folder / "responses.sqlite"
    observer = Observer({"front": 32.0, "back": 22.0, "front-back": 27.0}, 30.0, 0.02, "placement")
    with (
        Store.open(data) as store,
        running_server(create_app(study, stimulus_set, store)) as url,
    ):
        generator = np.random.default_rng(2011)
        simulate_over_http(url, 24, observer, study, stimulus_set, generator)
    report = analyse(data, folder / "report")
    with open_chromium(shutil.which("chromium") or "chromium") as browser:
        page = browser.new_page(viewport=PAGE_PX)  # type: ignore[arg-type]  # a ViewportSize
        page.goto(report.as_uri())
        save(Image.open(io.BytesIO(page.screenshot())), "report")


def save(picture: Image.Image, name: str) -> None:
    """Save a picture, as small as PNG goes."""
    content = io.BytesIO()
    picture.convert("RGB").save(content, "PNG", optimize=True)
    write_atomically(make_folder(PICTURES) / f"{name}.png", content.getvalue())


if __name__ == "__main__":
    main()
