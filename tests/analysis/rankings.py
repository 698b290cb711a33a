"""Published rankings that several tests use."""

import numpy as np
from scipy import stats

# Hollander and Wolfe 1973, p. 140: seconds of 22 base runners by three ways of rounding first base.
_ROUNDING_FIRST_BASE = """
5.40 5.50 5.55  5.85 5.70 5.75  5.20 5.60 5.50  5.55 5.50 5.40  5.90 5.85 5.70  5.45 5.55 5.60
5.40 5.40 5.35  5.45 5.50 5.35  5.25 5.15 5.00  5.85 5.80 5.70  5.25 5.20 5.10  5.65 5.55 5.45
5.60 5.35 5.45  5.05 5.00 4.95  5.50 5.50 5.40  5.45 5.55 5.50  5.55 5.55 5.35  5.45 5.50 5.55
5.50 5.45 5.25  5.65 5.60 5.40  5.70 5.65 5.55  6.30 6.30 6.25
"""
# Sachs 1997, p. 675: six diuretics (columns) given to six persons (rows).
_DIURETICS = """
3.88 30.58 25.24 4.44 29.41 38.87  5.64 30.14 33.52 7.94 30.72 33.12
5.76 16.92 25.45 4.04 32.92 39.15  4.25 23.19 18.85 4.40 28.23 28.06
5.91 26.74 20.45 4.23 23.35 38.23  4.33 10.91 26.67 4.36 12.00 26.65
"""


def ranks_of(text: str, items: int) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Rank each row of a text of measurements, tied ones by their mean."""
    values = np.array(text.split(), dtype=float).reshape(-1, items)
    return np.asarray(stats.rankdata(values, axis=1), dtype=float)


RUNNERS = ranks_of(_ROUNDING_FIRST_BASE, 3)
DIURETICS = ranks_of(_DIURETICS, 6)
