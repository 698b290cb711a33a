"""Wavefront OBJ: vertices, normals, texture coordinates and polygons by lines of text."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.shapes.polygons import Polygons, check_count, fans

_LENGTHS: Final = {b"v": 3, b"vt": 2, b"vn": 3}


def parse_obj(content: bytes) -> Polygons:
    """Return the polygons of an OBJ file; groups and materials are passed over.

    Raises
    ------
    InputError
        If a line of a vertex or a face is damaged, an index is out of range, or there are too many.
    """
    lists: dict[bytes, list[list[float]]] = {key: [] for key in _LENGTHS}
    corners: list[tuple[int, int, int]] = []
    counts: list[int] = []
    for number, line in enumerate(content.replace(b"\\\n", b" ").split(b"\n"), start=1):
        key, *values = line.split() or [b""]
        try:
            if key in lists:
                lists[key].append([float(value) for value in values[: _LENGTHS[key]]])
                if len(lists[key][-1]) < _LENGTHS[key]:
                    raise ValueError(key)
            elif key == b"f":
                sizes = (len(lists[b"v"]), len(lists[b"vt"]), len(lists[b"vn"]))
                corners += [_corner(value, sizes) for value in values]
                counts.append(len(values))
                check_count("faces", len(corners) - 2 * len(counts))
        except ValueError as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"line {number}: damaged") from error
    return _joined(lists, np.array(corners, dtype=np.int64).reshape(-1, 3), np.array(counts, int))


def _corner(value: bytes, sizes: tuple[int, int, int]) -> tuple[int, int, int]:
    """Return a corner's three indices from 0, -1 where there is none."""
    parts = value.split(b"/")
    if len(parts) > 3 or not parts[0]:
        raise ValueError(value)
    # Indices count from 1, and from behind where they are negative.
    wanted = [int(part) if part else None for part in [*parts, *[b""] * (3 - len(parts))]]
    found = [
        -1 if index is None else index - 1 if index > 0 else size + index
        for index, size in zip(wanted, sizes, strict=True)
    ]
    if any(
        index is not None and not 0 <= place < size
        for index, place, size in zip(wanted, found, sizes, strict=True)
    ):
        raise InputError(f"faces: indices of vertices above them are accepted, not {value!r}")
    return found[0], found[1], found[2]


def _joined(
    lists: dict[bytes, list[list[float]]], corners: NDArray[np.int64], counts: NDArray[np.int64]
) -> Polygons:
    """Give each combination of position, coordinates and normal that a face uses a vertex."""
    used, number = np.unique(corners, axis=0, return_inverse=True)
    faces = fans(number.reshape(-1), counts)
    values = [
        None
        if not len(used) or (used[:, column] < 0).any()
        else np.array(lists[key], dtype=np.float64)[used[:, column]]
        for column, key in enumerate(_LENGTHS)
    ]
    vertices = np.zeros((0, 3)) if values[0] is None else values[0]
    return Polygons(vertices, faces, normals=values[2], texture_coordinates=values[1])
