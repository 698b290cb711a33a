"""The researcher's page in a real Chromium."""

from pathlib import Path

import httpx
import pandas as pd
import pytest

from experiments.storage.participation import exclusion_reasons
from experiments.storage.store import Store
from experiments.web.service import researcher_token
from tests.web.browser import OpenPage
from tests.web.visitor import STUDY, Visitor

pytestmark = pytest.mark.browser


def test_the_researcher_sees_counts_and_saves_the_answers(
    open_page: OpenPage, store: Store, tmp_path: Path
) -> None:
    with open_page() as participant:
        participant.begin()
        participant.answer_by_key(0, 2)
        participant.read_feedback()
        page = participant.page
        base, _, _ = participant.address.partition("/s/")
        with httpx.Client(base_url=base) as client:
            robot = Visitor(client).begin(simulated=True)
            robot.answer(0)
            page.goto(f"{base}/researcher/{STUDY}/#{researcher_token(store)}")
            page.locator("tbody tr").nth(1).wait_for()
            rows = [row.inner_text().split("\t") for row in page.locator("tbody tr").all()]
            assert [(row[0], row[1]) for row in rows] == [
                ("P0002", "SIMULATED"),
                ("P0001", "person"),
            ]
            robot.answer(1)
            page.locator("tbody tr").first.get_by_text("2 / 9").wait_for()  # without a reload
        with page.expect_download() as download:
            page.get_by_role("button", name="Download").click()
        download.value.save_as(tmp_path / "answers.csv")
        table = pd.read_csv(tmp_path / "answers.csv")
        assert list(table["trial_index"]) == [0, 0, 1]
        assert list(table["simulated"]) == [False, True, True]
        assert researcher_token(store) not in download.value.url


def test_the_researcher_excludes_with_a_reason_and_withdraws_after_asking(
    open_page: OpenPage, store: Store
) -> None:
    with open_page() as participant:
        page = participant.page
        base, _, _ = participant.address.partition("/s/")
        with httpx.Client(base_url=base) as client:
            for index in range(3):
                Visitor(client).begin().answer(index, dropped_frames=index)
        page.goto(f"{base}/researcher/{STUDY}/#{researcher_token(store)}")
        page.once("dialog", lambda dialog: dialog.accept("spoke on the phone"))
        page.get_by_role("button", name="Exclude P0001").click()
        page.locator("tbody tr").nth(2).get_by_text("excluded").wait_for()
        page.once("dialog", lambda dialog: dialog.dismiss())
        page.get_by_role("button", name="Withdraw P0002").click()
        page.once("dialog", lambda dialog: dialog.accept())
        page.get_by_role("button", name="Withdraw P0003").click()
        page.locator("tbody tr").nth(0).get_by_text("withdrew").wait_for()
        with page.expect_download() as download:
            page.get_by_role("button", name="Answers (Parquet)").click()
        assert download.value.suggested_filename == f"{STUDY}-responses.parquet"
    assert exclusion_reasons(store.events()) == {f"{STUDY}.P0001.1": "spoke on the phone"}
    assert [row.participant for row in store.responses()] == ["P0001", "P0002"]


@pytest.mark.parametrize("fragment", ["", "#wrong"])
def test_a_wrong_token_is_told_clearly(open_page: OpenPage, fragment: str) -> None:
    with open_page() as participant:
        base, _, _ = participant.address.partition("/s/")
        participant.page.goto(f"{base}/researcher/{STUDY}/{fragment}")
        participant.page.get_by_text("missing or wrong").wait_for()
        assert participant.page.locator("table").count() == 0
