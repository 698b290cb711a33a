"""What an edit is asked to do, and the doing: from files to a picture in memory.

An edit is a function from a `Request` and the picture's linear light to linear light. Everything it
needs is in the request, as paths and as values that JSON holds, so that a record of the request
repeats it. What is not edited is not this file's: an alpha channel passes by.
"""

import importlib
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from algorithms.color import FloatImage
from algorithms.errors import InputError
from algorithms.images import MAX_PIXELS, read_image_and_alpha

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

EDITS: Final = ("fog", "caustics", "transparent")
"""Each is a file of this folder with a function `edit`."""


@dataclass(frozen=True)
class Request:
    """One edit.

    Attributes
    ----------
    edit
        One of `EDITS`.
    image
        The picture.
    inputs
        Other files, by what they are to the edit, such as `mask` and `depth`.
    parameters
        The edit's settings, complete, as values that JSON holds.
    """

    edit: str
    image: Path
    inputs: Mapping[str, Path] = field(default_factory=lambda: MappingProxyType({}))
    parameters: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        if self.edit not in EDITS:
            raise InputError(f"edit: {self.edit!r} given, {', '.join(EDITS)} accepted")


@dataclass(frozen=True)
class Edited:
    """A picture before and after: linear light, `(height, width, 3)`, and its alpha or None."""

    before: FloatImage
    after: FloatImage
    alpha: NDArray[np.float32] | None


def perform(request: Request, max_pixels: int = MAX_PIXELS) -> Edited:
    """Read a request's picture and edit it.

    Returns
    -------
    The picture before and after, of the same size; alpha as it was.

    Raises
    ------
    InputError
        If an input is not accepted, or an edit's settings are not.
    """
    image, alpha = read_image_and_alpha(request.image, max_pixels)
    if not np.isfinite(image).all() or (image < 0).any():
        raise InputError(f"{request.image}: finite pixels of 0 or more are accepted")
    edit: Callable[[FloatImage, Request], FloatImage]
    edit = importlib.import_module(f"algorithms.edits.{request.edit}").edit
    return Edited(image, edit(image, request), alpha)


Settings = TypeVar("Settings", bound="DataclassInstance")


def settings_from(kind: type[Settings], values: Mapping[str, Any]) -> Settings:
    """Make settings, a dataclass, of values as JSON holds them.

    Raises
    ------
    InputError
        If there is no setting of a name, or a value is not accepted.
    """
    from pydantic import TypeAdapter, ValidationError  # only the command that edits needs it

    accepted = [each.name for each in fields(kind)]
    for name in values:
        if name not in accepted:
            raise InputError(f"{name}: no such setting; {', '.join(accepted)} are accepted")
    try:
        return TypeAdapter(kind).validate_python(dict(values))
    except ValidationError as error:
        first = error.errors()[0]
        place = "".join(f"{name}: " for name in first["loc"][:1])
        raise InputError(place + first["msg"].removeprefix("Value error, ")) from error


def changed(settings: Settings, assignments: list[str]) -> Settings:
    """Change settings as `NAME=VALUE` says; commas separate the parts of a value.

    Raises
    ------
    InputError
        If an assignment has another form, or is not accepted.
    """
    values: dict[str, Any] = asdict(settings)
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise InputError(f"set: {assignment!r} given, NAME=VALUE accepted")
        values[name.strip()] = _value(text)
    return settings_from(type(settings), values)


def _value(text: str) -> object:
    if text.strip().lower() == "none":
        return None
    return text.split(",") if "," in text else text.strip()
