"""A folder of aligned photographs of one scene under several lights, described by a TOML file.

The folder holds `photographs.toml`:

    reference = "light-00.png"         # what the others are compared with and put into
    labels = "objects.png"             # 8-bit grey PNG: 0 is background, each object has a value
    pairs = [["doll", "venus"]]        # optional: objects that are also inserted together
    width_px = 1024                    # optional: of the stimuli, if the photographs are wider
    max_shift_px = 0.75                # optional: how far photographs may be out of line
    max_exposure_stops = 0.25          # optional: how far their exposures may differ

    [photographs]                      # each file with the angle of its key light ...
    "light-00.png" = 0
    "light-20.png" = 20
    "light-30.png" = -30

    [objects]                          # each object by its value in `labels` ...
    doll = 1
    venus = "venus.png"                # ... or by a mask of its own, not 0 where it is seen

Angles are in degrees from any direction, all around one axis. Where the lights' directions are
known, each file has `{ azimuth_deg = 120, elevation_deg = 45 }` instead, in the project's frame
(`algorithms.light`). Photographs are PNG or JPEG (taken as sRGB) or OpenEXR files (linear), all of
one size, taken with the same exposure from the same place; other keys are refused.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Annotated, Final, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    StringConstraints,
    ValidationError,
    model_validator,
)

from algorithms.color import FloatImage
from algorithms.errors import InputError
from algorithms.images import read_image, read_labels
from algorithms.light import Light, angle_between_deg
from stimuli.manifest import RelativePath, first_fault

FILE_NAME: Final = "photographs.toml"
MAX_PIXELS: Final = 30_000_000
"""Larger photographs are refused before they are decoded."""

_SAME_ANGLE_DEG: Final = 0.5

Name = Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9-]{0,31}$")]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Direction(BaseModel):
    """Where a key light stands, in the project's frame."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    azimuth_deg: float = Field(allow_inf_nan=False)
    elevation_deg: float = Field(ge=-90, le=90)


class Description(BaseModel):
    """What `photographs.toml` says; see the module's docstring."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    reference: str
    labels: RelativePath | None = None
    pairs: tuple[tuple[Name, Name], ...] = ()
    width_px: Annotated[int, Field(ge=64, le=4096)] = 1024
    max_shift_px: Positive = 0.75
    max_exposure_stops: Positive = 0.25
    photographs: Mapping[RelativePath, Annotated[float, Field(allow_inf_nan=False)] | Direction] = (
        Field(min_length=2)
    )
    objects: Mapping[Name, Annotated[int, Field(ge=1, le=255)] | RelativePath] = Field(min_length=1)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.reference not in self.photographs:
            raise ValueError(f"reference: {self.reference!r} is not one of the photographs")
        if len({isinstance(key, Direction) for key in self.photographs.values()}) > 1:
            raise ValueError("photographs: angles for all or directions for all are accepted")
        for first, second in combinations(self.photographs, 2):
            if self.divergence_deg(first, second) < _SAME_ANGLE_DEG:
                raise ValueError(f"photographs: {first!r} and {second!r} have the same light")
        if self.labels is None and any(isinstance(value, int) for value in self.objects.values()):
            raise ValueError("labels: a label image is needed for objects that are given by number")
        values = list(self.objects.values())
        for value in values:
            if values.count(value) > 1:
                raise ValueError(f"objects: {value!r} stands for two of them")
        for pair in self.pairs:
            if pair[0] == pair[1] or not set(pair) <= self.objects.keys():
                raise ValueError(f"pairs: two objects by name are accepted, not {list(pair)}")
        return self

    def light(self, file: str) -> Light | None:
        """Return a photograph's key light, or None where only angles are known."""
        key = self.photographs[file]
        return Light(key.azimuth_deg, key.elevation_deg) if isinstance(key, Direction) else None

    def divergence_deg(self, first: str, second: str) -> float:
        """Return the angle between two photographs' key lights, 0..180 degrees."""
        one, other = self.light(first), self.light(second)
        if one is not None and other is not None:
            return angle_between_deg(one, other)
        turns = [self.photographs[file] for file in (first, second)]
        difference = abs(float(turns[0]) - float(turns[1])) % 360  # type: ignore[arg-type]
        return min(difference, 360 - difference)


@dataclass(frozen=True)
class PhotographFolder:
    """The user's photographs.

    Attributes
    ----------
    folder, description
        Where they are, and what is said of them.
    """

    folder: Path
    description: Description

    @property
    def others(self) -> list[str]:
        """The photographs other than the reference, by divergence."""
        reference = self.description.reference
        files = [file for file in self.description.photographs if file != reference]
        return sorted(files, key=lambda file: self.description.divergence_deg(reference, file))

    @property
    def files(self) -> list[Path]:
        """Every file that counts."""
        described = self.description
        masks = [value for value in described.objects.values() if isinstance(value, str)]
        labels = [] if described.labels is None else [described.labels]
        return [self.folder / file for file in (*described.photographs, *labels, *masks)]

    def photograph(self, file: str) -> FloatImage:
        """Read a photograph as linear light `(height, width, 3)`."""
        return read_image(self.folder / file, MAX_PIXELS)

    def masks(self, shape: tuple[int, int]) -> dict[str, NDArray[np.bool_]]:
        """Read where each object is seen.

        Parameters
        ----------
        shape
            Height and width of the photographs.

        Raises
        ------
        InputError
            If a mask is missing, empty, of another size, touches the border or overlaps another.
        """
        masks: dict[str, NDArray[np.bool_]] = {}
        for name, value in self.description.objects.items():
            file = self.description.labels if isinstance(value, int) else value
            assert file is not None
            labels = read_labels(self.folder / file, MAX_PIXELS)
            place = f"{self.folder / file}: object {name!r}"
            if labels.shape != shape:
                raise InputError(f"{place}: {_size(shape)} pixels are accepted, as the photographs")
            masks[name] = labels == value if isinstance(value, int) else labels > 0
            _check_mask(place, name, masks)
        return masks


def read_folder(folder: Path) -> PhotographFolder:
    """Read a folder's description.

    Raises
    ------
    InputError
        If it is missing or not valid: the message names the key.
    """
    path = folder / FILE_NAME
    try:
        described = Description.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a TOML file ({error})") from error
    except ValidationError as error:
        raise InputError(f"{path}: {first_fault(error)}") from error
    return PhotographFolder(folder, described)


def _check_mask(place: str, name: str, masks: Mapping[str, NDArray[np.bool_]]) -> None:
    mask = masks[name]
    if not mask.any():
        raise InputError(f"{place}: its mask is empty; one pixel or more is accepted")
    if mask[[0, -1]].any() or mask[:, [0, -1]].any():
        raise InputError(f"{place}: its mask touches the border; objects seen whole are accepted")
    for other, earlier in masks.items():
        if other != name and (mask & earlier).any():
            raise InputError(f"{place}: its mask overlaps that of {other!r}")


def _size(shape: tuple[int, int]) -> str:
    return f"{shape[1]} x {shape[0]}"
