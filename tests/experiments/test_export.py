"""Tables that leave the store: complete, described, harmless, and without what nobody declared."""

import csv
import io
import json
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet  # type: ignore[import-untyped]
from typer.testing import CliRunner

from experiments.answers import Measurement, make_response
from experiments.cli import app
from experiments.exports.collection import load_collection
from experiments.exports.data_dictionary import COLUMNS, described
from experiments.exports.export import safe_cell, table_bytes
from experiments.exports.psych_ds import wide_table, write_psych_ds
from experiments.responses import Event, Response, Session
from experiments.storage.participation import exclude_session
from experiments.storage.store import NewSession, Store
from experiments.study import Study
from stimuli.manifest import StimulusSet

MEASURED = Measurement(2.31, 10.01, 10.02, 0.02, 0, "mouse")
FORMULA = '=HYPERLINK("http://example.org")'
STARTS = ("=", "+", "-", "@", "\t", "\r", "\uff1d", "\uff0b", "\uff0d", "\uff20")


@pytest.fixture
def data(study: Study, drawn_set: StimulusSet, tmp_path: Path) -> Path:
    """A store with two sessions, one of them of someone whose code is a name, and excluded."""
    path = tmp_path / "answers.sqlite"
    with Store.open(path) as store:
        store.register(study, drawn_set)
        for participant, pilot in ((None, True), ("anna", False)):
            said = {"age": 30, "gender": "female", "artistic_background": True}
            new = NewSession("lab", FORMULA, said, {"width_px": 1920}, False, pilot, participant)
            session, _ = store.begin_session(study, drawn_set, new)
            for index in range(5):
                store.record(make_response(study, drawn_set, session, index, 3, MEASURED))
            store.add_event(session.id, "resize", {"width_px": 1280})
        exclude_session(store, session.id, FORMULA)
        store.complete(session.id)
    return path


def rows_of(content: bytes) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(content.decode())))


def test_every_column_of_every_row_is_described() -> None:
    for table, kind in (("responses", Response), ("sessions", Session), ("events", Event)):
        nested = {"demographics", "screen"}
        assert {field.name for field in fields(kind)} - nested <= set(COLUMNS[table])


@pytest.mark.parametrize("table", ["responses", "sessions", "events"])
def test_csv_and_parquet_hold_the_same_rows_and_the_pilot_flag(data: Path, table: str) -> None:
    with Store.open(data) as store:
        flat = rows_of(table_bytes(store, table, form="csv"))  # type: ignore[arg-type]
        typed = parquet.read_table(io.BytesIO(table_bytes(store, table, form="parquet")))  # type: ignore[arg-type]
    assert typed.column_names == list(flat[0])
    assert [row["pilot"] for row in flat] == [str(flag) for flag in typed["pilot"].to_pylist()]
    assert {"True", "False"} == {row["pilot"] for row in flat}
    texts = [name for name in flat[0] if str(typed.schema.field(name).type) == "string"]
    for name in texts:
        given = [row[name] for row in flat]
        assert given == [safe_cell(text) or "" for text in typed[name].to_pylist()]
    assert all(typed.schema.field(name).metadata[b"description"] for name in flat[0])
    assert [column.name for column in described(table, flat[0])] == list(flat[0])


def test_what_a_participant_said_has_columns_of_its_own(data: Path, study: Study) -> None:
    with Store.open(data) as store:
        rows = rows_of(table_bytes(store, "sessions"))
    said = [name for name in rows[0] if name.startswith("demographics_")]
    assert said == [f"demographics_{field}" for field in study.demographics]
    assert [rows[1][name] for name in said] == ["30", "female", "True"]
    assert rows[1]["screen_width_px"] == "1920"
    assert [row["exclusion_reason"] for row in rows] == ["", f"'{FORMULA}"]


@given(st.text(max_size=40), st.sampled_from(STARTS), st.sampled_from(["", ";", ",", "\n", "a;"]))
def test_no_cell_begins_with_a_formula_in_any_countrys_spreadsheet(
    text: str, start: str, before: str
) -> None:
    # Property; where the end of a cell is a semicolon, a tab or a line end, what follows is safe.
    cell = safe_cell(before + start + text)
    assert isinstance(cell, str)
    for separator in ";,\t\r\n":
        for part in cell.split(separator):
            assert not part.lstrip(' "').startswith(("=", "+", "@", "\uff1d"))


def test_psych_ds_describes_every_column_and_knows_nobody_by_name(
    data: Path, tmp_path: Path, study: Study
) -> None:
    folder = tmp_path / "published"
    command = ["export", str(data), "--format", "psych-ds", "--output", str(folder)]
    told = CliRunner().invoke(app, command, catch_exceptions=False)
    assert told.output == f"wrote {folder / 'dataset_description.json'}\n"
    said = json.loads((folder / "dataset_description.json").read_text())
    assert (said["@type"], said["name"]) == ("Dataset", study.name)
    tables = sorted((folder / "data").iterdir())
    assert [path.name for path in tables] == [
        f"study-lightssynthetic_description-{table}_data.csv" for table in ("responses", "sessions")
    ]
    variables = {variable["name"] for variable in said["variableMeasured"]}
    heads = [set(rows_of(path.read_bytes())[0]) for path in tables]
    assert variables == heads[0] | heads[1]
    assert not {"device", "completion_code"} & variables
    published = b"".join(path.read_bytes() for path in folder.rglob("*") if path.is_file())
    assert b"anna" not in published
    assert [row["participant"] for row in rows_of(tables[1].read_bytes())] == ["P0001", "P0002"]
    sessions = {row["id"] for row in rows_of(tables[1].read_bytes())}
    assert {row["session"] for row in rows_of(tables[0].read_bytes())} == sessions
    with pytest.raises(ValueError, match="holds other files"):
        write_psych_ds(load_collection(data), folder)


def test_the_wide_table_is_as_psychopy_writes_it(
    data: Path, drawn_set: StimulusSet, study: Study
) -> None:
    names, rows = wide_table(load_collection(data))
    # PsychoPy's ExperimentHandler: conditions, then the loop, then routines, then extraInfo.
    for name in ("trials.thisN", "response.rt", "participant", "session", "date", "expName"):
        assert name in names
    assert names.index("divergence_deg") < names.index("trials.thisN") < names.index("participant")
    for row in rows:
        stimulus = drawn_set[row["stimulus"]]
        assert row["divergence_deg"] == stimulus.factors["divergence_deg"]
        right = stimulus.answer
        assert row["response.corr"] == (None if right is None else int(right == 3))
        assert (row["age"], row["frameRate"], row["expName"]) == (30, 50.0, study.name)
    told = CliRunner().invoke(app, ["export", str(data), "--format", "psychopy"])
    assert len(rows_of(told.output.encode())) == len(rows)


def test_a_table_without_rows_has_its_head(tmp_path: Path) -> None:
    with Store.open(tmp_path / "empty.sqlite") as store:
        assert table_bytes(store, "events").decode().splitlines() == [
            "session,kind,detail,recorded_at,simulated,pilot"
        ]
        content = table_bytes(store, "responses", form="parquet")
    assert parquet.read_table(io.BytesIO(content)).num_rows == 0
