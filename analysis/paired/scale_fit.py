"""Maximum likelihood of Bradley-Terry and Thurstone V for many win counts at once.

Both say that item i is preferred to item j with probability F(value_i - value_j). F is the logistic
function (Bradley and Terry 1952) or the cumulative normal one (Thurstone 1927, case V). The
likelihood is concave, so that Fisher scoring with halved steps finds its maximum where there is
one: where every item can be reached from every other along wins (Ford 1957).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csgraph
from scipy.special import expit, log_expit, log_ndtr, ndtr, ndtri

from algorithms.errors import InputError
from analysis.bootstrap import Matrix

ModelName = Literal["bradley-terry", "thurstone"]
_PREFERRED_AT_ONE_JOD = 0.75
_LARGEST_STEP = 1e-9
_MOST_STEPS = 100
_MOST_HALVINGS = 30


@dataclass(frozen=True)
class Model:
    """How a difference of values becomes a probability.

    Attributes
    ----------
    title
        As results name it.
    unit
        The difference at which 75 % prefer the better item: one just-objectionable difference.
    probability, density, log_probability
        F, its derivative and its logarithm.
    """

    title: str
    unit: float
    probability: Callable[[Matrix], Matrix]
    density: Callable[[Matrix], Matrix]
    log_probability: Callable[[Matrix], Matrix]


def _normal_density(difference: Matrix) -> Matrix:
    return np.asarray(np.exp(-(difference**2) / 2) / np.sqrt(2 * np.pi))


def _logistic_density(difference: Matrix) -> Matrix:
    return np.asarray(expit(difference) * expit(-difference))


MODELS: dict[ModelName, Model] = {
    "bradley-terry": Model("Bradley-Terry", float(np.log(3)), expit, _logistic_density, log_expit),
    "thurstone": Model(
        "Thurstone V", float(ndtri(_PREFERRED_AT_ONE_JOD)), ndtr, _normal_density, log_ndtr
    ),
}


def has_maximum(wins: Matrix) -> NDArray[np.bool_]:
    """Return where the likelihood has a maximum: every item reachable from every other by wins.

    Parameters
    ----------
    wins
        Win counts, shape (..., t, t).
    """
    items = wins.shape[-1]
    reach = (wins > 0) | np.eye(items, dtype=bool)
    for _ in range(max(items - 1, 1).bit_length()):
        reach = (reach.astype(np.float32) @ reach.astype(np.float32)) > 0
    return np.asarray(reach.all(axis=(-2, -1)))


def check_finite(counts: Matrix, items: Sequence[str]) -> None:
    """Refuse win counts without a finite scale, saying which items are to blame.

    Parameters
    ----------
    counts
        Shape (t, t).
    items
        Their names.

    Raises
    ------
    InputError
        If items were never compared, even by way of others, or some beat the others every time
        (Ford 1957, American Mathematical Monthly 64).
    """
    connected, part = csgraph.connected_components(counts > 0, connection="weak")
    if connected > 1:
        sets = [_listed(items, part == number) for number in range(connected)]
        raise InputError(
            f"wins: the sets of items {' | '.join(sets)} were never compared with each other,"
            " a chain of comparisons between all accepted (or prior > 0)"
        )
    parts, part = csgraph.connected_components(counts > 0, connection="strong")
    if parts == 1:
        return
    never_lost = next(k for k in range(parts) if not counts[np.ix_(part != k, part == k)].any())
    better = part == never_lost
    best, rest = _listed(items, better), _listed(items, ~better)
    if better.sum() == 1:
        what = f"item {best} won every comparison"
    elif (~better).sum() == 1:
        what = f"item {rest} lost every comparison"
    else:
        what = f"items {best} won every comparison with {rest}"
    raise InputError(
        f"wins: {what}, so that no finite scale exists; a win each way accepted (or prior > 0)"
    )


def _listed(items: Sequence[str], chosen: ArrayLike) -> str:
    return ", ".join(items[int(k)] for k in np.flatnonzero(chosen))


def fit_values(wins: Matrix, model: Model) -> Matrix:
    """Return the values that make win counts most likely, with mean zero.

    Parameters
    ----------
    wins
        Win counts, shape (m, t, t), each with a maximum (`has_maximum`).
    model
        One of `MODELS`.

    Returns
    -------
    numpy.ndarray
        Shape (m, t), on the model's own scale.

    Raises
    ------
    ArithmeticError
        If a fit does not converge.
    """
    values = np.zeros(wins.shape[:2])
    active = np.arange(len(wins))
    for _ in range(_MOST_STEPS):
        counts, start = wins[active], values[active]
        weights = np.linalg.solve(
            _grounded(information(counts, start, model)), score(counts, start, model)[..., None]
        )[..., 0]
        step = weights - weights.mean(axis=1, keepdims=True)
        values[active] = _uphill(counts, start, step, model)
        active = active[np.abs(step).max(axis=1) > _LARGEST_STEP]
        if not active.size:
            return values
    raise ArithmeticError(f"{model.title}: the fit did not converge in {_MOST_STEPS} steps")


def _uphill(wins: Matrix, start: Matrix, step: Matrix, model: Model) -> Matrix:
    """Return start + step, each step halved until its likelihood does not fall."""
    before = log_likelihood(wins, start, model)
    slack = 1e-12 * np.abs(before)
    for _ in range(_MOST_HALVINGS):
        falls = log_likelihood(wins, start + step, model) < before - slack
        if not falls.any():
            break
        step = np.where(falls[:, None], step / 2, step)
    return start + step


def differences(values: Matrix) -> Matrix:
    """Return value_i - value_j, shape (..., t, t)."""
    return np.asarray(values[..., :, None] - values[..., None, :])


def log_likelihood(wins: Matrix, values: Matrix, model: Model) -> Matrix:
    """Return the log-likelihood of win counts (..., t, t) at values (..., t)."""
    logs = model.log_probability(differences(values))
    return np.asarray((wins * logs).sum(axis=(-2, -1)))


def score(wins: Matrix, values: Matrix, model: Model) -> Matrix:
    """Return the log-likelihood's gradient, shape (..., t)."""
    gap = differences(values)
    slope = model.density(gap) / (model.probability(gap) * model.probability(-gap))
    answers = wins + np.swapaxes(wins, -1, -2)
    return np.asarray(((wins - answers * model.probability(gap)) * slope).sum(axis=-1))


def information(wins: Matrix, values: Matrix, model: Model) -> Matrix:
    """Return the Fisher information, shape (..., t, t); its rows sum to zero."""
    gap = differences(values)
    answers = wins + np.swapaxes(wins, -1, -2)
    weights = answers * model.density(gap) ** 2 / (model.probability(gap) * model.probability(-gap))
    return np.asarray(np.eye(wins.shape[-1]) * weights.sum(axis=-1)[..., None] - weights)


def covariance(wins: Matrix, values: Matrix, model: Model) -> Matrix:
    """Return the inverse information among values with mean zero, shape (..., t, t)."""
    items = wins.shape[-1]
    centre = np.eye(items) - 1 / items
    return np.asarray(centre @ np.linalg.inv(_grounded(information(wins, values, model))) @ centre)


def _grounded(information_: Matrix) -> Matrix:
    """Add what makes the information invertible without changing it among zero-mean values."""
    return np.asarray(information_ + 1 / information_.shape[-1])
