"""Pattern search: minimising a function of a few numbers without its derivatives.

Hooke and Jeeves 1961, which Lopez-Moreno 2011 uses throughout sec. 3.6.2; no maintained library has
it. Only the comparison with the printed method needs it: a fit with derivatives is as accurate and
faster.
"""

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError

_MOST_ROUNDS: Final = 500


def pattern_search(
    function: Callable[[NDArray[np.float64]], float],
    start: ArrayLike,
    steps: ArrayLike,
    *,
    least_step: float = 1e-3,
) -> tuple[NDArray[np.float64], float]:
    """Find a local minimum.

    Parameters
    ----------
    function
        Of `(n,)` numbers.
    start
        `(n,)`: where to begin.
    steps
        `(n,)`: how far to reach in each number at first, more than 0.
    least_step
        The search ends when the steps are this share of the first ones, in 0..1.

    Returns
    -------
    The place, and the function's value there.

    Raises
    ------
    InputError
        If the steps or the least one are not as described.

    Notes
    -----
    Each round explores one number after the other; after a success it leaps on by the same way, and
    after a failure it halves the steps. It gives up in a valley that leads on for 500 rounds.

    Examples
    --------
    >>> place, value = pattern_search(lambda x: float(((x - 3) ** 2).sum()), [0.0], [1.0])
    >>> place.round(2).tolist()
    [3.0]
    """
    base, reach = np.array(start, dtype=np.float64), np.array(steps, dtype=np.float64)
    if reach.shape != base.shape or not (reach > 0).all():
        raise InputError("steps: one of more than 0 for each number of start is accepted")
    if not 0 < least_step < 1:
        raise InputError(f"least_step: {least_step} given, more than 0 and less than 1 accepted")
    lowest, smallest = function(base), reach * least_step
    leap, at_leap = base, lowest
    for _ in range(_MOST_ROUNDS):
        moved, value = _explored(function, leap, at_leap, reach)
        if value < lowest:
            leap = 2 * moved - base
            base, lowest, at_leap = moved, value, function(leap)
            continue
        if leap is base:  # nothing lower is in reach
            reach = reach / 2
            if (reach < smallest).all():
                break
        leap, at_leap = base, lowest
    return base, float(lowest)


def _explored(
    function: Callable[[NDArray[np.float64]], float],
    place: NDArray[np.float64],
    value: float,
    reach: NDArray[np.float64],
) -> tuple[NDArray[Any], float]:
    """Try a step either way in each number, and keep what is lower."""
    place = place.copy()
    for index in range(place.size):
        for side in (1, -1):
            tried = place.copy()
            tried[index] += side * reach[index]
            tried_value = function(tried)
            if tried_value < value:
                place, value = tried, tried_value
                break
    return place, value
