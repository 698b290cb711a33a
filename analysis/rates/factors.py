"""The factors of a regression: what can be told of each, and the columns that stand for it."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from algorithms.errors import InputError
from analysis.rates.clustered_regression import Floats

_RANK_TOLERANCE = 1e-8


@dataclass(frozen=True)
class Factor:
    """A factor and the columns of the design that stand for it.

    Attributes
    ----------
    name
        The table's column.
    numeric
        Whether it has one column, which is 0 at its lowest and 1 at its highest value; else it
        has a column for each value but the first, the reference.
    within
        Whether it varies within participants; else each has one value of it.
    kinds
        The values in their order; for a numeric factor the lowest and the highest.
    first
        The first of its columns.
    step
        Of a numeric factor, a round number (1, 2 or 5 times a power of ten) of a tenth of its
        range or more, and no less than the smallest difference of two values: effects are per
        step.
    """

    name: str
    numeric: bool
    within: bool
    kinds: tuple[object, ...]
    first: int
    step: float = float("nan")

    @property
    def columns(self) -> range:
        """The factor's columns."""
        return range(self.first, self.first + len(self.kinds) - 1)


@dataclass(frozen=True, eq=False)
class Design:
    """What a regression on some factors starts from.

    Attributes
    ----------
    rows
        The rows of the table that it uses.
    matrix
        Shape (n, p); the first column is 1.
    factors
        Those that can be estimated.
    left_out
        Why other factors, or some participants, are not in it, by factor.
    """

    rows: pd.DataFrame
    matrix: Floats
    factors: tuple[Factor, ...]
    left_out: dict[str, str] = field(default_factory=dict)

    @property
    def cluster(self) -> NDArray[np.intp]:
        """The number of each row's participant."""
        return np.asarray(pd.factorize(self.rows["participant"])[0], dtype=np.intp)


def design_of(table: pd.DataFrame, names: Sequence[str], response: str, binary: bool) -> Design:
    """Make the design of a regression with main effects of some factors.

    Parameters
    ----------
    table
        One row an answer, with `participant`, the factors and the response; none of the last is
        missing. Numeric factors are linear, all others categorical.
    names
        The factors.
    response
        The column that is regressed.
    binary
        Whether it is true or false: a value for which all answers are alike has no odds.

    Raises
    ------
    InputError
        If a factor is unknown, there are fewer than two participants, or no factor is left.
    """
    check_factors(table, names)
    rows, kept = table, list(dict.fromkeys(names))
    left_out: dict[str, str] = {}
    changed = True
    while changed:  # leaving participants out can leave a factor with a single value
        changed = False
        _check_participants(rows)
        for name in list(kept):
            why = _useless(rows, name, response, binary)
            people, unfit = _unfit(rows, name)
            if why is not None:
                kept.remove(name)
            elif people:
                rows, why = rows[~rows["participant"].isin(people)], unfit
            if why is not None:
                before = f"{left_out[name]}; " if name in left_out else ""
                left_out[name] = before + why
                changed = True
    return _with_columns(rows, kept, left_out)


def check_factors(table: pd.DataFrame, names: Sequence[str]) -> None:
    """Refuse names that are no columns, and columns with infinite values.

    Raises
    ------
    InputError
        Naming the factor.
    """
    if isinstance(names, str) or not names:
        raise InputError(f"factors: {names!r} given, the names of one or more columns accepted")
    for name in names:
        if name not in table.columns:
            raise InputError(f"factors: {name!r} given, columns of the table accepted")
        if is_numeric(table[name]) and np.isinf(table[name].to_numpy(float, na_value=np.nan)).any():
            raise InputError(f"factors: {name} has infinite values, finite ones accepted")


def _check_participants(rows: pd.DataFrame) -> None:
    participants = rows["participant"].nunique()
    if participants < 2:
        raise InputError(f"participants: {participants} left to compare, two or more accepted")


