"""The record of an edit: a small JSON file from which it is repeated exactly.

It names the picture and all other inputs with their SHA-256, all settings, the result with its
SHA-256, and the versions of what made it. Files are named relative to the record.
"""

import json
import os
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

from algorithms.edits.before_after import before_after
from algorithms.edits.request import Edited, Request, perform
from algorithms.errors import InputError
from algorithms.files import sha256_of, write_atomically
from algorithms.images import MAX_PIXELS, write_image, write_picture

_SUFFIX: Final = ".json"
_LIBRARIES: Final = ("trompe", "numpy", "scipy", "scikit-image")
_KEYS: Final = {"edit", "image", "inputs", "parameters", "output", "versions"}


def run(request: Request, out: Path, *, compare: bool = True, max_pixels: int = MAX_PIXELS) -> Path:
    """Edit a picture, and write it, a picture of before and after, and the record.

    Parameters
    ----------
    request
        The edit.
    out
        The result: .png, .jpg, .hdr or .exr. The record has its name with .json for the suffix,
        and the comparison its name with `-before-after.png`.
    compare
        Whether to write the comparison.
    max_pixels
        Larger pictures are refused before decoding.

    Returns
    -------
    The record's path.

    Raises
    ------
    InputError
        If an input is not accepted, or a file cannot be written, or would replace an input.
    """
    record = out.with_suffix(_SUFFIX)
    comparison = out.with_name(f"{out.stem}-before-after.png")
    taken = {path.resolve() for path in (request.image, *request.inputs.values())}
    for path in (out, record, comparison):
        if path.resolve() in taken:
            raise InputError(f"out: {path} is an input; another file is accepted")
    edited = perform(request, max_pixels)
    _write(edited, out, comparison if compare else None)
    write_atomically(record, _described(request, out, record.parent))
    return record


def repeat(
    path: Path, out: Path | None = None, *, max_pixels: int = MAX_PIXELS
) -> tuple[Path, bool]:
    """Repeat a recorded edit.

    Parameters
    ----------
    path
        The record.
    out
        Where the result goes; None for where it went.
    max_pixels
        Larger pictures are refused before decoding.

    Returns
    -------
    The result's path, and whether its bytes are those of the recorded one.

    Raises
    ------
    InputError
        If the record is not one, or an input is missing or has changed since.
    """
    recorded = _read(path)
    folder = path.parent
    files = {"image": recorded["image"], **recorded["inputs"]}
    for name, file in files.items():
        if sha256_of(folder / file["file"]) != file["sha256"]:
            raise InputError(f"{name}: {file['file']} has changed since the edit was recorded")
    request = Request(
        edit=recorded["edit"],
        image=folder / recorded["image"]["file"],
        inputs={name: folder / file["file"] for name, file in recorded["inputs"].items()},
        parameters=recorded["parameters"],
    )
    target = folder / recorded["output"]["file"] if out is None else out
    _write(perform(request, max_pixels), target, None)
    return target, sha256_of(target) == recorded["output"]["sha256"]


def _write(edited: Edited, out: Path, comparison: Path | None) -> None:
    write_image(out, edited.after, edited.alpha)
    if comparison is not None:
        write_picture(comparison, before_after(edited.before, edited.after))


def _described(request: Request, out: Path, folder: Path) -> bytes:
    def file(path: Path) -> dict[str, str]:
        return {"file": Path(os.path.relpath(path, folder)).as_posix(), "sha256": sha256_of(path)}

    described = {
        "edit": request.edit,
        "image": file(request.image),
        "inputs": {name: file(path) for name, path in request.inputs.items()},
        "parameters": dict(request.parameters),
        "output": file(out),
        "versions": {library: version(library) for library in _LIBRARIES},
    }
    return (json.dumps(described, indent=1) + "\n").encode()


def _read(path: Path) -> dict[str, Any]:
    """Read a record and see that it has every part."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        recorded = json.loads(path.read_bytes())
        files = [recorded["image"], recorded["output"], *recorded["inputs"].values()]
        whole = recorded.keys() >= _KEYS and all({"file", "sha256"} <= f.keys() for f in files)
    except (ValueError, TypeError, KeyError, AttributeError):
        whole = False
    if not whole:
        raise InputError(f"{path}: not the record of an edit")
    described: dict[str, Any] = recorded
    return described
