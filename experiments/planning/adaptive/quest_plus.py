"""QUEST+: each trial at the level from which most is expected to be learnt."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import xlogy

from experiments.psychometric import psychometric_function
from experiments.study_parts import QuestPlus

Floats = NDArray[np.float64]

_WIDTHS = (0.125, 0.25, 0.5, 1.0)  # as shares of the levels' range
# Differences below this are of rounding, which another machine may do otherwise.
_DIGITS = 9


class QuestPlusTrack:
    """The posterior over a grid of psychometric functions, and the choice of the next level.

    Parameters
    ----------
    rule
        What the study says of it.
    levels
        Those that can be shown, in rising order; two or more.
    guess_rate
        The share of right answers by chance.

    References
    ----------
    Watson 2017, Journal of Vision 17(3):10; for one threshold and fixed levels the same as
    Kontsevich and Tyler 1999, Vision Research 39.
    """

    def __init__(self, rule: QuestPlus, levels: Sequence[float], guess_rate: float) -> None:
        self._rule = rule
        self._levels = list(levels)
        span = levels[-1] - levels[0]
        thresholds, widths, lapse_rates = np.meshgrid(
            np.linspace(levels[0], levels[-1], rule.thresholds),
            rule.widths or [span * share for share in _WIDTHS],
            rule.lapse_rates,
            indexing="ij",
        )
        self._thresholds: Floats = thresholds.ravel()
        self._right: Floats = psychometric_function(
            np.asarray(levels)[:, None],
            self._thresholds,
            widths.ravel(),
            guess_rate,
            lapse_rates.ravel(),
        )
        self._posterior: Floats = np.full(self._thresholds.size, 1 / self._thresholds.size)
        self.trials = 0

    @property
    def done(self) -> bool:
        """Whether the track has ended."""
        wanted = self._rule.sd
        known = wanted is not None and self.trials > 0 and self._moments()[1] <= wanted
        return known or self.trials >= self._rule.trials

    def choose(self) -> float:
        """Return the level after whose answer the least entropy is expected to be left."""
        left = _entropy_left(self._right * self._posterior)
        left += _entropy_left((1 - self._right) * self._posterior)
        return self._levels[int(np.argmin(np.round(left, _DIGITS)))]

    def learn(self, level: float, *, right: bool) -> None:
        """Take an answer to a trial at a level."""
        self.trials += 1
        likely = self._right[self._levels.index(level)]
        posterior = self._posterior * (likely if right else 1 - likely)
        self._posterior = posterior / posterior.sum()

    def estimate(self) -> dict[str, float | int | None]:
        """Return mean and standard deviation of the threshold, at one half of the function."""
        mean, sd = self._moments()
        return {"estimate": mean, "sd": sd}

    def _moments(self) -> tuple[float, float]:
        mean = float(self._posterior @ self._thresholds)
        sd = float(np.sqrt(self._posterior @ (self._thresholds - mean) ** 2))
        return round(mean, _DIGITS), round(sd, _DIGITS)


def _entropy_left(joint: Floats) -> Floats:
    """Return the entropy after an answer times the answer's probability, by level."""
    share = joint.sum(axis=1)
    return np.asarray(xlogy(share, share) - xlogy(joint, joint).sum(axis=1))
