"""Active pairs: the comparison whose outcome is expected to tell most about the scale."""

from collections import Counter
from itertools import combinations
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import entr, log_ndtr, ndtr, ndtri

from experiments.planning.designs import Shown, comparisons
from experiments.planning.presentations import Pool
from experiments.study import Study, chosen
from stimuli.manifest import StimulusSet

Floats = NDArray[np.float64]

_NOISE_JOD: Final = float(1 / ndtri(0.75))
_LOG_ROOT_2_PI: Final = 0.5 * np.log(2 * np.pi)
_DIGITS: Final = 9  # as in quest_plus
_MOST_STEPS: Final = 100


class ScalePosterior:
    """What comparisons tell of qualities: a normal approximation at their most likely values.

    A pair's better image is chosen by the difference of two perceived qualities (Thurstone's case
    V); qualities are normal beforehand. In units of the difference's noise.

    Parameters
    ----------
    wins
        Shape (n, n), how often the row's image was chosen over the column's.
    spread
        The standard deviation of qualities beforehand, more than 0.
    start
        Qualities to begin the search at, shape (n,), or None for zeros.

    Attributes
    ----------
    qualities, covariance
        Shapes (n,) and (n, n).
    """

    def __init__(self, wins: Floats, spread: float, start: Floats | None = None) -> None:
        self.qualities: Floats = np.zeros(len(wins)) if start is None else start
        self._wins, self._prior = wins, spread**-2
        for _ in range(_MOST_STEPS):
            slope, curvature = self._derivatives()
            step: Floats = np.asarray(np.linalg.solve(curvature, slope), np.float64)
            self.qualities = self.qualities + step
            if np.abs(step).max() < 1e-10:
                break
        self.covariance: Floats = np.asarray(np.linalg.inv(self._derivatives()[1]), np.float64)

    def information(self) -> Floats:
        """Return by pair how much a comparison is expected to tell of the qualities, in bits.

        Shape (n, n), symmetrical: the mutual information of outcome and qualities.

        References
        ----------
        Houlsby et al. 2011, arXiv:1112.5745, eq. 3; pairs chosen so for quality scales: Mikhailiuk
        et al. 2020, ICPR (ASAP).
        """
        variances = np.diag(self.covariance)
        mean = self.qualities[:, None] - self.qualities
        variance = np.maximum(variances[:, None] + variances - 2 * self.covariance, 0)
        expected = ndtr(mean / np.sqrt(1 + variance))
        entropy = (entr(expected) + entr(1 - expected)) / np.log(2)
        c = np.pi * np.log(2) / 2
        known = np.sqrt(c / (variance + c)) * np.exp(-(mean**2) / (2 * (variance + c)))
        return np.asarray(entropy - known)

    def _derivatives(self) -> tuple[Floats, Floats]:
        """Return slope and negative curvature of the log posterior."""
        difference = self.qualities[:, None] - self.qualities
        ratio = np.exp(-(difference**2) / 2 - _LOG_ROOT_2_PI - log_ndtr(difference))
        pull = self._wins * ratio
        slope = pull.sum(axis=1) - pull.sum(axis=0) - self._prior * self.qualities
        bend = self._wins * ratio * (ratio + difference)
        bend = bend + bend.T
        return slope, np.diag(bend.sum(axis=1) + self._prior) - bend


class ActivePairsOfSession:
    """The choice of a session's pairs.

    Parameters
    ----------
    study, stimuli
        A study of kind `active-pairs`.
    pool
        What others had answered when the session began.
    """

    def __init__(self, study: Study, stimuli: StimulusSet, pool: Pool) -> None:
        rule = study.design.active_pairs
        assert rule is not None
        self._rule, self._repeats = rule, study.design.repeats
        groups = comparisons(study, chosen(study, stimuli, "main")).values()
        self.possible = tuple(each.id for group in groups for each in group.values())
        number = {identifier: place for place, identifier in enumerate(self.possible)}
        pairs = [
            (number[first.id], number[second.id])
            for group in groups
            for first, second in combinations(group.values(), 2)
        ]
        self._pairs = np.array(pairs, dtype=np.intp).reshape(-1, 2)
        self._number = number
        self._wins: Floats = np.zeros((len(number), len(number)))
        for better, worse, count in pool:
            if better in number and worse in number:
                self._wins[number[better], number[worse]] += count
        self._shown = np.zeros(len(self._pairs), dtype=np.int64)
        self._left: Counter[str] = Counter()
        self._qualities: Floats | None = None
        self._asked = 0
        self.limit = min(rule.trials, self._repeats * len(pairs))

    def choose(
        self, before: Shown, generator: np.random.Generator
    ) -> tuple[Shown, dict[str, Any]] | None:
        """Return the next pair and why, or None when the session has had its pairs.

        No pair comes more often than `design.repeats`, no image twice in a row where that can be;
        the image that stood on the left less often stands there.
        """
        if self._shown.sum() >= self.limit:
            return None
        compared = (self._wins + self._wins.T).sum(axis=1)
        allowed = self._shown < self._repeats
        shown_last = [self._number[image] for image in before if image in self._number]
        fresh = allowed & ~np.isin(self._pairs, shown_last).any(axis=1)
        allowed = fresh if fresh.any() else allowed
        lacking = compared[self._pairs].min(axis=1)
        least = lacking[allowed].min()
        covering = bool(least < self._rule.each_image)
        if covering:
            allowed = allowed & (lacking == least)
        posterior = ScalePosterior(self._wins, self._rule.spread / _NOISE_JOD, self._qualities)
        self._qualities = posterior.qualities
        bits = np.round(posterior.information()[tuple(self._pairs.T)], _DIGITS)
        bits[~allowed] = -np.inf
        best = np.flatnonzero(bits == bits.max())
        self._asked = int(best[generator.integers(len(best))])
        detail = {
            "reason": "coverage" if covering else "information",
            "bits": float(bits[self._asked]),
            "comparisons": int(self._wins.sum()),
        }
        return self._placed(generator), detail

    def learn(self, shown: Shown, *, first: bool | None) -> None:
        """Take the answer to the pair chosen last: whether its first image, or None for no one."""
        self._shown[self._asked] += 1
        self._left[shown[0]] += 1
        if first is not None:
            better, worse = shown if first else shown[::-1]
            self._wins[self._number[better], self._number[worse]] += 1

    def estimates(self) -> dict[str, Any]:
        """Return the qualities by image in just-objectionable differences, their mean 0."""
        posterior = ScalePosterior(self._wins, self._rule.spread / _NOISE_JOD, self._qualities)
        qualities = _NOISE_JOD * (posterior.qualities - posterior.qualities.mean())
        qualities = np.round(qualities, _DIGITS)
        return dict(zip(self.possible, qualities.tolist(), strict=True))

    def _placed(self, generator: np.random.Generator) -> Shown:
        one, other = (self.possible[place] for place in self._pairs[self._asked])
        ahead = self._left[one] - self._left[other]
        turned = bool(generator.integers(2)) if ahead == 0 else ahead > 0
        return (other, one) if turned else (one, other)
