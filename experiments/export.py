"""Tables that leave the store, safe to open in a spreadsheet."""

from collections.abc import Mapping

import pandas as pd

# A spreadsheet would run a cell that begins with one of these as a formula.
_FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r")


def table_csv(table: pd.DataFrame) -> str:
    r"""Return a table as CSV: lists joined by semicolons, texts that look like formulas quoted.

    Numbers stay as they are, negative ones too.

    >>> table_csv(pd.DataFrame({"device": ["=1+1"], "shown": [("a", "b")], "time_s": [-1.5]}))
    "device,shown,time_s\n'=1+1,a;b,-1.5\n"
    """
    return table.map(_cell).to_csv(index=False, lineterminator="\n")


def _cell(value: object) -> object:
    if isinstance(value, list | tuple):
        value = ";".join(str(part) for part in value)
    if isinstance(value, Mapping):
        value = "; ".join(f"{key}={part}" for key, part in value.items())
    if isinstance(value, str) and value.startswith(_FORMULA_STARTS):
        return f"'{value}"
    return value
