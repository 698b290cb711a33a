"""Whose answers are analysed: the study's declared rule, and the flow of participants."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import pandas as pd

from algorithms.errors import InputError
from experiments.planning.right_answers import is_right
from experiments.planning.trials import Answer, Trial
from experiments.responses import Event, Session
from experiments.study import Exclusion, Study
from stimuli.manifest import StimulusSet

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


def catch_trials(table: pd.DataFrame, rule: Exclusion) -> "pd.Series[bool]":
    """Return which trials only tell whether a participant pays attention.

    Parameters
    ----------
    table
        One row a trial, with `level` and `target` (`analysis.trial_table`), or with `catch` (true
        or false).
    rule
        Its `catch_level` decides; a rule without one about catch trials takes the column `catch`.
    """
    if rule.catch_level is not None:
        return (table["level"] >= rule.catch_level) & table["target"].notna()
    if rule.least_catch_share is not None and "catch" in table:
        return table["catch"].astype(bool)
    return pd.Series(data=False, index=table.index)


def catch_answers(
    responses: pd.DataFrame, study: Study, stimuli: StimulusSet
) -> pd.DataFrame | None:
    """Return the answers to the catch trials that a study's `catch` adds, or None without it.

    Parameters
    ----------
    responses
        Rows with the columns of `experiments.responses.Response`.
    study, stimuli
        What was run.

    Returns
    -------
    pandas.DataFrame
        One row a catch trial: `session`, `participant`, and `correct` (no answer is none).
    """
    if study.catch is None:
        return None
    caught = responses[responses["phase"] == "catch"]
    correct = [
        bool(is_right(study, stimuli, Trial(0, "catch", tuple(shown)), _tuple_or_number(answer)))
        for shown, answer in zip(caught["stimuli"], caught["answer"], strict=True)
    ]
    return caught[["session", "participant"]].assign(correct=correct)


def _tuple_or_number(answer: object) -> Answer:
    if isinstance(answer, list | tuple):
        return tuple(int(rank) for rank in answer)
    return None if pd.isna(answer) else int(answer)  # type: ignore[call-overload]


def apply_rule(
    rule: Exclusion,
    sessions: Sequence[Session],
    table: pd.DataFrame,
    events: Sequence[Event] = (),
    caught: pd.DataFrame | None = None,
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
    caught
        The answers to catch trials that are not in the table (`catch_answers`).
    """
    ended = {e.session: _ENDING_EVENTS[e.kind] for e in events if e.kind in _ENDING_EVENTS}
    answered = set(table["session"])
    by_answers = _by_answers(rule, table, "session", caught)
    excluded = []
    for one in sessions:
        if one.id in ended:
            reason = ended[one.id]
        elif rule.incomplete and one.completed_at is None:
            reason = "did not finish"
        elif one.id not in answered:
            reason = "gave no answer"
        elif one.id in by_answers:
            reason = by_answers[one.id]
        else:
            continue
        excluded.append(Excluded(one.participant, reason))
    return tuple(excluded)


def exclude(table: pd.DataFrame, rule: Exclusion) -> tuple[pd.DataFrame, Flow]:
    """Apply a rule to a table of answers of one's own.

    Parameters
    ----------
    table
        One row an answer: `participant`, and what the rule is about: `reaction_time_s`,
        `dropped_frames`, `correct` with `catch` (true for catch trials), `completed` (true for all
        answers of who finished; without it everybody has). A column `simulated` says whether
        programs answered.
    rule
        Such as ``Exclusion(shortest_median_s=0.5)``, from `experiments.study`.

    Returns
    -------
    tuple
        The rows that are analysed, catch trials left out, and the flow of participants.

    Raises
    ------
    InputError
        If a column is missing, or nobody is left.
    """
    _check_columns(table, rule)
    participants = list(dict.fromkeys(table["participant"]))
    finished = table.get("completed", pd.Series(data=True, index=table.index)).astype(bool)
    unfinished = set(table.loc[~finished, "participant"])
    by_answers = _by_answers(rule, table, "participant")
    reasons = by_answers | {who: "did not finish" for who in unfinished if rule.incomplete}
    kept = table[~table["participant"].isin(reasons) & ~catch_trials(table, rule)]
    if kept.empty:
        raise InputError(
            f"nothing to analyse: {len(participants)} participants, none is left after the"
            " exclusions"
        )
    simulated = "simulated" in table and bool(table["simulated"].any())
    flow = Flow(
        who="simulated" if simulated else "people",
        recruited=len(participants),
        completed=len(participants) - len(unfinished),
        analysed=len(participants) - len(reasons),
        excluded=tuple(Excluded(str(who), reasons[who]) for who in participants if who in reasons),
    )
    return kept.reset_index(drop=True), flow


