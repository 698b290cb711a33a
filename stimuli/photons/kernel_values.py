"""Values on their way into Dr.Jit's kernels, and back."""

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from stimuli.shapes.mesh import Value


def opaque(vector: NDArray[np.floating[Any]]) -> list[Value]:
    """Return a vector as variables: a constant would make every value compile its own kernel."""
    return [dr.opaque(mi.Float, float(component)) for component in vector]


def random_numbers(count: int, seed: int) -> Value:
    """Return a generator of as many independent streams; seeds are 0 to 2^63."""
    generator: Value = mi.PCG32
    return generator(size=count, initstate=dr.opaque(mi.UInt64, seed))


def rows_of(vectors: Value) -> NDArray[np.float32]:
    """Return Dr.Jit's vectors as float32 `(n, 3)`."""
    return np.ascontiguousarray(np.array(vectors, np.float32).T)
