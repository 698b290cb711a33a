"""What the lab runner refuses before or while it opens its window, each in one line."""

import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from algorithms.errors import InputError, UnavailableError
from experiments.lab.arrival import unfinished_session
from experiments.lab.eye_tracker import read_tracker
from experiments.lab.opening import open_window
from experiments.lab.runner import run_lab
from experiments.lab.visual_angle import image_width_px
from experiments.lab.window import WindowSettings
from experiments.storage.store import NewSession, Store
from experiments.study import Study
from experiments.study_parts import Display as ImageSize
from stimuli.manifest import StimulusSet
from tests.comparison_studies import viewing_study
from tests.lab.driver import DEMOGRAPHICS, Display, Sitting, start

BEGUN = NewSession(
    runner="web", device="", demographics={}, screen={}, participant="P7", participant_number=7
)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"participant": "../P1"}, "participant: '../P1' given"),
        ({"participant": ""}, "participant: '' given"),
        ({"participant": "P7"}, "participant: P7 has begun lights-synthetic with another runner"),
        ({"participant": "P8", "participant_number": 7}, "participant_number: 7 given"),
        ({"participant_number": 0}, "participant_number: 0 given"),
        ({"demographics": {}}, "demographics.age: missing"),
        ({"demographics": DEMOGRAPHICS | {"age": -1}}, "demographics.age: -1 given"),
    ],
)
def test_wrong_arguments_are_refused_before_a_window_opens(
    study: Study,
    few: StimulusSet,
    store: Store,
    tmp_path: Path,
    arguments: Mapping[str, Any],
    message: str,
) -> None:
    store.register(study, few)
    store.begin_session(study, few, BEGUN)
    given: dict[str, Any] = {"demographics": DEMOGRAPHICS, "folder": tmp_path} | dict(arguments)
    with pytest.raises(InputError) as caught:
        run_lab(study, few, store, **given)
    assert str(caught.value).startswith(message)
    assert len(store.sessions()) == 1


def test_a_session_does_not_go_on_with_other_stimuli(
    study: Study, few: StimulusSet, drawn_set: StimulusSet, store: Store
) -> None:
    store.register(study, few)
    store.begin_session(study, few, replace(BEGUN, runner="lab"))
    session = unfinished_session(study, few, store, "P7")
    assert session is not None
    assert session.participant_number == 7
    with pytest.raises(InputError, match="another version of the study or its stimuli"):
        unfinished_session(study, drawn_set, store, "P7")


@pytest.mark.parametrize("settings", [{"size_px": (0, 300)}, {"screen": -1}])
def test_impossible_windows_are_refused(settings: Mapping[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(settings))):
        WindowSettings(**settings)


def test_a_missing_psychopy_is_named_with_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setitem(sys.modules, "psychopy", None)
    with (
        pytest.raises(UnavailableError, match="pip install psychopy"),
        open_window(WindowSettings(), lambda _page: None),
    ):
        pass


@pytest.mark.lab
def test_a_missing_display_is_one_line(sitting: Sitting) -> None:
    with start(None, sitting) as lab:
        assert lab.exit_code() == 2
        (line,) = lab.error().splitlines()
    assert "DISPLAY is not set" in line
    assert "xvfb-run" in line


@pytest.mark.lab
@pytest.mark.slow
def test_a_display_that_does_not_answer_is_one_line(sitting: Sitting) -> None:
    with start(Display(":4999"), sitting) as lab:
        assert lab.exit_code() == 2
        (line,) = lab.error().splitlines()
    assert line.startswith("the lab runner needs a display with OpenGL")


def test_degrees_need_the_monitors_size_and_distance() -> None:
    """Theory: 90 degrees at 60 cm are 120 cm."""
    degrees = ImageSize(width_deg=90)
    assert image_width_px(degrees, pixels_per_cm=10, distance_cm=60) == 1200
    assert image_width_px(ImageSize(width_px=7), None, None) == 7
    assert image_width_px(ImageSize(), 10, 60) is None
    for known in ((None, 60), (10, None)):
        with pytest.raises(InputError, match=r"^display\.width_deg: needs .* --monitor"):
            image_width_px(degrees, *known)


@pytest.mark.lab
@pytest.mark.slow
def test_windows_that_cannot_be_are_refused(
    display: Display, sitting: Sitting, write_study: Callable[[str, str], Path], tmp_path: Path
) -> None:
    wide = write_study("[screen]", "[display]\nwidth_px = 1500\n\n[screen]")
    refused: dict[str, dict[str, Any]] = {
        "monitor: 'no-such' is not in PsychoPy's Monitor Center": {"monitor": "no-such"},
        "screen: 5 given, 0 to 0 accepted": {"screen": 5},
        "screen: the window is 500 x 300 pixels, lights-synthetic needs 640 x 400": {
            "fullscreen": False,
            "size_px": (500, 300),
        },
    }
    sittings = [replace(sitting, settings=settings) for settings in refused.values()]
    sittings.append(replace(sitting, study=wide, store=tmp_path / "wide.sqlite"))
    refused["display: images 1500 pixels wide do not fit into the window, at most 1208 pixels"] = {}
    with start(display, *sittings) as lab:
        assert lab.exit_code() == 2
        lines = lab.error().splitlines()
    told = [line for line in lines if not line.startswith("Xlib:")]  # the X client's own remarks
    for line, expected in zip(told, refused, strict=True):
        assert line.startswith(expected)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("[tracker", "not a TOML file"),
        ("", "nothing given, one table"),
        ("[mouse]", "mouse given, one table"),
        ('["eyetracker.hw.mouse.EyeTracker"]\n["eyetracker.hw.tobii.EyeTracker"]', "given, one"),
    ],
)
def test_files_that_name_no_eye_tracker_are_refused(
    tmp_path: Path, text: str, message: str
) -> None:
    path = tmp_path / "tracker.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=message):
        read_tracker(path)


def test_free_viewing_wants_an_eye_tracker(
    study: Study, few: StimulusSet, store: Store, tmp_path: Path
) -> None:
    viewing = viewing_study(study, 1.0)
    with pytest.raises(InputError, match=r"eye_tracker: none given; free-viewing records gaze"):
        run_lab(viewing, few, store, demographics=DEMOGRAPHICS, folder=tmp_path)
    assert store.sessions() == []
