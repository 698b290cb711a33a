"""The same trials with the same answers, in the lab's window and in a browser."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path

import pandas as pd
import pytest

from experiments import load_responses
from experiments.responses import DEVICE_COLUMNS, TIMING_COLUMNS, Response
from experiments.storage.store import Store
from experiments.study import Study
from experiments.web import create_app, running_server
from experiments.web.pages import BUNDLE
from stimuli.manifest import StimulusSet
from tests.conftest import require
from tests.lab.conftest import Finished
from tests.web.browser import DESKTOP, Participant, open_chromium

pytestmark = [pytest.mark.lab, pytest.mark.browser]


@pytest.fixture
def web_rows(
    chromium: str, study: Study, few: StimulusSet, answers: Mapping[int, int], tmp_path: Path
) -> pd.DataFrame:
    """What the browser leaves when the first participant gives the lab's answers."""
    require((BUNDLE / "index.html").is_file(), "needs the built front end (pip install -e .)")
    data = tmp_path / "web.sqlite"
    with (
        Store.open(data) as store,
        running_server(create_app(study, few, store)) as url,
        open_chromium(chromium) as browser,
    ):
        participant = Participant(browser.new_context(**DESKTOP), f"{url}/s/{study.name}/")
        participant.begin()
        for index, answer in sorted(answers.items()):
            participant.wait_for_picture()
            if index % 2:
                participant.answer_by_key(index, answer)
            else:
                participant.answer_by_mouse(index, answer, participant.point_of(few, answer))
            if index < study.practice.trials:
                participant.read_feedback()
        participant.code()
    return load_responses(data)


def test_rows_of_lab_and_web_agree_in_all_but_time_device_and_runner(
    finished: Finished, web_rows: pd.DataFrame, answers: Mapping[int, int]
) -> None:
    lab_rows = load_responses(finished.sitting.store)
    different = [*TIMING_COLUMNS, *DEVICE_COLUMNS]

    assert list(web_rows.columns) == [field.name for field in fields(Response)]
    pd.testing.assert_frame_equal(
        lab_rows.drop(columns=different), web_rows.drop(columns=different)
    )
    assert dict(zip(web_rows.trial_index, web_rows.answer, strict=True)) == answers
    # The ways in are the same ones too; only the machines differ.
    assert list(lab_rows.input) == list(web_rows.input)
    assert set(lab_rows.runner) == {"lab"}
    assert set(web_rows.runner) == {"web"}
