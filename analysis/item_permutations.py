"""The other null hypothesis: items alike to the group, while each observer may have an order.

Kendall's and David's tests ask whether answers are coins. Observers who are each consistent, but
in orders that have nothing in common, are not coins: their scores spread wider. Shuffling the
items' names within each observer keeps what an observer's choices look like and breaks only what
observers share (Pitman 1938). Observers stay whole, also where they answered several sets.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from analysis.pair_data import Tournaments

PERMUTATIONS = 10_000
_NUMBERS_AT_ONCE = 4_000_000


def permuted_choices(
    choices: Tournaments,
    generator: np.random.Generator,
    permutations: int,
    observers: Sequence[object] | None = None,
) -> Iterator[NDArray[np.int64]]:
    """Yield tournaments with the items shuffled within each observer, some at a time.

    Parameters
    ----------
    choices
        Shape (n, t, t).
    generator
        Shuffles.
    permutations
        How many times, 1 or more.
    observers
        Who made each of the n tournaments: those of one observer are shuffled alike. None: all
        are of different observers.

    Yields
    ------
    numpy.ndarray
        Shape (some, n, t, t).

    Raises
    ------
    InputError
        If `observers` has not one entry for each tournament, or `permutations` is not positive.
    """
    if permutations < 1:
        raise InputError(f"permutations: {permutations} given, 1 or more accepted")
    number, items = choices.shape[:2]
    who = observer_numbers(observers, number)
    at_once = max(1, _NUMBERS_AT_ONCE // choices.size)
    for start in range(0, permutations, at_once):
        some = min(at_once, permutations - start)
        order = np.argsort(generator.random((some, int(who.max()) + 1, items)), axis=-1)[:, who]
        tournament = np.arange(number)[:, None, None]
        yield choices[tournament, order[..., :, None], order[..., None, :]]


def observer_numbers(observers: Sequence[object] | None, number: int) -> NDArray[np.int64]:
    """Return the number of the observer of each tournament, from 0."""
    if observers is None:
        return np.arange(number)
    if len(observers) != number:
        raise InputError(
            f"observers: {len(observers)} given, one for each of {number} tournaments accepted"
        )
    place = {name: k for k, name in enumerate(dict.fromkeys(observers))}
    return np.array([place[name] for name in observers])


def monte_carlo_p_value(as_extreme: int, repetitions: int) -> float:
    """Return a p-value that counts what was observed among the shuffles: it is never 0."""
    return (as_extreme + 1) / (repetitions + 1)
