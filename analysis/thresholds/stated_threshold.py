"""The threshold at any stated percent correct, whichever fit it comes from."""

from dataclasses import dataclass

import pandas as pd

from analysis.estimates import Estimate
from analysis.thresholds.sigmoid import Floats, within_levels

STATED = "level at which a stated share of the answers is right"


@dataclass(frozen=True)
class StatedThreshold:
    """The level at which a psychometric function reaches a share of right answers.

    Attributes
    ----------
    threshold
        In the unit of the levels, with its 95 % interval; infinite beyond the levels tested and
        where the share is never reached.
    correct
        The share of right answers there, from 0 to 1.
    reached
        Whether the threshold lies `within` the levels tested, `above` or `below` them.
    guess_rate
        The share of right answers by chance.
    n
        The number of answers.
    method, definition, version
        How the function was fitted, what is meant by threshold, and by which Trompe.
    """

    threshold: Estimate
    correct: float
    reached: str
    guess_rate: float
    n: int
    method: str
    version: str
    definition: str = STATED

    def to_frame(self) -> pd.DataFrame:
        """Return one row: the threshold with its interval, and what it means."""
        rest = {name: value for name, value in vars(self).items() if name != "threshold"}
        return pd.DataFrame([self.threshold.columns("threshold") | rest])


def place(value: float, levels: Floats | tuple[float, ...]) -> tuple[float, str]:
    """Return a threshold, infinite beyond the levels tested, and where it lies.

    >>> place(12.0, (20.0, 30.0))
    (-inf, 'below')
    """
    bounded = float(within_levels(value, levels))
    return bounded, {-float("inf"): "below", float("inf"): "above"}.get(bounded, "within")
