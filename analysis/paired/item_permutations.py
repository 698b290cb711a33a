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
from analysis.paired.pair_data import Tournaments

PERMUTATIONS = 10_000
_NUMBERS_AT_ONCE = 4_000_000
_FEWEST, _MOST_NUMBERS = 999, 1_000_000_000


def enough_permutations(wins: Tournaments) -> int:
    """Return how many shuffles take seconds: 10,000, or down to 999 where answers are very many."""
    return int(np.clip(_MOST_NUMBERS // max(1, wins.size), _FEWEST, PERMUTATIONS))


def permuted_pair_wins(
    conditions: Tournaments, generator: np.random.Generator, permutations: int
) -> Iterator[NDArray[np.int64]]:
    """Yield the wins of the first of each pair of items, the items shuffled within each observer.

    Parameters
    ----------
    conditions
        Shape (c, n, t, t): the same n observers in c conditions, shuffled alike in all of them.
    generator
        Shuffles.
    permutations
        How many times, 1 or more.

    Yields
    ------
    numpy.ndarray
        Shape (some, c, pairs).

    Raises
    ------
    InputError
        If `permutations` is not positive.
    """
    _check_permutations(permutations)
    _, observers, items = conditions.shape[:3]
    first, second = np.triu_indices(items, k=1)
    wins = conditions.astype(np.int8)
    who = np.arange(observers)[:, None]
    at_once = max(1, _NUMBERS_AT_ONCE // (observers * items**2))
    for start in range(0, permutations, at_once):
        keys = generator.random(
            (min(at_once, permutations - start), observers, items), dtype=np.float32
        )
        order = np.argsort(keys, axis=-1)
        one, other = order[..., first], order[..., second]
        shuffled = [own[who, one, other].sum(axis=1, dtype=np.int64) for own in wins]
        yield np.stack(shuffled, axis=1)


def permuted_scores(
    choices: Tournaments,
    generator: np.random.Generator,
    permutations: int,
    observers: Sequence[object] | None = None,
) -> Iterator[NDArray[np.int64]]:
    """Yield the items' scores with the items shuffled within each observer, some at a time.

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
        Shape (some, t).

    Raises
    ------
    InputError
        If `observers` has not one entry for each tournament, or `permutations` is not positive.
    """
    _check_permutations(permutations)
    who = observer_numbers(observers, len(choices))
    own = np.zeros((int(who.max()) + 1, choices.shape[1]), dtype=np.int64)
    np.add.at(own, who, choices.sum(axis=2))
    at_once = max(1, _NUMBERS_AT_ONCE // own.size)
    for start in range(0, permutations, at_once):
        some = min(at_once, permutations - start)
        yield generator.permuted(np.tile(own, (some, 1, 1)), axis=-1).sum(axis=1)


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


def _check_permutations(permutations: int) -> None:
    if permutations < 1:
        raise InputError(f"permutations: {permutations} given, 1 or more accepted")


def monte_carlo_p_value(as_extreme: int, repetitions: int) -> float:
    """Return a p-value that counts what was observed among the shuffles: it is never 0."""
    return (as_extreme + 1) / (repetitions + 1)
