"""Time, memory and noise of every stimulus set, as JSON.

    python -m benchmarks.stimulus_sets [--full] [--keep DIR] [--photographs DIR] [SET ...]

Without --full the quick sets are made. The limits are those of the project on two processor cores:
every full set in 30 minutes, all quick sets together in 4; noise of at most 1/255 RMS in encoded
values as displayed, 2/255 where Mitsuba's `volpath` renders. `photographs` needs a folder.
"""

import argparse
import resource
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.results import machine, write_result
from stimuli.sets import SUMMARIES, maker

SEED = 2010
LIMITS = {"full_set_seconds": 1800.0, "all_quick_sets_seconds": 240.0, "noise_rms_of_255": 1.0}


def make_one(name: str, folder: Path, quick: bool, photographs: Path | None) -> dict[str, Any]:
    """Make a set, and say what it took; call it in a process of its own."""
    options = {"photographs": photographs} if name == "photographs" else {}
    started = time.perf_counter()
    made = maker(name, options)(
        folder, seed=SEED, quick=quick, engine=None, progress=lambda _done, _total: None
    )
    seconds = time.perf_counter() - started
    noise = [
        stimulus.details["noise_rms_of_255"]
        for stimulus in made.stimuli
        if "noise_rms_of_255" in stimulus.details
    ]
    return {
        "images": len(made.stimuli),
        "seconds": seconds,
        "gigabytes_of_memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e9,
        "megabytes_on_disk": sum((folder / file).stat().st_size for file in made.files) / 1e6,
        "engine": made.engine,
        "noise_rms_of_255": {"median": float(np.median(noise)), "largest": max(noise)}
        if noise
        else "none: every sample is the same in each render",
        "clipped_share": made.details.get("clipped_share"),
    }


def run(
    names: list[str], *, quick: bool, keep: Path | None, photographs: Path | None
) -> dict[str, Any]:
    """Make the sets one after the other, each in a fresh process."""
    sets: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as temporary:
        for name in names:
            folder = (keep or Path(temporary)) / name
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                sets[name] = pool.submit(make_one, name, folder, quick, photographs).result()
    return {
        "machine": machine(),
        "size": "quick" if quick else "full",
        "limits": LIMITS,
        "sets": sets,
        "seconds_together": sum(each["seconds"] for each in sets.values()),
    }


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("sets", nargs="*", metavar="SET", help="all, but for photographs")
    parser.add_argument("--full", action="store_true", help="full instead of quick sets")
    parser.add_argument("--keep", type=Path, help="a folder in which the sets are left")
    parser.add_argument("--photographs", type=Path, help="a folder of photographs to combine")
    parser.add_argument("--output", type=Path, help="a file instead of the terminal")
    given = parser.parse_args()
    made = [name for name in SUMMARIES if name != "photographs" or given.photographs]
    result = run(
        given.sets or made, quick=not given.full, keep=given.keep, photographs=given.photographs
    )
    write_result(result, given.output)


if __name__ == "__main__":
    main()
