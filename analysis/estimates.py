"""What every result is made of: an estimate with its interval, and the way to JSON."""

import dataclasses
import json
import math
from collections.abc import Mapping
from importlib import metadata

import numpy as np
import pandas as pd

CONFIDENCE = 0.95
# The metadata of a field that a result computes with and nobody reads: it is not in the JSON.
INSIDE = {"inside": True}


@dataclasses.dataclass(frozen=True)
class Estimate:
    """A number and its 95 % interval.

    Attributes
    ----------
    value
        The point estimate; NaN where there is none.
    low, high
        The ends of the interval; NaN where there is none, infinite where the data set no bound.

    Examples
    --------
    >>> str(Estimate(25.04, 23.9, 26.31))
    '25.0 [23.9, 26.3]'
    """

    value: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.value:.1f} [{self.low:.1f}, {self.high:.1f}]"

    def columns(self, name: str) -> dict[str, float]:
        """Return the columns `name`, `name_low` and `name_high` of a table."""
        return {name: self.value, f"{name}_low": self.low, f"{name}_high": self.high}


def software_version() -> str:
    """Return the version of Trompe that computes, for results to carry."""
    try:
        return metadata.version("trompe")
    except metadata.PackageNotFoundError:  # run from a source tree
        return "source tree"


def seed_of(generator: np.random.Generator) -> int | None:
    """Return the seed that a generator, or the one it was spawned from, was made with."""
    sequence = generator.bit_generator.seed_seq
    entropy = getattr(sequence, "entropy", None)
    return entropy if isinstance(entropy, int) else None


def to_json(result: object) -> str:
    """Return a result as JSON: tables by row, null for numbers that are not finite."""
    return json.dumps(_plain(result), indent=1, allow_nan=False)


def _plain(value: object) -> object:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [f.name for f in dataclasses.fields(value) if f.metadata != INSIDE]
        return {name: _plain(getattr(value, name)) for name in fields}
    if isinstance(value, pd.DataFrame):
        return _plain(value.to_dict("records"))
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
