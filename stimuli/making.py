"""Making a stimulus set file by file, so that an interrupted one goes on where it was."""

import importlib.metadata
import json
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from algorithms.errors import InputError
from algorithms.files import make_folder, sha256_of, write_atomically
from stimuli.engine import Engine
from stimuli.manifest import MANIFEST_NAME, StimulusSet, load

_RECIPE_NAME: Final = "recipe.json"
_LIBRARIES: Final = ("trompe", "mitsuba", "drjit", "numpy", "pillow")

Progress = Callable[[int, int], None]
"""Called with how many images are done and how many there are."""


def no_progress(done: int, total: int) -> None:  # the shape of `Progress`
    """Tell nobody."""


@dataclass(frozen=True)
class Recipe:
    """Everything that fixes the bytes of a set: two equal recipes make equal sets."""

    name: str
    generator: str
    parameters: Mapping[str, Any]
    seed: int
    engine: Engine
    versions: Mapping[str, str]


def current_versions(engine: Engine) -> dict[str, str]:
    """Return the versions of what takes part in rendering."""
    versions = {name: _version(name) for name in _LIBRARIES}
    if engine == "llvm":
        library = Path(os.environ["DRJIT_LIBLLVM_PATH"]).name
        versions["libllvm"] = ".".join(re.findall(r"\d+", library))
    return versions


def open_set_folder(folder: Path, recipe: Recipe) -> StimulusSet | None:
    """Make a folder ready for a set, or for going on with the same one.

    Files that were altered since the set was finished are removed, so that they are made again.

    Parameters
    ----------
    folder
        New, empty, or begun with the same recipe.
    recipe
        What is going to be made.

    Returns
    -------
    The set, if it is finished and nothing of it is missing; else None.

    Raises
    ------
    InputError
        If the folder cannot be written to, or holds something else.
    """
    make_folder(folder)
    begun = folder / _RECIPE_NAME
    content = json.dumps(asdict(recipe), indent=1).encode() + b"\n"
    if begun.is_file():
        if begun.read_bytes() != content:
            raise InputError(
                f"{folder}: holds a set made with {_difference(begun, recipe)}; choose another"
                " folder"
            )
    elif any(folder.iterdir()):
        raise InputError(f"{folder}: holds other files; choose a new or empty folder")
    write_atomically(begun, content)
    for leftover in folder.rglob(".*.*"):  # what an interruption left of a file
        if leftover.is_file():
            leftover.unlink()
    return _finished_set(folder) if (folder / MANIFEST_NAME).is_file() else None


def digests(folder: Path) -> dict[str, str]:
    """Return the SHA-256 of every file of a set, by its path relative to the folder."""
    beside = {MANIFEST_NAME, _RECIPE_NAME}
    paths = sorted(path for path in folder.rglob("*") if path.is_file())
    return {
        path.relative_to(folder).as_posix(): sha256_of(path)
        for path in paths
        if path.name not in beside
    }


def _finished_set(folder: Path) -> StimulusSet | None:
    """Return a set if all its files are what they were, and remove those that are not."""
    made = load(folder)
    paths = {made.path(relative): digest for relative, digest in made.files.items()}
    altered = [
        path for path, digest in paths.items() if path.is_file() and sha256_of(path) != digest
    ]
    for path in altered:
        path.unlink()
    return made if all(path.is_file() for path in paths) else None


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def _difference(begun: Path, recipe: Recipe) -> str:
    """Name the first entry in which a begun recipe differs."""
    try:
        old = json.loads(begun.read_bytes())
    except ValueError:
        old = None
    if not isinstance(old, dict):
        return f"a broken {_RECIPE_NAME}"
    for key, value in json.loads(json.dumps(asdict(recipe))).items():
        if old.get(key) != value:
            return f"another {key} ({old.get(key)}, not {value})"
    return "another recipe"
