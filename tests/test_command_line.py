"""The command line as a newcomer uses it: the whole loop, the doctor, and what goes wrong."""

import json
import socket
import subprocess
import sys
from pathlib import Path

import pytest

import trompe
from experiments import load_responses
from experiments.doctor import examine
from experiments.storage.store import Store
from stimuli.manifest import load


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run the installed command in a process of its own."""
    return subprocess.run(
        [Path(sys.executable).with_name("trompe"), *arguments],
        cwd=cwd,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
def test_the_demo_runs_the_whole_loop_and_goes_on_where_it_was(tmp_path: Path) -> None:
    demo = ("demo", "--no-serve", "--port", "0", "--participants")
    first = run(*demo, "2", cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    made = load(tmp_path / "demo" / "stimuli")
    made.verify()
    data = tmp_path / "demo" / "responses.sqlite"
    answers = load_responses(data)
    assert len(answers) == 2 * (len(made.with_role("main")) + len(made.with_role("practice")))
    assert answers["simulated"].all()
    page = (tmp_path / "demo" / "report" / "report.html").read_text(encoding="utf-8")
    assert "SIMULATED" in page
    assert "Simulated observers, not people," in first.stdout

    second = run(*demo, "3", cwd=tmp_path)
    assert second.returncode == 0, second.stderr
    kept = load_responses(data)
    assert kept.iloc[: len(answers)].equals(answers)
    with Store.open(data) as store:
        assert [session.participant for session in store.sessions()] == ["P0001", "P0002", "P0003"]


def test_a_port_in_use_is_said_before_anything_is_rendered(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        completed = run("demo", "--port", str(port), cwd=tmp_path)
    assert completed.returncode == 2
    assert completed.stderr == f"trompe: port {port} is in use; choose another with --port\n"
    assert not (tmp_path / "demo").exists()


def test_the_doctor_names_everything_and_how_to_get_what_is_missing(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit) as ended:
        trompe.main(["doctor", "--json"])
    assert ended.value.code == 0
    told = json.loads(capsys.readouterr().out)
    names = [check["name"] for check in told]
    assert names == [
        "engine cuda",
        "engine llvm",
        "engine scalar",
        "PsychoPy",
        "OpenGL",
        "display",
        "graphics card",
        "ports",
        "Chromium",
        "front end",
    ]
    for check in told:
        assert check["detail"]
        assert bool(check["remedy"]) != check["works"]


def test_the_doctor_finds_nothing_where_there_is_nothing(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("DISPLAY", ":4711")
    monkeypatch.setattr("experiments.doctor.BUNDLE", tmp_path)
    found = {check.name: check for check in examine()}
    for name in ("display", "graphics card", "Chromium", "front end"):
        assert not found[name].works
    assert found["Chromium"].remedy == "apt install chromium"
    assert "xvfb" in found["display"].remedy


def test_expected_errors_are_one_line_and_exit_status_2(tmp_path: Path) -> None:
    completed = run("analyse", "nothing.sqlite", "--out", "report", cwd=tmp_path)
    assert completed.returncode == 2
    assert completed.stdout == ""
    assert completed.stderr == "trompe: nothing.sqlite: there is no response store\n"
    assert list(tmp_path.iterdir()) == []
