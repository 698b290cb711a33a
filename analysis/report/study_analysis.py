"""The analysis of a study: from the rows of a store to the results of its task."""

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module, metadata
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final, Protocol, cast

import pandas as pd

from algorithms.errors import InputError
from analysis.answers.exclusions import (
    Flow,
    Who,
    apply_rule,
    catch_answers,
    catch_trials,
    select_sessions,
)
from analysis.estimates import software_version
from experiments.responses import Event, Response, Session, responses_frame
from experiments.study import Study, Task
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LIBRARIES = (
    "numpy",
    "scipy",
    "pandas",
    "psignifit",
    "statsmodels",
    "scikit-posthocs",
    "matplotlib",
)


@dataclass(frozen=True)
class Collected:
    """What every analysis starts from.

    Attributes
    ----------
    study, stimuli
        What was run.
    flow
        Whose answers are analysed, and of how many.
    sessions
        Those that are analysed.
    trials
        The analysed trials: the table that the task makes of the answers.
    seed
        Of every random draw.
    include_pilot
        Whether sessions that only tried the study out count.
    answers_digest
        The SHA-256 of the answers that were analysed: with the same ones, seed and versions the
        results are the same.
    versions
        Of Trompe and the libraries that computed.
    events
        What happened to the sessions that are analysed.
    gaze_folders
        Where the files may be that the events tell of.
    """

    study: Study
    stimuli: StimulusSet
    flow: Flow
    sessions: tuple[Session, ...]
    trials: pd.DataFrame
    seed: int
    include_pilot: bool
    answers_digest: str
    versions: dict[str, str]
    events: tuple[Event, ...]
    gaze_folders: tuple[Path, ...]

    @property
    def simulated(self) -> bool:
        """Whether programs answered, not people."""
        return self.flow.who == "simulated"


@dataclass(frozen=True)
class StudyAnalysis(Collected, ABC):
    """Everything that a report says; each task has its own kind.

    Attributes
    ----------
    template
        The stem of the report's templates for this task: `STEM.html` shows the results,
        `STEM-methods.html` tells how they were computed.
    """

    template: ClassVar[str]

    @abstractmethod
    def findings(self) -> Mapping[str, object]:
        """Return the results by name, for JSON."""

    @abstractmethod
    def sentences(self) -> list[str]:
        """Return the results in plain sentences; what programs answered is not told of people."""

    @abstractmethod
    def tables(self) -> dict[str, pd.DataFrame]:
        """Return the tables that are written beside a report, by name."""

    @abstractmethod
    def figures(self) -> "dict[str, Figure]":
        """Return every figure that the answers allow, by name."""

    def summary(self) -> dict[str, object]:
        """Return the results without the single trials, for JSON."""
        return {
            "study": self.study.name,
            "study_version": self.study.version,
            "study_digest": self.study.digest,
            "stimuli": self.stimuli.name,
            "stimuli_digest": self.stimuli.digest,
            "task": self.study.task,
            "simulated": self.simulated,
            "flow": self.flow,
            **self.findings(),
            "seed": self.seed,
            "include_pilot": self.include_pilot,
            "answers_digest": self.answers_digest,
            "versions": self.versions,
        }


class TaskModule(Protocol):
    """What a module of `analysis.report.tasks` offers."""

    def trials(self, responses: pd.DataFrame, study: Study, stimuli: StimulusSet) -> pd.DataFrame:
        """Join answers with what was shown: one row a main trial."""
        ...

    def analyse(self, collected: Collected) -> StudyAnalysis:
        """Compute the results."""
        ...


_MODULES: Final[Mapping[Task, str]] = {
    "odd-one-out": "odd_one_out",
    "two-alternative": "two_alternative",
    "ranking": "ranking",
    "yes-no": "yes_no",
    "pick": "pick",
    "free-viewing": "free_viewing",
}


def analyse_study(
    study: Study,
    stimuli: StimulusSet,
    sessions: Sequence[Session],
    responses: Sequence[Response],
    seed: int,
    events: Sequence[Event] = (),
    who: Who | None = None,
    *,
    include_pilot: bool = False,
    gaze_folders: Sequence[Path] = (),
) -> StudyAnalysis:
    """Analyse the answers of people, or of simulated observers, to one version of a study.

    Parameters
    ----------
    study, stimuli
        What was run.
    sessions, responses, events
        What the store holds of it; those of other versions of the study are counted and left out.
    seed
        Of every random draw, 0 or more.
    who
        Whose answers, or None: people if one of them has finished, simulated observers otherwise.
    include_pilot
        Whether sessions that only tried the study out count too.
    gaze_folders
        Where gaze may be, of `free-viewing`.

    Raises
    ------
    InputError
        If nothing is left to analyse, or rows do not belong to study and stimuli.
    """
    if seed < 0:
        raise InputError(f"seed: {seed} given, 0 or more accepted")
    _check_sessions(sessions, responses)
    version = (study.digest, stimuli.digest)
    current = [one for one in sessions if (one.study_digest, one.stimuli_digest) == version]
    chosen, who, left_out = select_sessions(current, who, include_pilot=include_pilot)
    if len(current) < len(sessions):
        left_out["of other versions of the study or its stimuli"] = len(sessions) - len(current)
    task = _module(study)
    ids = {one.id for one in chosen}
    answers = responses_frame([each for each in responses if each.session in ids])
    table = task.trials(answers, study, stimuli)
    caught = catch_answers(answers, study, stimuli)
    excluded = apply_rule(study.exclusion, chosen, table, events, caught)
    gone = {one.participant for one in excluded}
    counted = ~table["participant"].isin(gone) & ~catch_trials(table, study.exclusion)
    kept = table[counted].reset_index(drop=True)
    recruited = {one.participant for one in chosen}
    flow = Flow(
        who=who,
        recruited=len(recruited),
        completed=len({one.participant for one in chosen if one.completed_at}),
        analysed=len(recruited - gone),
        excluded=excluded,
        left_out=left_out,
    )
    if kept.empty:
        raise InputError(
            f"nothing to analyse yet: {flow.recruited} began, {flow.completed} finished,"
            " none is left after the exclusions"
        )
    analysed = tuple(one for one in chosen if one.participant not in gone)
    return task.analyse(
        Collected(
            study=study,
            stimuli=stimuli,
            flow=flow,
            sessions=analysed,
            trials=kept,
            seed=seed,
            include_pilot=include_pilot,
            answers_digest=_digest(kept),
            versions=_versions(),
            events=tuple(e for e in events if e.session in {one.id for one in analysed}),
            gaze_folders=tuple(gaze_folders),
        )
    )


def _check_sessions(sessions: Sequence[Session], responses: Sequence[Response]) -> None:
    known = {one.id for one in sessions}
    for each in responses:
        if each.session not in known:
            raise InputError(
                f"responses: participant {each.participant} has answers but no session"
            )


def _module(study: Study) -> TaskModule:
    """Return the module of a study's task; it is loaded here, as it needs what stands above."""
    return cast(TaskModule, import_module(f"analysis.report.tasks.{_MODULES[study.task]}"))


def _digest(table: pd.DataFrame) -> str:
    return hashlib.sha256(table.to_csv(index=False).encode()).hexdigest()


def _versions() -> dict[str, str]:
    return {"trompe": software_version()} | {name: metadata.version(name) for name in _LIBRARIES}
