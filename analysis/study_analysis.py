"""The whole analysis of a study: from the rows of a store to its results."""

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import metadata

import numpy as np
import pandas as pd

from algorithms.errors import InputError
from analysis.estimates import software_version
from analysis.exclusions import Flow, Who, apply_rule, select_sessions
from analysis.groups import GroupThreshold, condition_splits, group_thresholds
from analysis.hits import HitRates, hit_rates
from analysis.salience import Salience, object_salience
from analysis.times import AnswerTimes, answer_times
from analysis.trials import trial_table
from experiments.responses import Event, Response, Session, responses_frame
from experiments.study import Study
from stimuli.manifest import StimulusSet

_LIBRARIES = ("numpy", "scipy", "pandas", "psignifit", "matplotlib")


@dataclass(frozen=True)
class StudyAnalysis:
    """Everything that a report says.

    Attributes
    ----------
    study, stimuli
        What was run.
    flow
        Whose answers are analysed, and of how many.
    sessions
        Those that are analysed.
    trials
        The analysed trials (`analysis.trial_table`).
    thresholds
        For all trials, each condition and the conditions crossed.
    hits
        Hit rates by level alone, by level and each condition, and by level and all conditions.
    salience, times
        None where there are no controls, or no times.
    seed
        Of every random draw.
    versions
        Of Trompe and the libraries that computed.
    """

    study: Study
    stimuli: StimulusSet
    flow: Flow
    sessions: tuple[Session, ...]
    trials: pd.DataFrame
    thresholds: tuple[GroupThreshold, ...]
    hits: tuple[HitRates, ...]
    salience: Salience | None
    times: AnswerTimes | None
    seed: int
    versions: dict[str, str]

    @property
    def simulated(self) -> bool:
        """Whether programs answered, not people."""
        return self.flow.who == "simulated"

    @property
    def overall(self) -> GroupThreshold:
        """The thresholds over all trials."""
        return self.thresholds[0]

    def hits_of(self, group: GroupThreshold) -> pd.DataFrame:
        """Return the hit rates of a group by level: what its psychometric function fits."""
        by = ("level", *group.conditions)
        table = next(rates.table for rates in self.hits if rates.by == by)
        for name, value in group.conditions.items():
            table = table[table[name].astype(str) == value]
        return table

    def summary(self) -> dict[str, object]:
        """Return the results without the single trials, for JSON."""
        return {
            "study": self.study.name,
            "study_version": self.study.version,
            "study_digest": self.study.digest,
            "stimuli": self.stimuli.name,
            "stimuli_digest": self.stimuli.digest,
            "simulated": self.simulated,
            "flow": self.flow,
            "level": self.study.stimuli.level,
            "level_unit": self.study.stimuli.level_unit,
            "thresholds": [{"group": group.label, **vars(group)} for group in self.thresholds],
            "hit_rates": self.hits[-1],
            "salience": self.salience,
            "times": self.times,
            "seed": self.seed,
            "versions": self.versions,
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

    Raises
    ------
    InputError
        If nothing is left to analyse, or rows do not belong to study and stimuli.
    """
    version = (study.digest, stimuli.digest)
    current = [one for one in sessions if (one.study_digest, one.stimuli_digest) == version]
    chosen, who, left_out = select_sessions(current, who, include_pilot=include_pilot)
    if len(current) < len(sessions):
        left_out["of other versions of the study or its stimuli"] = len(sessions) - len(current)
    table = _table_of(chosen, responses, study, stimuli)
    excluded = apply_rule(study.exclusion, chosen, table, events)
    gone = {one.participant for one in excluded}
    kept = table[~table["participant"].isin(gone)].reset_index(drop=True)
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
    return _analyse_trials(study, stimuli, flow, analysed, kept, seed)


def _table_of(
    sessions: Sequence[Session],
    responses: Sequence[Response],
    study: Study,
    stimuli: StimulusSet,
) -> pd.DataFrame:
    ids = {one.id for one in sessions}
    return trial_table(responses_frame([r for r in responses if r.session in ids]), study, stimuli)


def _analyse_trials(
    study: Study,
    stimuli: StimulusSet,
    flow: Flow,
    sessions: tuple[Session, ...],
    trials: pd.DataFrame,
    seed: int,
) -> StudyAnalysis:
    if seed < 0:
        raise InputError(f"seed: {seed} given, 0 or more accepted")
    # One generator a result: adding one changes no other.
    for_hits, for_salience, for_times = np.random.default_rng(seed).spawn(3)
    conditions, guess_rate = study.stimuli.conditions, study.guess_rate
    answered = trials["answer"].notna()
    has_controls = bool((trials["control"] & answered).any())
    has_times = bool((trials["reaction_time_s"].notna() & answered).any())
    split = conditions[:1]
    return StudyAnalysis(
        study=study,
        stimuli=stimuli,
        flow=flow,
        sessions=sessions,
        trials=trials,
        thresholds=group_thresholds(trials, conditions, guess_rate),
        hits=tuple(
            hit_rates(trials, ("level", *names), guess_rate, for_hits)
            for names in condition_splits(conditions)
        ),
        salience=(
            object_salience(trials, stimuli.objects, split, for_salience) if has_controls else None
        ),
        times=answer_times(trials, ("level", *split), for_times) if has_times else None,
        seed=seed,
        versions=_versions(),
    )


def _versions() -> dict[str, str]:
    return {"trompe": software_version()} | {name: metadata.version(name) for name in _LIBRARIES}
