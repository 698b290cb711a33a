"""Several tests at once: the family they form, and their p-values corrected by Holm's method."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError
from analysis.estimates import software_version


@dataclass(frozen=True)
class Family:
    """Tests that are judged together, each with its raw and its corrected p-value.

    Attributes
    ----------
    name
        What the tests have in common, such as `hit rate by factor`.
    table
        One row a test: `test`, `p_value`, `p_holm`; both NaN where nothing could be tested.
    size
        The number of tests that were made.
    method, version
        The correction, and by which Trompe.
    """

    name: str
    table: pd.DataFrame
    size: int
    method: str = "Holm's step-down method"
    version: str = ""

    def to_frame(self) -> pd.DataFrame:
        """Return the table, each row with the family's name and size."""
        return self.table.assign(family=self.name, family_size=self.size)


def family(name: str, p_values: Mapping[str, float]) -> Family:
    """Return a family of tests with their corrected p-values.

    Parameters
    ----------
    name
        What the tests have in common.
    p_values
        Each test's p-value by its name; NaN for a test that could not be made.

    Raises
    ------
    InputError
        If there is no test, or a p-value is none.

    Examples
    --------
    >>> family("effects", {"placement": 0.01, "material": 0.04}).table["p_holm"].tolist()
    [0.02, 0.04]
    """
    if not p_values:
        raise InputError("p_values: none given, a family of one test or more accepted")
    raw = np.array(list(p_values.values()), dtype=float)
    table = pd.DataFrame({"test": list(p_values), "p_value": raw, "p_holm": holm(raw)})
    return Family(name, table, int(np.isfinite(raw).sum()), version=software_version())


def holm(p_values: ArrayLike) -> NDArray[np.float64]:
    """Return p-values corrected so that all tests together keep the significance of one.

    Parameters
    ----------
    p_values
        Shape (n,), 0 to 1; a NaN is a test that was not made: it stays NaN and does not count.

    Returns
    -------
    numpy.ndarray
        Shape (n,): compared with alpha, they reject a true hypothesis among the n with a
        probability of at most alpha, however the tests depend on each other.

    Raises
    ------
    InputError
        If the shape or a value is impossible.

    Notes
    -----
    Holm 1979, Scandinavian Journal of Statistics 6: the k-th smallest of n is multiplied by
    ``n - k + 1``, and none becomes smaller than one before it.

    Examples
    --------
    >>> holm([0.01, 0.04, 0.03]).tolist()
    [0.03, 0.06, 0.06]
    """
    raw = np.asarray(p_values, dtype=float)
    if raw.ndim != 1:
        raise InputError(f"p_values: shape {raw.shape} given, (n,) accepted")
    made = np.flatnonzero(~np.isnan(raw))
    if np.any((raw[made] < 0) | (raw[made] > 1)):
        raise InputError("p_values: a value outside 0 to 1 given")
    rising = made[np.argsort(raw[made], kind="stable")]
    factors = np.arange(rising.size, 0, -1)
    corrected = np.full(raw.shape, np.nan)
    corrected[rising] = np.minimum(np.maximum.accumulate(factors * raw[rising]), 1.0)
    return corrected
