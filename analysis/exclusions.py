"""Whose answers are analysed: the study's declared rule, and the flow of participants."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import pandas as pd

from algorithms.errors import InputError
from experiments.responses import Event, Session
from experiments.study import Exclusion

Who = Literal["people", "simulated"]

# Kinds of event after which a participant's answers are not analysed.
_ENDING_EVENTS = {"withdrawal": "withdrew", "exclusion": "excluded by the researcher"}


@dataclass(frozen=True)
class Excluded:
    """A participant left out of the analysis, and why."""

    participant: str
    reason: str


@dataclass(frozen=True)
class Flow:
    """How many participants there were at each step.

    Attributes
    ----------
    who
        Whether these are people or simulated observers; never both.
    recruited, completed, analysed
        Participants who began, who finished, and whose answers are analysed.
    excluded
        Who is left out by the study's rule, with the reason.
    left_out
        Sessions in the store that belong to other analyses (`simulated`, `pilot`, ...).
    """

    who: Who
    recruited: int
    completed: int
    analysed: int
    excluded: tuple[Excluded, ...] = ()
    left_out: Mapping[str, int] = field(default_factory=dict)

    def to_frame(self) -> pd.DataFrame:
        """Return the flow as rows of `step` and `participants`, in its order."""
        reasons = pd.Series([one.reason for one in self.excluded], dtype=str).value_counts()
        steps = {
            "recruited": self.recruited,
            "completed": self.completed,
            **{f"excluded: {reason}": int(count) for reason, count in reasons.items()},
            "analysed": self.analysed,
        }
        return pd.DataFrame(
            {
                "step": list(steps),
                "participants": list(steps.values()),
                "simulated": self.who == "simulated",
            }
        )


def select_sessions(
    sessions: Sequence[Session], who: Who | None = None, *, include_pilot: bool = False
) -> tuple[list[Session], Who, dict[str, int]]:
    """Choose people or simulated observers, never both.

    Parameters
    ----------
    sessions
        All sessions of a study.
    who
        Whose, or None: people if one of them has finished, simulated observers otherwise.
    include_pilot
        Whether sessions that only tried the study out count too.

    Returns
    -------
    tuple
        The sessions, whose they are, and how many of each other kind are left out.

    Raises
    ------
    InputError
        If there is none.
    """
    real = [one for one in sessions if include_pilot or not one.pilot]
    left_out = {"pilot": len(sessions) - len(real)}
    if who is None:
        finished = any(not one.simulated and one.completed_at for one in real)
        who = "people" if finished or not any(one.simulated for one in real) else "simulated"
    chosen = [one for one in real if one.simulated == (who == "simulated")]
    other = "people" if who == "simulated" else "simulated"
    left_out[other] = len(real) - len(chosen)
    if not chosen:
        counts = ", ".join(f"{number} {kind}" for kind, number in left_out.items())
        raise InputError(f"nothing to analyse yet: no session of {who} (others: {counts})")
    return chosen, who, {kind: number for kind, number in left_out.items() if number}


def apply_rule(
    rule: Exclusion, sessions: Sequence[Session], table: pd.DataFrame, events: Sequence[Event] = ()
) -> tuple[Excluded, ...]:
    """Return who is left out by a rule declared before the first answer.

    Parameters
    ----------
    rule
        The study's `exclusion`.
    sessions
        The sessions that are considered.
    table
        Their answers (`analysis.trial_table`).
    events
        What happened to the sessions: a withdrawal or a researcher's exclusion ends them.
    """
    median_s = table.groupby("session")["reaction_time_s"].median()
    ended = {e.session: _ENDING_EVENTS[e.kind] for e in events if e.kind in _ENDING_EVENTS}
    answered = set(table["session"])
    excluded = []
    for one in sessions:
        if one.id in ended:
            reason = ended[one.id]
        elif rule.incomplete and one.completed_at is None:
            reason = "did not finish"
        elif one.id not in answered:
            reason = "gave no answer"
        elif rule.shortest_median_s is not None and median_s[one.id] < rule.shortest_median_s:
            reason = f"median time per answer below {rule.shortest_median_s:g} s"
        else:
            continue
        excluded.append(Excluded(one.participant, reason))
    return tuple(excluded)
