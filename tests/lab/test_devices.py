"""What recording devices are given: a square for a photodiode, and trigger codes."""

import json
import os
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pandas as pd
import pytest

from algorithms.errors import InputError, UserError
from experiments.lab.photodiode import DARK_RGB, LIT_RGB, Photodiode
from experiments.lab.ports import PortSettings, open_port
from experiments.lab.triggers import TriggerPlan, check_triggers, load_triggers
from experiments.lab.window import BACKGROUND_RGB
from experiments.planning.trials import Trial
from experiments.responses import load_responses
from stimuli.manifest import StimulusSet
from tests.lab.conftest import PHOTODIODE, Finished

LIT, DARK, EMPTY = list(LIT_RGB), list(DARK_RGB), list(BACKGROUND_RGB)


@pytest.fixture(scope="module")
def frames(finished: Finished) -> list[tuple[float, list[int], list[int]]]:
    """Time, the square's colour and that in the middle of the window, read back frame by frame."""
    assert finished.sitting.observed is not None
    lines = finished.sitting.observed.read_text("ascii").splitlines()
    return [tuple(json.loads(line)[:3]) for line in lines]


@pytest.fixture(scope="module")
def codes(finished: Finished) -> pd.DataFrame:
    """The codes sent, with their times."""
    return pd.read_csv(finished.sitting.folder.parent / "codes.csv")


@pytest.mark.lab
@pytest.mark.slow
def test_the_square_turns_white_in_the_first_frame_with_the_stimulus(
    finished: Finished, frames: list[tuple[float, list[int], list[int]]]
) -> None:
    """Read back from the window: it is white in that frame, black in the one before and after."""
    assert {tuple(square) for _, square, _ in frames} == {LIT_RGB, DARK_RGB}
    onsets = [
        (before, first)
        for before, first in pairwise(frames)
        if (before[1], first[1]) == (DARK, LIT)
    ]
    rows = load_responses(finished.sitting.store)
    assert len(onsets) == len(rows)
    for (before, first), measured_s in zip(onsets, rows["onset_measured_s"], strict=True):
        assert before[2] == EMPTY
        assert first[2] != EMPTY
        assert first[0] < measured_s
    ends_s = [now[0] for now, after in pairwise(frames) if (now[1], after[1]) == (LIT, DARK)]
    answered_s = rows["onset_measured_s"] + rows["reaction_time_s"]
    assert len(ends_s) == len(rows)
    np.testing.assert_array_less(ends_s, answered_s)


@pytest.mark.lab
@pytest.mark.slow
def test_the_square_lies_in_its_corner_and_nowhere_else(finished: Finished) -> None:
    looks = finished.looks
    area = PHOTODIODE.area(1280, 800)
    rows, columns = np.nonzero((looks["trial 3"] == LIT_RGB).all(axis=2))
    assert (columns.min(), columns.max() + 1) == (area.left_px, 1280)
    assert (rows.min(), rows.max() + 1) == (area.top_px, 800)
    assert rows.size == area.width_px * area.height_px
    for page in ("consent", "feedback 0", "thanks"):
        assert (looks[page][area.top_px :, area.left_px :] == DARK_RGB).all()


@pytest.mark.lab
@pytest.mark.slow
def test_codes_are_those_of_the_rules_in_the_flip_of_the_onset_and_at_the_answer(
    finished: Finished,
    frames: list[tuple[float, list[int], list[int]]],
    codes: pd.DataFrame,
    trials: tuple[Trial, ...],
    few: StimulusSet,
) -> None:
    """Each is followed by 0; an onset's comes before the next frame is even drawn."""
    rows = load_responses(finished.sitting.store)
    expected = []
    for trial, answer in zip(trials, rows["answer"], strict=True):
        level = few[trial.stimuli[0]].factors["divergence_deg"]
        onset = 10 if trial.phase == "practice" else 20 if level == 0 else 29
        expected += [30 if trial.index == 4 else onset, 0, 108 if answer == 8 else 100, 0]
    assert codes["code"].tolist() == expected
    times_s = codes["time_s"].to_numpy()
    onset_s = rows["onset_measured_s"].to_numpy()
    shown_s = np.array([frame[0] for frame in frames])
    next_s = shown_s[np.searchsorted(shown_s, onset_s)]
    assert (times_s[0::4] >= onset_s - 1e-6).all()
    assert (times_s[0::4] < next_s).all()
    answered_s = onset_s + rows["reaction_time_s"].to_numpy()
    assert (times_s[2::4] >= answered_s - 1e-6).all()
    assert (times_s[2::4] < times_s[3::4]).all()


def test_a_serial_port_gets_each_code_as_a_byte() -> None:
    """Against a real serial line of the system: a pseudo-terminal's other end."""
    ours, theirs = os.openpty()
    try:
        settings = PortSettings(kind="serial", address=os.ttyname(theirs), baud_rate=9600)
        with open_port(settings, lambda: 0.0) as port:
            for code in (1, 0, 255):
                port.send(code)
            received = [os.read(ours, 1) for _ in range(3)]
        assert received == [b"\x01", b"\x00", b"\xff"]
    finally:
        os.close(theirs)
        os.close(ours)


@pytest.mark.parametrize(
    ("kind", "address"),
    [("serial", "/dev/no-such"), ("parallel", "/dev/no-such"), ("file", "/no-such/codes.csv")],
)
def test_a_port_that_is_not_there_is_one_line(
    kind: Literal["serial", "parallel", "file"], address: str
) -> None:
    with (
        pytest.raises(UserError, match=rf"^port.address: {address}") as caught,
        open_port(PortSettings(kind=kind, address=address), lambda: 0.0),
    ):
        pass
    assert "\n" not in str(caught.value)


PORT = '[port]\nkind = "file"\naddress = "codes.csv"\n'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "port: missing"),
        (PORT.replace("file", "usb"), "port.kind: "),
        (PORT + "baud_rate = 9600", "port: baud_rate: a file port has no use for it"),
        (PORT + "[[onset]]\ncode = 0", "onset.0.code: "),
        (PORT + "[[onset]]\ncode = 256", "onset.0.code: "),
        (PORT + "[[onset]]\ncode = 1\nanswer = 2", "onset.0.answer: unknown key"),
        (PORT + '[[answer]]\ncode = 1\nanswer = "late"', "answer.0.answer"),
    ],
)
def test_wrong_trigger_files_are_refused_with_the_key(
    tmp_path: Path, text: str, message: str
) -> None:
    path = tmp_path / "triggers.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_triggers(path)
    assert str(caught.value).startswith(f"{path}: {message}")


@pytest.mark.parametrize(
    ("factors", "message"),
    [
        ({"divergence_deg": 33}, r"^triggers: onset\.factors\.divergence_deg: 33 given, .* 0, 90"),
        ({"colour": 1}, r"^triggers: onset\.factors\.colour: 1 given, the set has no such factor"),
    ],
)
def test_rules_name_levels_that_the_set_has(
    few: StimulusSet, factors: dict[str, Any], message: str
) -> None:
    port = {"kind": "file", "address": "codes.csv"}
    plan = TriggerPlan.model_validate({"port": port, "onset": [{"code": 1, "factors": factors}]})
    with pytest.raises(InputError, match=message):
        check_triggers(plan, few)


@pytest.mark.parametrize(("corner", "size_px"), [("middle", 40), ("top-left", 0)])
def test_impossible_squares_are_refused(corner: str, size_px: int) -> None:
    with pytest.raises(InputError, match=r"^photodiode"):
        Photodiode(corner, size_px)
