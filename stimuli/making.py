"""Making a stimulus set image by image, so that an interrupted one goes on where it was."""

import importlib.metadata
import json
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, Literal

from algorithms.errors import InputError
from algorithms.files import make_folder, sha256_of, write_atomically
from stimuli.engine import Engine
from stimuli.exposure import clipped_share
from stimuli.manifest import MANIFEST_NAME, Stimulus, StimulusSet, load

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
    engine: Engine | Literal["none"]
    versions: Mapping[str, str]


@dataclass(frozen=True)
class Job:
    """One image of a set, and what makes it.

    Attributes
    ----------
    stimulus
        As it will stand in the manifest, but for what only the making can tell.
    make
        Writes the stimulus' files into the set's folder, and returns what else is to stand in its
        `details`: JSON, such as the noise that is left.
    """

    stimulus: Stimulus
    make: Callable[[Path], Mapping[str, Any]]


@dataclass(frozen=True)
class Plan:
    """The images of a set, and what they have in common.

    Attributes
    ----------
    jobs
        One for each image, in the set's order.
    exposure, objects, details
        As in the manifest; see `StimulusSet`.
    conclude
        Returns, from the finished images, what else is to stand in the set's `details`.
    """

    jobs: Sequence[Job]
    exposure: float
    objects: Mapping[int, str] = field(default_factory=dict)
    details: Mapping[str, Any] = field(default_factory=dict)
    conclude: Callable[[StimulusSet], Mapping[str, Any]] = lambda _: {}


def make_set(
    folder: Path, recipe: Recipe, plan: Callable[[], Plan], progress: Progress = no_progress
) -> StimulusSet:
    """Make a set, or what is missing of it, and write its manifest.

    Parameters
    ----------
    folder
        New, empty, or begun with the same recipe.
    recipe
        Fixes the set's bytes.
    plan
        Called where something is to be made; the same recipe must give the same plan.
    progress
        Called after each image.

    Returns
    -------
    The set, as written.

    Raises
    ------
    InputError
        If the folder holds something else or cannot be written to; whatever the jobs raise.
    """
    if finished := open_set_folder(folder, recipe):
        return finished
    made = plan()
    stimuli = []
    for done, job in enumerate(made.jobs):
        progress(done, len(made.jobs))
        stimuli.append(_make_stimulus(folder, job))
    progress(len(made.jobs), len(made.jobs))
    finished = StimulusSet(
        **asdict(recipe),
        exposure=made.exposure,
        objects=made.objects,
        files=digests(folder),
        stimuli=tuple(stimuli),
    ).in_folder(folder)
    clipped = clipped_share(folder / stimulus.file for stimulus in stimuli)
    details = {**made.details, "clipped_share": clipped, **made.conclude(finished)}
    finished.model_copy(update={"details": details}).write(folder)
    return load(folder)  # as anybody else will see it: what was a tuple is a list in JSON


def _make_stimulus(folder: Path, job: Job) -> Stimulus:
    """Do a job unless it is done; its record is the last file that it leaves."""
    stimulus = job.stimulus
    record = folder / "measured" / f"{stimulus.id}.json"
    used = (stimulus.file, stimulus.regions, *stimulus.truth.values())
    places = [record, *(folder / file for file in used if file)]
    if not all(place.is_file() for place in places):
        for parent in {place.parent for place in places}:
            make_folder(parent)
        measured = dict(job.make(folder))
        write_atomically(record, json.dumps(measured, indent=1).encode() + b"\n")
    details = {**stimulus.details, **json.loads(record.read_bytes())}
    return stimulus.model_copy(update={"details": details})


def recipe_of(
    name: str,
    generator: str,
    parameters: Mapping[str, Any],
    seed: int,
    engine: Engine | Literal["none"],
) -> Recipe:
    """Return the recipe of a set that is made now, with the versions that are installed.

    The engine is `none` where nothing is rendered.

    Raises
    ------
    InputError
        If the seed is negative.
    """
    if seed < 0:
        raise InputError(f"seed: {seed} given, 0 or more accepted")
    return Recipe(name, generator, parameters, seed, engine, current_versions(engine))


def current_versions(engine: Engine | Literal["none"]) -> dict[str, str]:
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
