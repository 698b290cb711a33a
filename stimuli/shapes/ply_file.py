"""PLY, the Stanford triangle format: a header that declares tables, then text or binary numbers."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from stimuli.shapes.polygons import Polygons, check_count, fans

_TYPES: Final = (
    {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4"}
    | {"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4"}
    | {"float": "f4", "double": "f8", "float32": "f4", "float64": "f8"}
)
_ORDERS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_HEADER_LIMIT: Final = 1 << 16
_LONGEST_LIST: Final = 64
_CORNERS: Final = ("vertex_indices", "vertex_index")
_COORDINATES: Final = (("u", "v"), ("s", "t"), ("texture_u", "texture_v"))

Table = dict[str, tuple[NDArray[Any], NDArray[Any] | None]]
"""By property: the values of all rows, and for a list the number of them in each row."""


@dataclass
class _Element:
    name: str
    count: int
    properties: list[tuple[str, str, str | None]] = field(default_factory=list)  # name, type, count


class _Numbers:
    """The numbers after the header, taken one after the other."""

    def __init__(self, body: bytes, order: str) -> None:
        self._order = order
        self.place = 0
        if order:
            self._data: NDArray[Any] = np.frombuffer(body, dtype=np.uint8)
            return
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # what is no number ends the text
            try:
                self._data = np.fromstring(body.decode("latin-1"), dtype=np.float64, sep=" ")
            except DeprecationWarning as error:
                raise ValueError(str(error)) from error

    def columns(self, types: Sequence[str], count: int) -> list[NDArray[Any]]:
        """Return the columns of the next `count` rows of numbers of these types."""
        if not self._order:
            rows = self._next(count * len(types)).reshape(count, len(types))
            return list(rows.T)
        row = np.dtype([(str(i), self._order + kind) for i, kind in enumerate(types)])
        table = self._next(count * row.itemsize).view(row)
        return [table[str(i)] for i in range(len(types))]

    def _next(self, count: int) -> NDArray[Any]:
        if self.place + count > len(self._data):
            raise InputError("the file is shorter than its header says")
        self.place += count
        return self._data[self.place - count : self.place]


def parse_ply(content: bytes) -> Polygons:
    """Return the polygons of a PLY file, ascii or binary.

    Raises
    ------
    InputError
        If the header or the data are damaged, or there are too many.
    """
    order, elements, body = _header(content)
    try:
        numbers = _Numbers(body, order)
        tables = {element.name: _table(numbers, element) for element in elements}
        return _polygons(tables.get("vertex", {}), tables.get("face", {}))
    except InputError:
        raise
    except (ValueError, OverflowError) as error:
        raise InputError("the data are not the numbers that the header declares") from error


def _header(content: bytes) -> tuple[str, list[_Element], bytes]:
    end = content.find(b"end_header", 0, _HEADER_LIMIT)
    start = content.find(b"\n", end) + 1
    if not content.startswith(b"ply") or end < 0 or not start:
        raise InputError("not a PLY file")
    order, elements = None, list[_Element]()
    for line in content[:end].decode("latin-1").splitlines()[1:]:
        match line.split():
            case ["format", name, "1.0"] if name in _ORDERS:
                order = _ORDERS[name]
            case ["element", name, count] if count.isdecimal():
                check_count(name, int(count))
                elements.append(_Element(name, int(count)))
            case ["property", "list", length, kind, name] if elements and _known(length, kind):
                elements[-1].properties.append((name, _TYPES[kind], _TYPES[length]))
            case ["property", kind, name] if elements and _known(kind):
                elements[-1].properties.append((name, _TYPES[kind], None))
            case ["comment" | "obj_info", *_] | []:
                pass
            case _:
                raise InputError(f"the header's line {line.strip()[:60]!r} is not PLY 1.0")
    if order is None:
        raise InputError("the header names no format of PLY 1.0")
    return order, elements, content[start:]


def _known(*kinds: str) -> bool:
    return all(kind in _TYPES for kind in kinds)


def _table(numbers: _Numbers, element: _Element) -> Table:
    """Return an element's table, quickly where each list is as long as in the first row."""
    start = numbers.place
    first = _row_by_row(numbers, element, min(1, element.count))
    lengths = {name: int(count.sum()) for name, (_, count) in first.items() if count is not None}
    if max(lengths.values(), default=0) <= _LONGEST_LIST:
        numbers.place = start
        try:
            return _rows_alike(numbers, element, lengths)
        except InputError:
            if not lengths:
                raise
    numbers.place = start
    return _row_by_row(numbers, element, element.count)


def _rows_alike(numbers: _Numbers, element: _Element, lengths: dict[str, int]) -> Table:
    types = list[str]()
    for name, kind, count_kind in element.properties:
        types += [kind] if count_kind is None else [count_kind, *[kind] * lengths[name]]
    columns = iter(numbers.columns(types, element.count))
    table: Table = {}
    for name, _, count_kind in element.properties:
        column = next(columns)
        if count_kind is None:
            table[name] = column, None
            continue
        if (column != lengths[name]).any():
            raise InputError("lists: some are longer than the first")
        values = [next(columns) for _ in range(lengths[name])]
        table[name] = np.stack(values, axis=1).reshape(-1) if values else column[:0], column
    return table


def _row_by_row(numbers: _Numbers, element: _Element, count: int) -> Table:
    parts: dict[str, list[NDArray[Any]]] = {name: [] for name, _, _ in element.properties}
    counts: dict[str, list[int]] = {name: [] for name, _, _ in element.properties}
    for _ in range(count):
        for name, kind, count_kind in element.properties:
            length = 1
            if count_kind is not None:
                length = int(numbers.columns([count_kind], 1)[0][0])
                if length < 0:
                    raise InputError("lists: lengths of 0 or more are accepted")
                counts[name].append(length)
            parts[name].append(numbers.columns([kind], length)[0])
    return {
        name: (
            np.concatenate(parts[name]) if parts[name] else np.zeros(0),
            None if count_kind is None else np.array(counts[name], dtype=np.int64),
        )
        for name, _, count_kind in element.properties
    }


def _polygons(vertex: Table, face: Table) -> Polygons:
    vertices = _stacked(vertex, ("x", "y", "z"))
    if vertices is None:
        raise InputError("a vertex element with x, y and z is accepted")
    corners, counts = next((face[name] for name in _CORNERS if name in face), (np.zeros(0), None))
    if counts is None:
        raise InputError("a face element with a list vertex_indices is accepted")
    # Before they become whole numbers: text may hold anything.
    if not ((corners >= 0) & (corners < len(vertices)) & (corners % 1 == 0)).all():
        raise InputError(f"faces: indices of the {len(vertices)} vertices are accepted")
    coordinates = (_stacked(vertex, names) for names in _COORDINATES)
    return Polygons(
        vertices,
        fans(corners, counts.astype(np.int64)),
        normals=_stacked(vertex, ("nx", "ny", "nz")),
        texture_coordinates=next((found for found in coordinates if found is not None), None),
    )


def _stacked(table: Table, names: Sequence[str]) -> NDArray[np.float64] | None:
    if not all(name in table and table[name][1] is None for name in names):
        return None
    return np.stack([table[name][0].astype(np.float64) for name in names], axis=1)
