"""A stimulus set: a folder of images and a `manifest.json` that says what each of them is."""

import hashlib
import json
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PrivateAttr,
    ValidationError,
    model_validator,
)

from algorithms.errors import InputError
from algorithms.files import sha256_of, write_atomically

if TYPE_CHECKING:
    import pandas as pd

MANIFEST_NAME = "manifest.json"

Role = Literal["main", "practice", "example"]
Factor = str | int | float | bool


def _inside(path: str) -> str:
    pure = PurePosixPath(path)
    if pure.is_absolute() or ".." in pure.parts or "\\" in path or not path:
        raise ValueError("a path relative to the set's folder, without '..', is accepted")
    return path


RelativePath = Annotated[str, AfterValidator(_inside)]


class Stimulus(BaseModel):
    """One image of a set.

    Attributes
    ----------
    id
        Unique within the set.
    file
        The image as shown (display-referred), relative to the set's folder.
    role
        `main` images are the study's, `practice` ones are for trials with feedback, `example`
        ones for the instructions.
    factors
        The levels that made it, by factor name; one key for all stimuli of a set.
    answer
        The right answer (for odd-one-out the label of the region, 1 or more; the labels of several
        where several objects are the right ones), or None where there is none.
    regions
        A label image (8-bit PNG, 0 = background) of the clickable regions, or None.
    truth
        Ground truth files by name (`distance`, `normal`, `albedo`, ...), relative to the folder.
    details
        What else is known of it, such as lights or measured noise.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    id: str = Field(min_length=1)
    file: RelativePath
    role: Role = "main"
    factors: Mapping[str, Factor]
    answer: int | str | tuple[int, ...] | None = None
    regions: RelativePath | None = None
    truth: Mapping[str, RelativePath] = Field(default_factory=dict)
    details: Mapping[str, Any] = Field(default_factory=dict)

    @property
    def right_labels(self) -> tuple[int, ...]:
        """The labels of the objects that are right to choose, from the smallest on; none: ()."""
        given = self.answer if isinstance(self.answer, tuple) else (self.answer,)
        return tuple(sorted(label for label in given if isinstance(label, int)))


class StimulusSet(BaseModel):
    """A folder of stimuli with everything that made them.

    The same generator, parameters, seed, engine and versions give the same bytes.

    Attributes
    ----------
    name, generator
        The set's name and the function that made it.
    parameters, seed
        What the generator was called with.
    engine, versions
        What rendered it (a Mitsuba variant) and the versions of the libraries.
    exposure
        The factor from scene-referred to display-referred linear light, one for the whole set.
    encoding
        How the images' values relate to light: `srgb`, as every runner shows them.
    objects
        The names of the regions' labels, for analysis; never shown to participants.
    files
        The SHA-256 of every file of the set, by its path relative to the folder.
    details
        What else is known of the set, such as its camera or the rate of a baseline observer.
    stimuli
        The stimuli, in the order of their making.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal[1] = 1
    name: str = Field(min_length=1)
    generator: str
    parameters: Mapping[str, Any]
    seed: int
    engine: str
    versions: Mapping[str, str]
    exposure: float = Field(gt=0)
    encoding: Literal["srgb"] = "srgb"
    objects: Mapping[int, str] = Field(default_factory=dict)
    details: Mapping[str, Any] = Field(default_factory=dict)
    files: Mapping[RelativePath, str]
    stimuli: tuple[Stimulus, ...] = Field(min_length=1)

    _folder: Path | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _check_references(self) -> Self:
        seen: set[str] = set()
        for stimulus in self.stimuli:
            if stimulus.id in seen:
                raise ValueError(f"stimuli: id {stimulus.id!r} stands twice")
            seen.add(stimulus.id)
            for path in (stimulus.file, stimulus.regions, *stimulus.truth.values()):
                if path is not None and path not in self.files:
                    raise ValueError(f"files: {path!r}, used by {stimulus.id!r}, is not listed")
        return self

    def __getitem__(self, identifier: str) -> Stimulus:
        """Return the stimulus of that id (KeyError if there is none)."""
        return self._by_id[identifier]

    @cached_property
    def _by_id(self) -> dict[str, Stimulus]:
        return {stimulus.id: stimulus for stimulus in self.stimuli}

    @cached_property
    def digest(self) -> str:
        """The SHA-256 of the whole manifest: two sets with one digest are the same set."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()

    @property
    def folder(self) -> Path:
        """The folder that the set was loaded from or written to."""
        if self._folder is None:
            raise InputError("stimuli: this set has no folder yet; write it first")
        return self._folder

    def path(self, relative: str) -> Path:
        """Return the full path of one of the set's files."""
        return self.folder / relative

    def with_role(self, role: Role) -> tuple[Stimulus, ...]:
        """Return the stimuli of a role, in order."""
        return tuple(stimulus for stimulus in self.stimuli if stimulus.role == role)

    def to_frame(self) -> "pd.DataFrame":
        """Return one row a stimulus: `stimulus`, `role`, `file`, `answer` and each factor."""
        import pandas as pd  # takes a second: only where a table is wanted

        return pd.DataFrame(
            [
                {
                    "stimulus": stimulus.id,
                    "role": stimulus.role,
                    "file": stimulus.file,
                    "answer": stimulus.answer,
                    **stimulus.factors,
                }
                for stimulus in self.stimuli
            ]
        )

    def verify(self) -> None:
        """Check every file of the set against its SHA-256.

        Raises
        ------
        InputError
            Naming the first file that is missing or altered.
        """
        for relative, digest in self.files.items():
            path = self.path(relative)
            if not path.is_file():
                raise InputError(f"{path}: listed in the set's manifest but missing; make it again")
            if sha256_of(path) != digest:
                raise InputError(f"{path}: altered since the set was made (its SHA-256 differs)")

    def in_folder(self, folder: Path) -> Self:
        """Return the set with its folder known, its manifest not yet written."""
        located = self.model_copy()
        located._folder = folder
        return located

    def write(self, folder: Path) -> Self:
        """Write `manifest.json` and return the set with its folder known."""
        content = json.dumps(self.model_dump(mode="json"), indent=1, sort_keys=False) + "\n"
        write_atomically(folder / MANIFEST_NAME, content.encode())
        return self.in_folder(folder)


def load(path: str | Path) -> StimulusSet:
    """Load a stimulus set from its folder or its manifest; files are checked by `verify`.

    Parameters
    ----------
    path
        The folder, or the `manifest.json` in it.

    Raises
    ------
    InputError
        If there is no manifest, or it is not a valid one: the message names the entry.
    """
    path = Path(path)
    manifest = path if path.name == MANIFEST_NAME else path / MANIFEST_NAME
    try:
        loaded = StimulusSet.model_validate_json(manifest.read_bytes())
    except OSError as error:
        raise InputError(
            f"{manifest}: cannot be read ({error.strerror}); `trompe stimuli make` makes a set"
        ) from error
    except ValidationError as error:
        raise InputError(f"{manifest}: {first_fault(error)}") from error
    loaded._folder = manifest.parent
    return loaded


def first_fault(error: ValidationError) -> str:
    """Return the first fault of a pydantic model as one line that names the key."""
    fault = error.errors(include_url=False)[0]
    place = ".".join(str(part) for part in fault["loc"])
    message = {
        "extra_forbidden": "unknown key",
        "missing": "missing",
    }.get(fault["type"], fault["msg"].removeprefix("Value error, "))
    return f"{place}: {message}" if place else message
