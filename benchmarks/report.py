"""Time and memory of the whole report of a study with 100,000 answers, as JSON.

    python -m benchmarks.report [--tasks odd-one-out two-alternative ranking yes-no]
        [--answers 100000] [--output FILE]

Simulated participants answer into a store; then `trompe analyse` runs on it as a user runs it, in
a process of its own, whose time from start to exit and whose peak memory are given.
"""

import argparse
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.results import machine, write_result
from experiments.planning.trials import Assignment, planned_trials
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer, simulate_responses
from experiments.simulated.simulation import simulate_in_process
from experiments.storage.store import Store
from experiments.study import Study, Task, load_study
from stimuli.manifest import StimulusSet
from tests.analysis.answers import fill_store
from tests.comparison_studies import comparison_study
from tests.drawn_set import LEVELS_DEG, draw_set

SEED = 2011
QUALITIES = {"front": 0.0, "back": 1.0, "front-back": -0.4, "left": 0.3, "right": 0.3, "far": -1.0}
# What the set holds and how often it is shown: about a hundred trials for everyone.
LEVELS: dict[Task, tuple[int, ...]] = {
    "odd-one-out": LEVELS_DEG,
    "two-alternative": (10, 30, 50),
    "ranking": LEVELS_DEG,
    "yes-no": LEVELS_DEG,
}
REPEATS: dict[Task, int] = {"odd-one-out": 2, "two-alternative": 1, "ranking": 5, "yes-no": 1}


def prepare(task: Task, folder: Path) -> tuple[Study, StimulusSet]:
    """Return a study of a task, and a set for it."""
    study = load_study("lights-synthetic")
    if task == "odd-one-out":
        stimuli = draw_set(folder, LEVELS[task])
        design = study.design.model_copy(update={"repeats": REPEATS[task]})
        return study.model_copy(update={"design": design}), stimuli
    stimuli = draw_set(folder, LEVELS[task], tuple(QUALITIES))
    return comparison_study(study, task, repeats=REPEATS[task]), stimuli


def collect(study: Study, stimuli: StimulusSet, path: Path, answers: int) -> dict[str, int]:
    """Let simulated participants answer into a store."""
    trials = len(planned_trials(study, stimuli, Assignment(1)))
    participants = -(-answers // trials)
    generator = np.random.default_rng(SEED)
    with Store.open(path) as store:
        if study.task == "odd-one-out":
            observer = Observer(threshold=25, width=30)
            rows = simulate_responses(study, stimuli, observer, participants, generator)
            fill_store(store, study, stimuli, rows)
        else:
            judge = ItemObserver(QUALITIES, spread=0.5)
            simulate_in_process(study, stimuli, store, judge, participants, generator)
    return {"participants": participants, "answers": participants * trials}


def analyse(path: Path, folder: Path) -> dict[str, float]:
    """Run the command on a store; return its seconds and its peak memory in GB."""
    command = [sys.executable, "-m", "trompe", "analyse", str(path), "--out", str(folder)]
    started = time.perf_counter()
    silent = (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)
    process = os.posix_spawn(sys.executable, command, os.environ, file_actions=[silent])
    _, status, usage = os.wait4(process, 0)
    seconds = time.perf_counter() - started
    if status != 0:
        raise SystemExit(f"trompe analyse ended with status {status}")
    return {"seconds": seconds, "peak_gb": usage.ru_maxrss / 1e6}  # Linux counts in kB


def measure(task: Task, answers: int) -> dict[str, Any]:
    """Return how large a study of a task was, and what its report took."""
    memory = Path("/dev/shm")  # where each answer need not wait for a disk
    with tempfile.TemporaryDirectory(dir=memory if memory.is_dir() else None) as name:
        folder = Path(name)
        (folder / "set").mkdir()
        size = collect(*prepare(task, folder / "set"), folder / "answers.sqlite", answers)
        return {**size, **analyse(folder / "answers.sqlite", folder / "report")}


def main() -> None:
    """Read the arguments, run, and write the result as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--tasks", nargs="+", choices=LEVELS, default=list(LEVELS))
    parser.add_argument("--answers", type=int, default=100_000)
    parser.add_argument("--output", type=Path)
    given = parser.parse_args()
    result: dict[str, Any] = {"machine": machine(), "seed": SEED}
    for task in given.tasks:
        result[task] = measure(task, given.answers)
    write_result(result, given.output)


if __name__ == "__main__":
    main()
