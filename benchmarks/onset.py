"""Whether images appear in the browser in the frame for which they were asked.

    python -m benchmarks.onset --output onset.json

A participant in headless Chromium, whose frames come at 60 Hz, answers the trials of a drawn study.
The player says when it asked for each image (`onset_requested_s`); when the image was painted is
measured by the browser itself, independently of the player's clock: the `renderTime` of its Element
Timing entry. At most one frame lies between the two if the image appears as soon as it can: what is
changed in a frame is shown with the next one. Chromium rounds `renderTime` to 4 ms, which is
allowed for.
"""

import argparse
import shutil
import tempfile
from pathlib import Path
from typing import Any, Final

import numpy as np

from benchmarks.results import machine, write_result
from experiments.storage.store import Store
from experiments.study import load_study
from experiments.web import create_app, running_server
from tests.drawn_set import draw_set
from tests.web.browser import DESKTOP, Participant, changed, open_chromium

FRAME_S: Final = 1 / 60
ROUNDING_S: Final = 0.004
# Each image is marked before it is ever shown; what the browser saw of them is kept.
_WATCH: Final = """
window.seen = [];
new PerformanceObserver(list => window.seen.push(
  ...list.getEntries().map(entry => entry.renderTime / 1000)
)).observe({ type: "element", buffered: true });
const NewImage = window.Image;
window.Image = function () {
  const image = new NewImage();
  image.setAttribute("elementtiming", "stimulus");
  return image;
};
"""


def measure(trials: int) -> tuple[list[float], list[float], list[float]]:
    """Return requested and painted onsets and frame intervals of a session, in seconds."""
    quick = {"timing": {"blank_s": 0.1}, "practice": {"trials": 0}, "demographics": []}
    with (
        tempfile.TemporaryDirectory() as folder,
        Store.open(Path(folder) / "responses.sqlite") as store,
        open_chromium(shutil.which("chromium") or "chromium") as browser,
    ):
        stimuli = draw_set(Path(folder))
        study = changed(load_study("lights-synthetic"), **quick)
        with running_server(create_app(study, stimuli, store)) as url:
            participant = Participant(browser.new_context(**DESKTOP), f"{url}/s/{study.name}/")
            participant.page.add_init_script(_WATCH)
            participant.arrive()
            participant.consent()
            participant.press("Begin")
            for index in range(min(trials, len(stimuli.with_role("main")) - 1)):
                participant.wait_for_picture()
                participant.answer_by_key(index, 1 + index % 8)
            participant.wait_for_picture()
            painted = participant.page.evaluate("window.seen")
            participant.context.close()
        rows = store.responses()
    requested = [row.onset_requested_s for row in rows if row.onset_requested_s is not None]
    intervals = [row.frame_interval_s for row in rows if row.frame_interval_s is not None]
    return requested, painted, intervals


def first_after(moments: list[float], at: float) -> float:
    """Return the first of the moments that is not before another."""
    return min((each for each in moments if each >= at - ROUNDING_S), default=float("inf"))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sessions", type=int, default=4)
    parser.add_argument("--trials", type=int, default=60)
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    result: dict[str, Any] = {"machine": machine(), "frame_ms": 1000 * FRAME_S}
    delays_s, frames_s = [], []
    for _ in range(arguments.sessions):
        requested, painted, intervals = measure(arguments.trials)
        delays_s += [first_after(painted, at) - at for at in requested]
        frames_s += intervals
    delays, allowed_s = np.array(delays_s), FRAME_S + ROUNDING_S
    result |= {
        "images": len(delays),
        "frame_interval_ms": 1000 * float(np.median(frames_s)),
        "within_one_frame": float(np.mean(delays <= allowed_s)),
        "delay_ms": {
            name: 1000 * float(np.percentile(delays, share))
            for name, share in (("median", 50), ("p95", 95), ("p99", 99), ("max", 100))
        },
    }
    write_result(result, arguments.output)


if __name__ == "__main__":
    main()