def describe_rule(rule: Exclusion, unit: str = "") -> str:
    """Return a rule in words, such as `who did not finish; who was right in ...`.

    Parameters
    ----------
    rule
        The study's `exclusion`.
    unit
        Of the catch level.
    """
    parts = ["who did not finish"] if rule.incomplete else []
    if rule.shortest_median_s is not None:
        parts.append(f"whose median time per answer is below {rule.shortest_median_s:g} s")
    if rule.least_catch_share is not None:
        level = "" if rule.catch_level is None else f" ({rule.catch_level:g} {unit}".rstrip()
        level += " and above)" if level else ""
        parts.append(
            f"who was right in less than {100 * rule.least_catch_share:g} % of the catch"
            f" trials{level}"
        )
    if rule.largest_late_share is not None:
        parts.append(f"who saw late frames in over {100 * rule.largest_late_share:g} % of trials")
    return "; ".join(parts) or "nobody"


def _check_columns(table: pd.DataFrame, rule: Exclusion) -> None:
    needed = ["participant"]
    needed += ["reaction_time_s"] if rule.shortest_median_s is not None else []
    needed += ["dropped_frames"] if rule.largest_late_share is not None else []
    if rule.least_catch_share is not None:
        needed += ["correct", *(["catch"] if rule.catch_level is None else ["level", "target"])]
    missing = [name for name in needed if name not in table]
    if missing:
        raise InputError(f"table: the column {missing[0]} is missing")
    if table.empty:
        raise InputError("table: nothing to analyse, there is no answer")


def _by_answers(
    rule: Exclusion, table: pd.DataFrame, by: str, caught: pd.DataFrame | None = None
) -> dict[str, str]:
    """Return whom the rule leaves out for their answers, with the first reason that holds."""
    reasons: dict[str, str] = {}
    for broken, reason in _broken(rule, table, by, caught):
        for who in broken.index[broken]:
            reasons.setdefault(str(who), reason)
    return reasons


def _broken(
    rule: Exclusion, table: pd.DataFrame, by: str, caught: pd.DataFrame | None
) -> Iterator[tuple["pd.Series[bool]", str]]:
    """Yield for each part of a rule who breaks it, and how that is called."""
    if rule.least_catch_share is not None:
        catch = table[catch_trials(table, rule)] if caught is None else caught
        right = catch["correct"].astype("boolean").fillna(value=False).astype(float)
        share = right.groupby(catch[by]).mean()
        least = rule.least_catch_share
        yield share < least, f"right in less than {100 * least:g} % of the catch trials"
    if rule.shortest_median_s is not None:
        median_s = table.groupby(by)["reaction_time_s"].median()
        shortest_s = rule.shortest_median_s
        yield median_s < shortest_s, f"median time per answer below {shortest_s:g} s"
    if rule.largest_late_share is not None:
        known = pd.to_numeric(table["dropped_frames"]).dropna()  # not every runner measures them
        late = (known > 0).groupby(table[by]).mean()
        largest = rule.largest_late_share
        yield late > largest, f"late frames in over {100 * largest:g} % of the trials"
