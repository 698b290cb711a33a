"""The shape of the project: which room may import which, and what a fresh name may hide."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LOCKS = sorted((ROOT / "requirements").glob("*.txt"))


def test_imports_go_one_way() -> None:
    completed = subprocess.run(
        [Path(sys.executable).with_name("lint-imports"), "--no-cache"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 0, completed.stdout
    assert "2 kept, 0 broken" in completed.stdout


@pytest.mark.parametrize("room", ["algorithms", "stimuli", "experiments", "analysis"])
def test_the_command_runs_beside_a_folder_that_has_the_name_of_a_room(
    room: str, tmp_path: Path
) -> None:
    folder = tmp_path / room
    folder.mkdir()
    (folder / "__init__.py").write_text("raise RuntimeError('the wrong package')")
    completed = subprocess.run(
        [Path(sys.executable).with_name("trompe"), "--help"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 0, completed.stderr
    assert "Usage" in completed.stdout


@pytest.mark.parametrize("lock", LOCKS, ids=lambda path: path.name)
def test_a_lock_pins_every_package_and_names_no_host(lock: Path) -> None:
    lines = lock.read_text(encoding="utf-8").splitlines()
    assert lines
    for line in lines:
        assert re.match(r"^[A-Za-z0-9._-]+(\[[a-z0-9,-]+\])?==[^\s/]+( ; .+)?$", line), line


def test_the_locks_agree() -> None:
    run, test = (
        set((ROOT / "requirements" / name).read_text(encoding="utf-8").splitlines())
        for name in ("run.txt", "test.txt")
    )
    assert run <= test
