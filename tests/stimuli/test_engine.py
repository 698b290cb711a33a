"""Which engine is taken, on machines that have more or less than this one."""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import mitsuba as mi
import pytest

from algorithms.errors import InputError, UnavailableError
from stimuli import engine as engines
from stimuli.engine import choose_engine, engine_report
from tests.conftest import require

ROOT = Path(__file__).parents[2]
LIBRARY_VARIABLE = "DRJIT_LIBLLVM_PATH"

# Prints what is chosen without a request, what was found, and what a request of LLVM is told.
CHOOSE = """
from algorithms.errors import UnavailableError
from stimuli.engine import choose_engine, engine_report
print(choose_engine())
print(next(status.detail for status in engine_report() if status.name == "llvm"))
try:
    choose_engine("llvm")
except UnavailableError as error:
    print(error)
"""


def choose_with(library: Path) -> list[str]:
    """Choose an engine in a new process that is told to use this libLLVM."""
    completed = subprocess.run(
        [sys.executable, "-c", CHOOSE],
        cwd=ROOT,
        env=os.environ | {LIBRARY_VARIABLE: str(library), "CUDA_VISIBLE_DEVICES": ""},
        capture_output=True,
        text=True,
        check=False,
    )
    assert completed.returncode == 0, completed.stderr
    return completed.stdout.splitlines()


def installed(version: int) -> Path:
    """Return an installed libLLVM of this major version, or skip the test."""
    libraries = sorted(Path("/usr/lib").glob(f"*-linux-gnu/libLLVM-{version}.so*"))
    require(libraries, f"needs libLLVM {version} (apt install libllvm{version})")
    return libraries[0]


@pytest.fixture
def forget(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let libLLVM be looked for anew, and what was found in the test be forgotten after it."""
    monkeypatch.setenv(LIBRARY_VARIABLE, "remembered, so that it is restored")
    monkeypatch.delenv(LIBRARY_VARIABLE)
    engines._llvm_status.cache_clear()
    yield
    engines._llvm_status.cache_clear()


@pytest.mark.parametrize("version", [14, 15])
def test_old_code_generator_is_left_alone(version: int) -> None:
    # Property: some of these abort the process that uses them, which no caller could catch.
    library = installed(version)
    chosen, detail, refusal = choose_with(library)
    assert chosen == "scalar"
    assert detail == f"only found what is too old: {library.name}"
    assert refusal == f"engine: llvm: {detail}; apt install libllvm19"


def test_file_that_is_no_library_is_left_alone(tmp_path: Path) -> None:
    library = tmp_path / "libLLVM.so.19.1"
    library.write_bytes(b"no library")
    chosen, *_ = choose_with(library)
    assert chosen == "scalar"


@pytest.mark.usefixtures("forget")
def test_machine_without_a_code_generator(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "_LIBRARY_FOLDERS", ())
    with pytest.raises(UnavailableError, match="llvm: no libLLVM found; apt install libllvm19"):
        choose_engine("llvm")


@pytest.mark.usefixtures("forget")
def test_newest_library_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    # Property: version 19 before 9, though not in the alphabet; the first that works is taken.
    names = ("libLLVM-9.so.1", "libLLVM.so.19.1", "libLLVM-15.so.1", "libLLVM.so.20.1")
    tried: list[str] = []
    monkeypatch.setattr(Path, "glob", lambda _, pattern: map(Path, names * ("-gnu" in pattern)))

    def probe(_backend: str, environment: dict[str, str]) -> bool:
        tried.append(Path(environment[LIBRARY_VARIABLE]).name)
        return "19" in tried[-1]

    monkeypatch.setattr(engines, "_probe", probe)
    status = engines._llvm_status()
    assert tried == ["libLLVM.so.20.1", "libLLVM.so.19.1"]
    assert (status.works, Path(status.detail).name) == (True, "libLLVM.so.19.1")


def test_unknown_engine_is_refused() -> None:
    with pytest.raises(InputError, match="engine: 'gpu' given, cuda, llvm, scalar accepted"):
        choose_engine("gpu")


def test_report_names_every_engine_and_its_remedy() -> None:
    report = engine_report()
    assert [status.name for status in report] == ["cuda", "llvm", "scalar"]
    assert report[-1].works
    assert all(status.works or status.remedy for status in report)


def test_chosen_engine_sets_the_variant() -> None:
    fastest = choose_engine()
    assert fastest == next(status.name for status in engine_report() if status.works)
    assert mi.variant() == engines.VARIANTS[fastest]
    assert choose_engine("scalar") == "scalar"
    assert mi.variant() == "scalar_rgb"
