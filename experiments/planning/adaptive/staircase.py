"""Staircases: harder after right answers, easier after wrong ones."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from experiments.study_parts import Staircase


@dataclass
class StaircaseTrack:
    """One staircase over the levels of a set.

    Parameters
    ----------
    rule
        What the study says of it.
    levels
        In rising order, the easiest last; two or more.

    References
    ----------
    Levitt 1971, Journal of the Acoustical Society of America 49; Kaernbach 1991, Perception &
    Psychophysics 49 (steps up and down of different size).
    """

    rule: Staircase
    levels: Sequence[float]
    trials: int = 0
    _turned_at: list[float] = field(default_factory=list)
    _place: int = field(init=False)
    _direction: int = 0
    _right: int = 0
    _wrong: int = 0

    def __post_init__(self) -> None:
        start = self.levels[-1] if self.rule.start is None else self.rule.start
        self._place = int(np.argmin(np.abs(np.asarray(self.levels) - start)))

    @property
    def done(self) -> bool:
        """Whether the track has ended."""
        wanted = self.rule.reversals
        turned = wanted is not None and len(self._turned_at) >= wanted
        return turned or self.trials >= self.rule.trials

    def choose(self) -> float:
        """Return the level of the next trial."""
        return self.levels[self._place]

    def learn(self, level: float, *, right: bool) -> None:
        """Take an answer to a trial at the level chosen."""
        self.trials += 1
        self._right, self._wrong = (self._right + 1, 0) if right else (0, self._wrong + 1)
        if self._right == self.rule.down:
            self._move(-1, level)
        elif self._wrong == self.rule.up:
            self._move(1, level)

    def estimate(self) -> dict[str, float | int | None]:
        """Return the mean level of the reversals since steps are smallest; None before the first.

        Of an even number of them, the last ones, so that peaks and valleys weigh alike.
        """
        settled = self._turned_at[len(self.rule.steps) - 1 :]
        settled = settled[len(settled) % 2 :] if len(settled) > 1 else settled
        mean = float(np.mean(settled)) if settled else None
        return {"estimate": mean, "reversals": len(self._turned_at)}

    def _move(self, direction: int, level: float) -> None:
        self._right = self._wrong = 0
        if self._direction and direction != self._direction:
            self._turned_at.append(level)
        self._direction = direction
        step = self.rule.steps[min(len(self._turned_at), len(self.rule.steps) - 1)]
        place = self._place + direction * step * (self.rule.up_factor if direction > 0 else 1)
        self._place = min(max(place, 0), len(self.levels) - 1)


def staircase_target(rule: Staircase) -> float:
    """Return the share of right answers around which a staircase settles.

    It is the p at which steps down and up balance: with runs of d right and u wrong answers,
    q = 1 - p, a step goes down with probability

        D = p^(d-1) (1 - q^u) / (p^(d-1) + q^(u-1) - p^(d-1) q^(u-1)),

    and D = f (1 - D) for steps up that are f times as long. For u = 1 that is p^d = f / (1 + f).

    References
    ----------
    Levitt 1971; the probability of one run before another: Feller 1968, An Introduction to
    Probability Theory, vol. 1, XIII.8.

    >>> from experiments.study_parts import Staircase
    >>> round(staircase_target(Staircase(down=2, up=1)), 3)
    0.707
    >>> round(staircase_target(Staircase(down=1, up=1, up_factor=3)), 3)
    0.75
    """

    def surplus(p: ArrayLike) -> float:
        right, wrong = float(p), 1 - float(p)  # type: ignore[arg-type]  # a number
        runs, misses = right ** (rule.down - 1), wrong ** (rule.up - 1)
        down = runs * (1 - wrong**rule.up) / (runs + misses - runs * misses)
        return down - rule.up_factor * (1 - down)

    return float(brentq(surplus, 1e-9, 1 - 1e-9))
