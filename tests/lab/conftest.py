"""A display, a short study on it, and one sitting taken to the end for several tests to look at."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.images import read_labels
from experiments.lab.photodiode import Photodiode
from experiments.planning.trials import Assignment, Trial, planned_trials
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.drawn_set import draw_set
from tests.lab.driver import Display, Sitting, open_display, save_monitor, start, take_study

PHOTODIODE = Photodiode("bottom-right", 30)

TRIGGERS = """
[port]
kind = "file"
address = "{address}"

[[onset]]
code = 10
phase = "practice"

[[onset]]
code = 30
trial = 4

[[onset]]
code = 20
factors = {{ divergence_deg = 0 }}

[[onset]]
code = 29

[[answer]]
code = 108
answer = 8

[[answer]]
code = 100
"""


@pytest.fixture(scope="session")
def display() -> Iterator[Display]:
    """A virtual display of 1280 x 800 pixels."""
    with open_display() as opened:
        yield opened


@pytest.fixture(scope="session")
def few(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """Three practice stimuli and four main ones."""
    return draw_set(tmp_path_factory.mktemp("few"), levels_deg=(0, 90), placements=("front",))


@pytest.fixture(scope="session")
def regions(few: StimulusSet) -> NDArray[np.uint8]:
    """The label image of all of them."""
    return read_labels(few.path("regions.png"))


@pytest.fixture(scope="session")
def trials(study: Study, few: StimulusSet) -> tuple[Trial, ...]:
    """The trials of the first participant."""
    return planned_trials(study, few, Assignment(1))


@pytest.fixture(scope="session")
def answers(trials: tuple[Trial, ...], few: StimulusSet) -> dict[int, int]:
    """The first practice answer right, the others by turns."""
    right = few[trials[0].stimuli[0]].answer
    assert isinstance(right, int)
    return {trial.index: (right + trial.index - 1) % 8 + 1 for trial in trials}


def sitting_in(folder: Path, stimuli: StimulusSet) -> Sitting:
    """Return a sitting that leaves everything in a folder."""
    return Sitting("lights-synthetic", stimuli.folder, folder / "rows.sqlite", folder / "psychopy")


@pytest.fixture
def sitting(few: StimulusSet, tmp_path: Path) -> Sitting:
    """A sitting of its own for each test."""
    return sitting_in(tmp_path, few)


@pytest.fixture(scope="session")
def monitors(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A home directory whose Monitor Center knows the monitor `lab`: 53 cm, 60 cm, gamma 2.2."""
    home = tmp_path_factory.mktemp("home")
    save_monitor(home)
    return home


@dataclass(frozen=True)
class Finished:
    """A sitting taken to the end: its pages in order, and how each of them looked."""

    sitting: Sitting
    pages: list[str]
    looks: Mapping[str, NDArray[np.uint8]]


@pytest.fixture(scope="session")
def finished(
    display: Display,
    few: StimulusSet,
    regions: NDArray[np.uint8],
    answers: Mapping[int, int],
    tmp_path_factory: pytest.TempPathFactory,
) -> Finished:
    """The first participant's sitting in full screen, with a photodiode and triggers."""
    folder = tmp_path_factory.mktemp("finished")
    triggers = folder / "triggers.toml"
    triggers.write_text(TRIGGERS.format(address=folder / "codes.csv"), encoding="utf-8")
    sitting = replace(
        sitting_in(folder, few),
        settings={"photodiode": vars(PHOTODIODE)},
        triggers=triggers,
        observed=folder / "frames.jsonl",
    )
    looks: dict[str, NDArray[np.uint8]] = {}

    def look(page: str) -> None:
        looks[page] = display.screenshot()

    with start(display, sitting) as lab:
        pages = take_study(display, lab, regions, answers, look)
    return Finished(sitting, pages, looks)
