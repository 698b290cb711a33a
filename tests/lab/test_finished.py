"""A whole study in a real PsychoPy window, answered by real X11 input, looked at from all sides."""

import pickle
from collections.abc import Mapping

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from PIL import Image

from experiments.answers import Measurement, make_response
from experiments.lab.pictures import OUTLINE_RGB
from experiments.lab.window import BACKGROUND_RGB
from experiments.planning.trials import Trial
from experiments.regions import outline
from experiments.responses import DEVICE_COLUMNS, TIMING_COLUMNS, load_responses, responses_frame
from experiments.storage.store import Store
from experiments.study import Study
from stimuli.manifest import StimulusSet
from tests.lab.conftest import Finished
from tests.lab.driver import DEMOGRAPHICS, Display, image_area, start

pytestmark = [pytest.mark.lab, pytest.mark.slow]

UNMEASURED = Measurement(None, None, None, None, None, "none")


def test_pages_follow_each_other_as_the_study_says(finished: Finished) -> None:
    assert finished.pages == [
        "consent",
        "instructions",
        *("trial 0", "feedback 0", "trial 1", "feedback 1", "trial 2", "feedback 2"),
        "main",
        *("trial 3", "trial 4", "trial 5", "trial 6"),
        "thanks",
        "completed",
    ]


def test_rows_are_those_of_any_runner_with_the_same_answers(
    finished: Finished, study: Study, few: StimulusSet, answers: Mapping[int, int]
) -> None:
    """Against rows made without a window: equal in every column but time, device and runner."""
    with Store.open(finished.sitting.store, must_exist=True) as store:
        (session,) = store.sessions()
    made = [
        make_response(study, few, session, index, answer, UNMEASURED)
        for index, answer in answers.items()
    ]
    left_out = [*TIMING_COLUMNS, *DEVICE_COLUMNS]
    rows = load_responses(finished.sitting.store)
    pd.testing.assert_frame_equal(
        rows.drop(columns=left_out), responses_frame(made).drop(columns=left_out)
    )
    assert rows["input"].tolist() == [*("mouse", "keyboard") * 3, "mouse"]


def test_session_says_who_took_part_on_what(finished: Finished) -> None:
    with Store.open(finished.sitting.store, must_exist=True) as store:
        (session,) = store.sessions()
        assert [event.kind for event in store.events()] == ["triggers"]
    assert session.runner == "lab"
    assert session.demographics == DEMOGRAPHICS
    assert session.completion_code is not None
    assert session.device.startswith("PsychoPy 20")
    assert session.screen["refresh_hz"] is None  # Xvfb, however fast it seems to be
    assert (session.screen["window_width_px"], session.screen["window_height_px"]) == (1280, 800)


def test_times_lie_on_one_clock(finished: Finished) -> None:
    """Property: blank, onset, answer and the next blank follow each other in every row."""
    rows = load_responses(finished.sitting.store)
    assert (rows["reaction_time_s"] > 0).all()
    assert (rows["frame_interval_s"] > 0).all()
    assert (rows["dropped_frames"] >= 0).all()
    onset_s, requested_s = rows["onset_measured_s"], rows["onset_requested_s"]
    # The frame nearest to the moment asked for, so at most half a frame early.
    assert (onset_s > requested_s - 0.51 / 60).all()
    answered_s = (onset_s + rows["reaction_time_s"]).to_numpy()
    blank_s = 0.5
    assert (requested_s.to_numpy()[1:] - blank_s > answered_s[:-1]).all()


def test_images_are_shown_as_they_are_stored(
    finished: Finished, trials: tuple[Trial, ...], few: StimulusSet, regions: NDArray[np.uint8]
) -> None:
    """Against the files: no gamma, no interpolation; only the numerals lie over the background."""
    for trial in trials:
        look = finished.looks[f"trial {trial.index}"]
        area = image_area(look)
        shown = look[area.top_px :, area.left_px :][: area.height_px, : area.width_px]
        stored = np.array(Image.open(few.path(few[trial.stimuli[0]].file)))
        np.testing.assert_array_equal(shown[regions > 0], stored[regions > 0])
        same = (shown == stored).all(axis=2)
        assert np.mean(same) > 0.98
        assert tuple(look[area.top_px - 1, area.left_px]) == BACKGROUND_RGB


def test_feedback_outlines_the_right_object_and_trials_outline_none(
    finished: Finished, trials: tuple[Trial, ...], few: StimulusSet, regions: NDArray[np.uint8]
) -> None:
    """Against the manifest's answer: the pixels of the outline's colour are those around it."""
    for trial in trials:
        look = finished.looks[f"trial {trial.index}"]
        assert not (look == OUTLINE_RGB).all(axis=2).any()
        if trial.feedback:
            answer = few[trial.stimuli[0]].answer
            assert isinstance(answer, int)
            area = image_area(look)
            after = finished.looks[f"feedback {trial.index}"]
            after = after[area.top_px :, area.left_px :][: area.height_px, : area.width_px]
            np.testing.assert_array_equal(
                (after == OUTLINE_RGB).all(axis=2), outline(regions, answer, 2)
            )


def test_psychopys_own_files_hold_the_same_answers(
    finished: Finished, answers: Mapping[int, int]
) -> None:
    folder = finished.sitting.folder
    names = sorted(path.name for path in folder.iterdir())
    assert names == ["lights-synthetic.P0001.1.csv", "lights-synthetic.P0001.1.psydat"]
    table = pd.read_csv(folder / names[0], encoding="utf-8-sig")
    assert dict(zip(table["trial_index"], table["answer"], strict=True)) == answers
    rows = load_responses(finished.sitting.store)
    assert table["id"].tolist() == rows["id"].tolist()
    assert table["stimuli"].tolist() == [" ".join(shown) for shown in rows["stimuli"]]


def test_psychopys_data_file_opens_without_psychopy_or_display(
    finished: Finished, answers: Mapping[int, int]
) -> None:
    """The class is replaced by one that keeps its attributes: importing PsychoPy is not tested."""

    class Handler:
        entries: list[dict[str, object]]

    class Reader(pickle.Unpickler):
        def find_class(self, module: str, name: str) -> object:
            is_handler = module.startswith("psychopy") and name == "ExperimentHandler"
            return Handler if is_handler else super().find_class(module, name)

    with (finished.sitting.folder / "lights-synthetic.P0001.1.psydat").open("rb") as file:
        entries = Reader(file).load().entries
    assert {entry["trial_index"]: entry["answer"] for entry in entries} == answers


def test_a_participant_who_has_finished_is_refused_in_one_line(
    finished: Finished, display: Display
) -> None:
    with start(display, finished.sitting) as lab:
        assert lab.error().splitlines() == [
            "participant: P0001 has already finished lights-synthetic"
        ]
        assert lab.exit_code() == 2
