"""When the lab's window shows a stimulus against when it was asked for, as JSON.

    python -m benchmarks.lab_onset [--repeats N] [--output FILE]

Needs Xvfb and xdotool. A sitting of `lights-synthetic` with a drawn set, keys by real X11 input.
Onsets are those of the stored rows. Another X client watches the photodiode's square on the server
meanwhile: it tells when the first frame was there for others to see, independently of the player's
own clock. Xvfb has no vertical blank: this measures the program; a monitor's delay comes on top.
"""

import argparse
import json
import tempfile
import threading
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.results import machine, write_result
from experiments.lab.photodiode import LIT_RGB, Photodiode
from experiments.responses import load_responses
from tests.drawn_set import draw_set
from tests.lab.driver import Display, LabProcess, Sitting, open_display, start
from tests.lab.x11 import watch_pixel

WINDOW_PX = (1280, 800)
FRAME_S = 1 / 60
SQUARE = Photodiode("top-left", 40)
WHITE = LIT_RGB[0] << 16 | LIT_RGB[1] << 8 | LIT_RGB[2]
_POLL_S = 0.0005


def main() -> None:
    """Run a sitting and write what was measured."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=2, help="images of each kind and level")
    parser.add_argument("--output", type=Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary, open_display(*WINDOW_PX) as display:
        result = measure(display, Path(temporary), arguments.repeats)
    write_result({"machine": machine(), **result}, arguments.output)


def measure(display: Display, folder: Path, repeats: int) -> dict[str, Any]:
    """Take a sitting on a display while its square is watched."""
    (folder / "set").mkdir()
    stimuli = draw_set(folder / "set", replicates=repeats)
    triggers = folder / "triggers.toml"
    codes = folder / "codes.csv"
    triggers.write_text(
        f'[port]\nkind = "file"\naddress = "{codes}"\nreset = false\n[[onset]]\ncode = 1\n',
        encoding="utf-8",
    )
    sitting = Sitting(
        "lights-synthetic",
        stimuli.folder,
        folder / "rows.sqlite",
        folder / "psychopy",
        settings={"photodiode": vars(SQUARE)},
        triggers=triggers,
        observed=folder / "frames.jsonl",
    )
    ended = threading.Event()
    seen: list[tuple[float, int]] = []
    middle_px = SQUARE.size_px // 2

    def watch() -> None:
        seen.extend(watch_pixel(display.name, middle_px, middle_px, ended.is_set, _POLL_S))

    watcher = threading.Thread(target=watch)
    with start(display, sitting) as lab:
        take(display, lab, watcher)
        ended.set()
        watcher.join()
    rows = load_responses(sitting.store)
    lines = [json.loads(line) for line in (folder / "frames.jsonl").read_text().splitlines()]
    clocks_s = float(np.median([line[3] - line[0] for line in lines]))
    shown_s = np.array([time_s - clocks_s for time_s, colour in seen if colour == WHITE])
    sent_s = np.loadtxt(codes, delimiter=",", skiprows=1)[:, 0]
    measured_s = rows["onset_measured_s"].to_numpy()
    late = (measured_s - rows["onset_requested_s"].to_numpy()) / FRAME_S
    return {
        "trials": len(rows),
        "share_within_half_a_frame_of_the_request": float(np.mean(np.abs(late) <= 0.5)),
        "share_within_one_frame_of_the_request": float(np.mean(np.abs(late) <= 1)),
        "onset_minus_request_frames": quantiles(late),
        "late_frames_a_trial": float(rows["dropped_frames"].mean()),
        "trigger_minus_onset_ms": quantiles(1000 * (sent_s - measured_s)),
        "seen_by_another_client_minus_onset_ms": quantiles(1000 * (shown_s - measured_s)),
    }


def take(display: Display, lab: LabProcess, watcher: threading.Thread) -> None:
    """Answer every trial, and watch from the first one on."""
    while (page := lab.next_page()) != "completed":
        if page == "instructions":
            watcher.start()
        display.press("1" if page.startswith("trial") else "Return")


def quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    """Return median, 95th percentile and the largest value."""
    low, high = np.percentile(values, (50, 95))
    return {"median": float(low), "p95": float(high), "largest": float(values.max())}


if __name__ == "__main__":
    main()
