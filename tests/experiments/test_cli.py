"""`trompe study` as it is typed; errors are those that the command line prints as one line."""

import csv
import io
import json
import shutil
import socket
from pathlib import Path

import pytest
from typer.testing import CliRunner

from algorithms.errors import InputError
from experiments.cli import app
from experiments.responses import load_responses
from experiments.study import Study
from stimuli.manifest import StimulusSet

STUDY = "lights-synthetic"


def study_command(*arguments: object) -> str:
    """Run `trompe study ...` and return what it prints."""
    result = CliRunner().invoke(app, [str(part) for part in arguments])
    if result.exception is not None:
        raise result.exception
    return result.output


@pytest.fixture(scope="module")
def simulated(drawn_set: StimulusSet, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store that two simulated participants have filled."""
    data: Path = tmp_path_factory.mktemp("cli") / "responses.sqlite"
    told = study_command(
        *("simulate", STUDY, "--stimuli", drawn_set.folder, "--data", data, "--json"),
        *("--participants", 2, "--threshold", "front=20,back=30,front-back=25"),
        *("--condition", "placement", "--salience", "5=3", "--seed", 4),
    )
    assert json.loads(told) == {"simulated_sessions": 2, "seed": 4}
    return data


def test_new_writes_a_study_that_check_accepts(tmp_path: Path, drawn_set: StimulusSet) -> None:
    study_command("new", "mine", "--folder", tmp_path)
    told = study_command("check", tmp_path / "mine.toml", "--stimuli", drawn_set.folder, "--json")
    facts = json.loads(told)
    assert (facts["study"], facts["practice_trials"]) == ("mine", 3)
    assert facts["main_trials"] == len(drawn_set.with_role("main"))


def test_check_prints_a_line_a_fact(study: Study) -> None:
    lines = study_command("check", STUDY).splitlines()
    assert any(line.split() == ["digest", study.digest] for line in lines)


def test_simulate_fills_the_store_through_the_server(simulated: Path, study: Study) -> None:
    answers = load_responses(simulated, study.name)
    assert answers["simulated"].all()
    assert set(answers["runner"]) == {"web"}
    assert answers["participant"].nunique() == 2
    device = answers["device"].unique().tolist()
    assert len(device) == 1
    assert "threshold front 20, back 30, front-back 25" in device[0]
    assert "seed" in device[0]


def test_export_gives_every_row_in_both_formats(simulated: Path, tmp_path: Path) -> None:
    answers = load_responses(simulated)
    table = list(csv.DictReader(io.StringIO(study_command("export", simulated))))
    records = json.loads(study_command("export", simulated, "--format", "json"))
    assert [row["id"] for row in table] == [row["id"] for row in records] == answers["id"].tolist()
    assert [int(row["answer"]) for row in table] == answers["answer"].tolist()
    study_command("export", simulated, "--table", "sessions", "--output", tmp_path / "s.csv")
    sessions = list(csv.DictReader(io.StringIO((tmp_path / "s.csv").read_text(encoding="utf-8"))))
    assert [row["simulated"] for row in sessions] == ["True", "True"]
    assert study_command("export", simulated, "--table", "events").startswith("session,kind")


def test_export_does_not_overwrite_the_store(simulated: Path) -> None:
    before = simulated.read_bytes()
    with pytest.raises(InputError, match="is the store itself"):
        study_command("export", simulated, "--output", simulated)
    assert simulated.read_bytes() == before


@pytest.mark.parametrize("command", ["serve", "simulate", "run-lab", "check"])
def test_altered_stimuli_are_refused(command: str, drawn_set: StimulusSet, tmp_path: Path) -> None:
    folder = tmp_path / "altered"
    shutil.copytree(drawn_set.folder, folder)
    image = folder / drawn_set.stimuli[7].file
    image.write_bytes(image.read_bytes() + b"\0")
    data = [] if command == "check" else ["--data", tmp_path / "r.sqlite"]
    with pytest.raises(InputError, match=f"{image.name}: altered since the set was made"):
        study_command(command, STUDY, "--stimuli", folder, *data)
    image.unlink()
    with pytest.raises(InputError, match=f"{image.name}: listed in the set's manifest but missing"):
        study_command(command, STUDY, "--stimuli", folder, *data)
    assert not (tmp_path / "r.sqlite").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["simulate", STUDY, "--stimuli", "SET"], "one of --url and --data is needed"),
        (["simulate", STUDY, "--stimuli", "SET", "--url", "x", "--data", "y"], "not both"),
        (
            ["simulate", STUDY, "--stimuli", "SET", "--data", "TMP", "--threshold", "much"],
            "threshold: 'much' given, a number accepted",
        ),
        (
            ["simulate", STUDY, "--stimuli", "SET", "--data", "TMP", "--threshold", "front=20"],
            "condition",
        ),
        (
            ["simulate", STUDY, "--stimuli", "SET", "--data", "TMP", "--salience", "e=3"],
            "salience: 'e' given",
        ),
        (["serve", STUDY, "--stimuli", "none", "--data", "TMP"], "cannot be read"),
        (
            ["serve", STUDY, "--stimuli", "SET", "--data", "none/r.sqlite", "--port", "0"],
            "cannot be used",
        ),
        (["serve", "nothing", "--stimuli", "SET", "--data", "TMP"], "no ready-made study"),
        (["export", "none.sqlite"], "there is no response store"),
        (
            ["run-lab", STUDY, "--stimuli", "SET", "--data", "TMP", "--gender", "other"],
            r"demographics\.age: missing",
        ),
        (["new", "A name"], "name: 'A name' given"),
    ],
)
def test_what_cannot_be_done_is_told_in_one_line(
    arguments: list[str], message: str, drawn_set: StimulusSet, tmp_path: Path
) -> None:
    known = {"SET": str(drawn_set.folder), "TMP": str(tmp_path / "r.sqlite")}
    with pytest.raises(InputError, match=message) as caught:
        study_command(*(known.get(part, part) for part in arguments))
    assert "\n" not in str(caught.value)


def test_serve_refuses_a_port_in_use_and_makes_no_store(
    drawn_set: StimulusSet, tmp_path: Path
) -> None:
    data = tmp_path / "r.sqlite"
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=f"port {port} is in use; choose another with --port"):
            study_command(
                *("serve", STUDY, "--stimuli", drawn_set.folder, "--data", data, "--port", port)
            )
    assert not data.exists()


def test_serve_refuses_an_unwritable_folder(drawn_set: StimulusSet, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    data = tmp_path / "file" / "r.sqlite"
    with pytest.raises(InputError, match="cannot be used as a response store"):
        study_command(
            *("serve", STUDY, "--stimuli", drawn_set.folder, "--data", data, "--port", "0")
        )
