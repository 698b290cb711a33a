"""`trompe stimuli` as it is typed."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image

import trompe
from stimuli.engine import choose_engine
from stimuli.manifest import StimulusSet, load
from stimuli.sets import SUMMARIES
from tests.stimuli.conftest import QUICK_SEED

ROOT = Path(__file__).parents[2]


def refusal(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """Run a command that cannot be done, and return the one line that it prints."""
    with pytest.raises(SystemExit) as ended:
        trompe.main(["stimuli", *map(str, arguments)])
    printed = capsys.readouterr()
    assert ended.value.code == 2
    assert printed.out == ""
    (line,) = printed.err.splitlines()
    return line


def told(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    """Run a command and return what it prints."""
    with pytest.raises(SystemExit) as ended:
        trompe.main(["stimuli", *map(str, arguments)])
    assert ended.value.code == 0
    return capsys.readouterr().out


@pytest.mark.slow
def test_make_in_another_process_gives_the_same_bytes(
    quick_set: StimulusSet, tmp_path: Path
) -> None:
    # Property: same seed, engine and versions, same bytes: the digest is that of all of them.
    completed = subprocess.run(
        [
            *(sys.executable, "-m", "trompe", "stimuli", "make", "divergence", tmp_path / "set"),
            *("--quick", "--seed", str(QUICK_SEED), "--engine", quick_set.engine, "--json"),
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 0, completed.stderr
    assert json.loads(completed.stdout) == {
        "set": "divergence",
        "folder": str(tmp_path / "set"),
        "main": 30,
        "practice": 3,
        "engine": quick_set.engine,
        "seed": QUICK_SEED,
        "digest": quick_set.digest,
    }
    assert completed.stderr == ""  # no progress bar where there is no terminal
    load(tmp_path / "set").verify()


def test_make_passes_its_options_on(
    make_tiny: Callable[..., StimulusSet], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ("--quick", "--seed", 5, "--engine", "scalar", "--replicates", 2)
    facts = json.loads(told(capsys, "make", "divergence", tmp_path / "one", *options, "--json"))
    assert (facts["main"], facts["engine"], facts["seed"]) == (60, "scalar", 5)
    made = make_tiny(tmp_path / "two", engine="scalar", replicates=2)
    assert facts["digest"] == made.digest
    lines = told(capsys, "make", "divergence", tmp_path / "one", *options).splitlines()
    assert ["digest", made.digest] in [line.split() for line in lines]


def test_list_names_every_set(capsys: pytest.CaptureFixture[str]) -> None:
    assert json.loads(told(capsys, "list", "--json")) == dict(SUMMARIES)
    lines = told(capsys, "list").splitlines()
    assert [line.split()[0] for line in lines] == list(SUMMARIES)


def test_show_draws_a_contact_sheet(
    drawn_set: StimulusSet, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sheet = tmp_path / "sheet.png"
    options = ("--output", sheet, "--columns", 8, "--width", 32)
    printed = told(capsys, "show", drawn_set.folder, *options)
    assert printed.splitlines()[-1] == f"wrote {sheet}"
    with Image.open(sheet) as picture:
        assert picture.width == 12 + 8 * (32 + 12)
    facts = json.loads(told(capsys, "show", drawn_set.folder, *options, "--json"))
    assert facts["digest"] == drawn_set.digest


def test_what_cannot_be_made_is_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "notes.txt").touch()
    file = tmp_path / "other" / "notes.txt"
    for arguments, message in [
        (("cubes", tmp_path / "set"), "set: 'cubes' given, divergence"),
        (("divergence", tmp_path / "set", "--engine", "gpu"), "engine: 'gpu' given"),
        (("divergence", tmp_path / "set", "--seed", "-1"), "seed: -1 given"),
        (("divergence", tmp_path / "set", "--replicates", "0"), "replicates: 0 given"),
        (("divergence", tmp_path / "other"), "holds other files"),
        (("divergence", file / "set"), "not a folder that can be written to"),
    ]:
        assert message in refusal(capsys, "make", *arguments)
    assert not (tmp_path / "set").exists()


def test_unavailable_engine_is_told_with_its_remedy(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    if choose_engine() == "cuda":
        pytest.skip("needs a machine without an NVIDIA GPU")
    line = refusal(capsys, "make", "divergence", tmp_path / "set", "--engine", "cuda")
    assert line == (
        "trompe: engine: cuda: no NVIDIA GPU with a driver; install an NVIDIA driver (535 or newer)"
    )


def test_what_cannot_be_shown_is_told_in_one_line(
    drawn_set: StimulusSet, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for arguments, message in [
        ((tmp_path,), "manifest.json: cannot be read"),
        ((drawn_set.folder, "--columns", 0), "columns: 0 given"),
        ((drawn_set.folder, "--output", tmp_path / "none" / "s.png"), "cannot be written"),
        ((drawn_set.folder, "--output", tmp_path / "s.gif"), "s.gif: a file ending in"),
    ]:
        assert message in refusal(capsys, "show", *arguments)
    assert list(tmp_path.iterdir()) == []
