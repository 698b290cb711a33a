"""Tables that leave the store, safe to open in a spreadsheet."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Literal

from experiments.responses import Event, Response, Session
from experiments.store import Store

Table = Literal["responses", "sessions", "events"]
Form = Literal["csv", "json"]
Row = Response | Session | Event

_ROW_OF: Mapping[Table, type[Row]] = {
    "responses": Response,
    "sessions": Session,
    "events": Event,
}

# A spreadsheet would run a cell that begins with one of these as a formula.
_FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r")


def table_text(store: Store, table: Table, study: str | None = None, form: Form = "csv") -> str:
    """Return one of a store's tables as text.

    Parameters
    ----------
    store
        The store.
    table
        Which of its tables.
    study
        The study whose rows are wanted, or None for all.
    form
        `csv`: lists joined by semicolons, texts that a spreadsheet would take for a formula
        begun with an apostrophe, numbers as they are; `json`: a list of objects.
    """
    rows: Sequence[Row]
    match table:
        case "responses":
            rows = store.responses(study=study)
        case "sessions":
            rows = store.sessions(study=study)
        case "events":
            rows = store.events(study=study)
    if form == "json":
        return json.dumps([vars(row) for row in rows], indent=1) + "\n"
    columns = [field.name for field in fields(_ROW_OF[table])]
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([safe_cell(getattr(row, name)) for name in columns] for row in rows)
    return stream.getvalue()


def safe_cell(value: object) -> object:
    """Return a value as a CSV cell that no spreadsheet takes for a formula.

    >>> safe_cell("=1+1"), safe_cell(-1.5), safe_cell(("a", "b"))
    ("'=1+1", -1.5, 'a;b')
    """
    if isinstance(value, Mapping):
        value = ";".join(f"{key}={part}" for key, part in value.items())
    if isinstance(value, list | tuple):
        value = ";".join(str(part) for part in value)
    if isinstance(value, str) and value.startswith(_FORMULA_STARTS):
        return f"'{value}"
    return value
