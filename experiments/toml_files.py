"""TOML files of the user's, read into a model that refuses what it does not know."""

import tomllib
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from algorithms.errors import InputError
from experiments.study_parts import Part
from stimuli.manifest import first_fault

Model = TypeVar("Model", bound=Part)


def read_toml(path: Path, model: type[Model]) -> Model:
    """Read a TOML file into a model.

    Raises
    ------
    InputError
        If the file cannot be read, is not TOML, or has an unknown, missing or impossible entry:
        the message names the key.
    """
    try:
        return model.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a TOML file ({error})") from error
    except ValidationError as error:
        raise InputError(f"{path}: {first_fault(error)}") from error
