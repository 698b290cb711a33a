"""Which Mitsuba variant renders here: CUDA, LLVM or, where neither works, the scalar one."""

import functools
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, get_args

import mitsuba as mi

from algorithms.errors import InputError, UnavailableError

Engine = Literal["cuda", "llvm", "scalar"]

VARIANTS: Final[dict[Engine, str]] = {
    "cuda": "cuda_ad_rgb",
    "llvm": "llvm_ad_rgb",
    "scalar": "scalar_rgb",
}
_LIBRARY_VARIABLE: Final = "DRJIT_LIBLLVM_PATH"
_LIBRARY_FOLDERS: Final = (
    "/usr/lib/*-linux-gnu",
    "/usr/lib/llvm-*/lib",
    "/usr/lib64",
    "/usr/local/lib",
    "/opt/homebrew/opt/llvm/lib",
)
_LIBRARY_NAMES: Final = ("libLLVM*.so*", "libLLVM*.dylib")
_PROBE_TIMEOUT_S: Final = 60
# Older code generators abort the process on just this instruction, which no caller can catch.
_PROBE: Final = """
import drjit
from drjit.{backend} import Float
assert drjit.maximum(drjit.arange(Float, 4), 2)[3] == 3
"""


@dataclass(frozen=True)
class EngineStatus:
    """Whether an engine works on this machine.

    Attributes
    ----------
    name, works
        Which engine, and whether it was tried out with success.
    detail
        The library or the reason.
    remedy
        How to get it where it does not work.
    """

    name: Engine
    works: bool
    detail: str
    remedy: str


def choose_engine(requested: str | None = None) -> Engine:
    """Set Mitsuba's variant to the fastest engine that works here, or to the requested one.

    Parameters
    ----------
    requested
        `cuda`, `llvm`, `scalar`, or None for the first of these that works.

    Raises
    ------
    InputError
        If the engine's name is unknown.
    UnavailableError
        If the requested engine does not work on this machine.
    """
    if requested is not None and requested not in get_args(Engine):
        raise InputError(f"engine: {requested!r} given, {', '.join(get_args(Engine))} accepted")
    for engine in get_args(Engine):
        if requested not in (None, engine):
            continue
        status = _STATUS[engine]()
        if status.works:
            mi.set_variant(VARIANTS[engine])
            return status.name
        if requested is not None:
            raise UnavailableError(f"engine: {engine}: {status.detail}; {status.remedy}")
    raise AssertionError("the scalar engine always works")


def require_kernels(what: str) -> None:
    """Refuse the scalar engine for what is computed by kernels of Dr.Jit.

    Parameters
    ----------
    what
        A plural, for the message.

    Raises
    ------
    UnavailableError
        If the scalar engine was chosen.
    """
    if mi.variant() == VARIANTS["scalar"]:
        raise UnavailableError(f"engine: {what} need llvm or cuda; apt install libllvm19")


def engine_report() -> tuple[EngineStatus, ...]:
    """Try every engine and say what was found, the fastest first."""
    return tuple(_STATUS[engine]() for engine in get_args(Engine))


@functools.cache
def _cuda_status() -> EngineStatus:
    remedy = "install an NVIDIA driver (535 or newer)"
    if _probe("cuda", {}):
        return EngineStatus("cuda", True, "an NVIDIA GPU", remedy)
    return EngineStatus("cuda", False, "no NVIDIA GPU with a driver", remedy)


@functools.cache
def _llvm_status() -> EngineStatus:
    """Find a libLLVM that compiles a kernel, and name it to Dr.Jit before its first use."""
    remedy = "apt install libllvm19"
    libraries = _libraries()
    for library in libraries:
        if _probe("llvm", {_LIBRARY_VARIABLE: str(library)}):
            os.environ[_LIBRARY_VARIABLE] = str(library)
            return EngineStatus("llvm", True, str(library), remedy)
    found = ", ".join(library.name for library in libraries)
    detail = f"only found what is too old: {found}" if found else "no libLLVM found"
    return EngineStatus("llvm", False, detail, remedy)


def _scalar_status() -> EngineStatus:
    return EngineStatus("scalar", True, "always there, one core a ray at a time", "")


_STATUS: Final[dict[Engine, Callable[[], EngineStatus]]] = {
    "cuda": _cuda_status,
    "llvm": _llvm_status,
    "scalar": _scalar_status,
}


def _libraries() -> list[Path]:
    """Return the libLLVM named by the environment, or all that are installed, newest first."""
    named = os.environ.get(_LIBRARY_VARIABLE)
    if named:
        return [Path(named)]
    found = {
        path.resolve()
        for folder in _LIBRARY_FOLDERS
        for name in _LIBRARY_NAMES
        for path in Path("/").glob(f"{folder.removeprefix('/')}/{name}")
    }
    return sorted(found, key=_version, reverse=True)


def _version(library: Path) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", library.name))


def _probe(backend: str, environment: dict[str, str]) -> bool:
    """Compile and run a kernel in a process of its own, which may abort."""
    try:
        completed = subprocess.run(
            [sys.executable, "-c", _PROBE.format(backend=backend)],
            env=os.environ | environment,
            capture_output=True,
            timeout=_PROBE_TIMEOUT_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return completed.returncode == 0
