"""A new study to begin with: a commented file that is a valid study as it stands."""

from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from algorithms.errors import InputError
from algorithms.files import write_atomically
from experiments.study_parts import Name

_TEMPLATE = Path(__file__).parent / "template.toml"


def write_template(name: str, folder: Path) -> Path:
    """Write `NAME.toml` into a folder and return its path.

    Parameters
    ----------
    name
        The study's name: lower-case letters, digits and hyphens, at most 64.
    folder
        Where it goes; it must exist.

    Raises
    ------
    InputError
        If the name is not accepted, or the file exists or cannot be written.
    """
    try:
        TypeAdapter(Name).validate_python(name)
    except ValidationError:
        raise InputError(
            f"name: {name!r} given; lower-case letters, digits and hyphens, at most 64, accepted"
        ) from None
    path = folder / f"{name}.toml"
    if path.exists():
        raise InputError(f"{path}: exists already; choose another name")
    text = _TEMPLATE.read_text(encoding="utf-8").replace("{name}", name)
    write_atomically(path, text.encode())
    return path
