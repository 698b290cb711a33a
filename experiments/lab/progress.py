"""What the experimenter is told while a sitting runs."""

import statistics
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

from experiments.answers import Measurement

_MINUTE_S = 60


@dataclass(frozen=True)
class Status:
    """How far a sitting is.

    Attributes
    ----------
    page
        What is on the participant's screen.
    participant
        Who; None before the session begins.
    answers, trials
        How many trials have their answer, of how many at most.
    late_frames, late_frames_last
        Frames that came late in this sitting, and in the trial answered last.
    spent_s, left_s
        Since the session began or went on, and until its end at the median pace of this sitting;
        None before the first answer.
    """

    page: str
    participant: str | None = None
    answers: int = 0
    trials: int = 0
    late_frames: int = 0
    late_frames_last: int = 0
    spent_s: float = 0.0
    left_s: float | None = None

    @property
    def done(self) -> float:
        """The share of trials that have their answer."""
        return self.answers / self.trials if self.trials else 0.0

    def lines(self) -> list[str]:
        """Return what is to be read."""
        if self.participant is None:
            return [self.page]
        left = "" if self.left_s is None else f", about {_minutes(self.left_s)} left"
        return [
            f"{self.participant}: {self.page}",
            f"{self.answers} of {self.trials} answers",
            f"{self.late_frames} late frames, {self.late_frames_last} in the last trial",
            f"{_minutes(self.spent_s)} so far{left}",
        ]


def _minutes(duration_s: float) -> str:
    minutes, seconds = divmod(round(duration_s), _MINUTE_S)
    return f"{minutes}:{seconds:02d} min"


@dataclass
class Progress:
    """Follows a sitting, and tells its status at every page.

    Parameters
    ----------
    watch
        Is told.
    time_s
        The clock.
    """

    watch: Callable[[Status], None]
    time_s: Callable[[], float] = time.monotonic
    _participant: str | None = None
    _answers: int = 0
    _trials: int = 0
    _began_s: float = 0.0
    _answered_s: list[float] = field(default_factory=list)
    _late: list[int] = field(default_factory=list)

    def begin(self, participant: str, answers: int, trials: int) -> None:
        """Note who takes part, with how many answers of how many trials."""
        self._participant, self._answers, self._trials = participant, answers, trials
        self._began_s = self.time_s()

    def answered(self, measured: Measurement, trials: int) -> None:
        """Note an answer, and how many trials there are at most by now."""
        self._answers, self._trials = self._answers + 1, trials
        self._answered_s.append(self.time_s())
        self._late.append(measured.dropped_frames or 0)

    def announce(self, page: str) -> None:
        """Tell that a page is on the screen."""
        began = self._participant is not None
        self.watch(
            Status(
                page,
                self._participant,
                self._answers,
                self._trials,
                sum(self._late),
                self._late[-1] if self._late else 0,
                self.time_s() - self._began_s if began else 0.0,
                self._left_s(),
            )
        )

    def _left_s(self) -> float | None:
        if not self._answered_s:
            return None
        times_s = [self._began_s, *self._answered_s]
        paces_s = [after - before for before, after in pairwise(times_s)]
        return statistics.median(paces_s) * (self._trials - self._answers)
