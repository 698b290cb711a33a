"""Tables that leave the store: tidy CSV, Parquet and JSON, safe to open in a spreadsheet."""

import csv
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final, Literal

from experiments.exports.data_dictionary import COLUMNS, Kind, described
from experiments.responses import Event, Session
from experiments.storage.arrivals import exported_parameters
from experiments.storage.participation import exclusion_reasons
from experiments.storage.store import Store

Table = Literal["responses", "sessions", "events"]
Form = Literal["csv", "json", "parquet"]
Row = Mapping[str, Any]

FORMS: Final[Mapping[Form, str]] = {
    "csv": "text/csv",
    "json": "application/json",
    "parquet": "application/vnd.apache.parquet",
}
"""The forms of a table, and how they are called on the web."""

# A spreadsheet would run a cell that begins with one of these as a formula: also the full-width
# ones, and also what comes after what another country's spreadsheet takes for the end of a cell.
_FORMULA: Final = re.compile(r"(^|[;,\t\r\n]\s*\"?)(?=[=+\-@\t\r\n\uff1d\uff0b\uff0d\uff20])")


def table_bytes(store: Store, table: Table, study: str | None = None, form: Form = "csv") -> bytes:
    """Return one of a store's tables as a file's content.

    Parameters
    ----------
    store
        The store.
    table
        Which of its tables; `experiments.exports.data_dictionary` tells what its columns mean.
    study
        The study whose rows are wanted, or None for all.
    form
        `csv`: one row an answer, session or event; lists joined by semicolons; texts that a
        spreadsheet would take for a formula begun with an apostrophe, numbers as they are;
        `parquet`: the same with types, texts unchanged; `json`: a list of objects, unchanged.
    """
    rows = table_rows(store, table, study)
    if form == "json":
        return json.dumps(rows, indent=1).encode() + b"\n"
    flat = tidy(table, rows)
    return csv_bytes(*flat) if form == "csv" else _parquet(table, *flat)


def table_rows(store: Store, table: Table, study: str | None = None) -> list[dict[str, Any]]:
    """Return a table's rows: all that the store knows of them, in the order of the store."""
    if table == "responses":
        return [dict(vars(row)) for row in store.responses(study=study)]
    sessions, events = store.sessions(study=study), store.events(study=study)
    if table == "sessions":
        came_by = exported_parameters(store, [one for one, _ in store.registered(study)])
        return [
            row | ({"recruitment": came_by[row["id"]]} if row["id"] in came_by else {})
            for row in session_rows(sessions, events)
        ]
    flags = {one.id: {"simulated": one.simulated, "pilot": one.pilot} for one in sessions}
    return [{**vars(event), **flags[event.session]} for event in events]


def session_rows(sessions: Sequence[Session], events: Iterable[Event]) -> list[dict[str, Any]]:
    """Return sessions with the reason for which the researcher excluded them, if so."""
    reasons = exclusion_reasons(events)
    return [{**vars(one), "exclusion_reason": reasons.get(one.id)} for one in sessions]


def tidy(table: Table, rows: Sequence[Row]) -> tuple[list[str], list[dict[str, Any]]]:
    """Return columns and rows without nesting: what participants said and had in columns.

    An event's detail, which differs from kind to kind, becomes one text of JSON.
    """
    flat = [_flat(row) for row in rows]
    known = list(COLUMNS[table])
    more = {name: None for row in flat for name in row if name not in COLUMNS[table]}
    return [*known, *more], flat


def csv_bytes(columns: Sequence[str], rows: Iterable[Row]) -> bytes:
    """Return rows as CSV that no spreadsheet runs."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([safe_cell(row.get(name)) for name in columns] for row in rows)
    return stream.getvalue().encode()


def safe_cell(value: object) -> object:
    """Return a value as a CSV cell that no spreadsheet takes for a formula.

    >>> safe_cell("=1+1"), safe_cell(-1.5), safe_cell(("a", "=b"))
    ("'=1+1", -1.5, "a;'=b")
    """
    if isinstance(value, list | tuple):
        value = ";".join(str(part) for part in value)
    return _FORMULA.sub(r"\1'", value) if isinstance(value, str) else value


def _flat(row: Row) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in row.items():
        if name in ("demographics", "screen", "recruitment"):
            flat |= {f"{name}_{key}": part for key, part in value.items()}
        else:
            flat[name] = json.dumps(value) if isinstance(value, Mapping) else value
    return flat


def _parquet(table: Table, columns: Sequence[str], rows: Sequence[Row]) -> bytes:
    import pyarrow as pa  # type: ignore[import-untyped]
    from pyarrow import parquet

    several = any(isinstance(row.get("answer"), tuple) for row in rows)
    types: dict[Kind, pa.DataType] = {
        "text": pa.string(),
        "time": pa.string(),
        "number": pa.float64(),
        "integer": pa.int64(),
        "boolean": pa.bool_(),
        "list": pa.list_(pa.string()),
        "answer": pa.list_(pa.int64()) if several else pa.int64(),
    }
    fields = [
        pa.field(
            name,
            types[column.kind],
            metadata={"description": column.description, "unit": column.unit or ""},
        )
        for name, column in zip(columns, described(table, columns), strict=True)
    ]
    arrays = [
        pa.array([_typed(row.get(field.name), field.type, pa) for row in rows], field.type)
        for field in fields
    ]
    stream = io.BytesIO()
    parquet.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), stream)
    return stream.getvalue()


def _typed(value: Any, wanted: Any, pa: Any) -> Any:  # noqa: ANN401  # pyarrow has no types
    if value is None:
        return None
    if pa.types.is_list(wanted):
        return list(value) if isinstance(value, list | tuple) else [value]
    if pa.types.is_string(wanted):
        return str(value)
    return float(value) if pa.types.is_floating(wanted) else value