def _useless(rows: pd.DataFrame, name: str, response: str, binary: bool) -> str | None:
    """Return why nothing can be told of a factor, or None."""
    known = rows[rows[name].notna()]
    if known.empty:
        return "unknown for all participants"
    values = known.groupby(name, observed=True)
    if values.ngroups < 2:
        return f"only one value, {next(iter(values.groups))}"
    if is_numeric(rows[name]):
        return None
    people = values["participant"].nunique()
    if varies_within(known, name) and people.min() < 2:
        return f"{people.idxmin()}: answered by one participant"
    if (people > 1).sum() < 2:
        return "fewer than two groups of two participants or more"
    if binary:
        for value, share in values[response].mean().items():
            if share in (0, 1):
                return f"all answers are {'right' if share else 'wrong'} at {value}: no odds exist"
    return None


def _unfit(rows: pd.DataFrame, name: str) -> tuple[set[object], str]:
    """Return the participants of whom a factor's value is unknown or nobody else's, and why."""
    missing = set(rows.loc[rows[name].isna(), "participant"])
    if missing:
        number = "one participant" if len(missing) == 1 else f"{len(missing)} participants"
        return missing, f"unknown for {number}, left out"
    if not is_numeric(rows[name]) and not varies_within(rows, name):
        for value, people in rows.groupby(name, observed=True)["participant"].unique().items():
            if len(people) < 2:
                return set(people), f"{value}: one participant, left out"
    return set(), ""


def is_numeric(values: pd.Series) -> bool:
    """Return whether a factor is linear: numbers that are no categories and not true or false."""
    return pd.api.types.is_numeric_dtype(values) and not pd.api.types.is_bool_dtype(values)


def varies_within(rows: pd.DataFrame, name: str) -> bool:
    """Return whether any participant has more than one value of a factor."""
    pairs = rows[["participant", name]].drop_duplicates()
    return bool(pairs["participant"].duplicated().any())


def _with_columns(rows: pd.DataFrame, names: list[str], left_out: dict[str, str]) -> Design:
    columns, factors = [np.ones(len(rows))], []
    for name in names:
        values, own = _columns(rows[name])
        if not _independent(columns, own):
            left_out[name] = "cannot be told from the factors before it"
            continue
        numeric, within = is_numeric(rows[name]), varies_within(rows, name)
        step = _step(rows[name].to_numpy(float)) if numeric else float("nan")
        factors.append(Factor(name, numeric, within, values, len(columns), step))
        columns.extend(own)
    if not factors:
        reasons = "; ".join(f"{name}: {why}" for name, why in left_out.items())
        raise InputError(f"factors: none can be estimated ({reasons})")
    return Design(rows, np.column_stack(columns), tuple(factors), left_out)


def _columns(values: pd.Series) -> tuple[tuple[object, ...], list[Floats]]:
    """Return a factor's values and the columns that stand for them."""
    if is_numeric(values):
        numbers = values.to_numpy(float)
        low, high = float(numbers.min()), float(numbers.max())
        return (low, high), [(numbers - low) / (high - low)]
    if isinstance(values.dtype, pd.CategoricalDtype):
        present = set(values.unique())
        kinds = [value for value in values.cat.categories if value in present]
    else:
        kinds = sorted(values.unique())
    return tuple(kinds), [(values == kind).to_numpy(float) for kind in kinds[1:]]


def _step(values: Floats) -> float:
    different = np.unique(values)
    least = max(float(np.diff(different).min()), float(np.ptp(different)) / 10)
    power = 10.0 ** np.floor(np.log10(least))
    # A little tolerance: a tenth of a range may miss a round number by rounding alone.
    return float(next(m for m in (1, 2, 5, 10) if m * power >= least * (1 - 1e-9)) * power)


def _independent(columns: list[Floats], added: list[Floats]) -> bool:
    every = np.column_stack([*columns, *added])
    products = every.T @ every / len(every)
    size = np.linalg.eigvalsh(products)
    return bool(size[0] > _RANK_TOLERANCE * size[-1])
