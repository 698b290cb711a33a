"""The course of one session: which trials are decided so far, and why."""

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from algorithms.errors import InputError
from experiments.planning.designs import Shown, arrange, catch_comparisons
from experiments.planning.presentations import Answer, Assignment, Phase, Trial
from experiments.planning.right_answers import is_right
from experiments.planning.trials import planned_trials
from experiments.study import Study, chosen
from stimuli.manifest import StimulusSet

Detail = Mapping[str, Any]


class Course(ABC):
    """The trials of a session as far as they are decided.

    Attributes
    ----------
    limit
        How many trials there are, or at most.
    """

    limit: int

    @property
    @abstractmethod
    def trials(self) -> tuple[Trial, ...]:
        """The trials that are decided: all of a fixed design, else to the next to be answered."""

    @property
    @abstractmethod
    def next(self) -> Trial | None:
        """The first trial without an answer, or None at the end."""

    @property
    @abstractmethod
    def possible(self) -> frozenset[str]:
        """The ids of all images that may still be shown."""

    @property
    @abstractmethod
    def practice(self) -> int:
        """How many of the trials are practice."""

    @abstractmethod
    def take(self, trial_index: int, answer: Answer) -> None:
        """Take an answer; one that was taken before changes nothing."""

    def decision(self, trial_index: int) -> Detail | None:
        """Return why a decided trial was chosen, as JSON; None where no answer had a part in it."""
        del trial_index
        return None

    def estimates(self) -> Detail | None:
        """Return what the answers so far have told an adaptive design, as JSON."""
        return None


def course_of(
    study: Study,
    stimuli: StimulusSet,
    assignment: Assignment,
    answers: Mapping[int, Answer] | None = None,
) -> Course:
    """Return the course of a session.

    Parameters
    ----------
    study, stimuli, assignment
        What fixes the design.
    answers
        Those given so far, by trial index; None for none. Of an adaptive design only those before
        the first gap count: nothing after it can have been decided.

    Raises
    ------
    InputError
        If the stimuli do not allow the design.
    """
    made = AdaptiveCourse if study.design.is_adaptive else FixedCourse
    course = made(study, stimuli, assignment)
    for index in sorted(answers or {}):
        if index < len(course.trials):
            course.take(index, (answers or {})[index])
    return course


def next_trial(
    study: Study,
    stimuli: StimulusSet,
    assignment: Assignment,
    answers_so_far: Mapping[int, Answer],
) -> Trial | None:
    """Return the trial to present now, or None when the session is complete.

    A deterministic function: whoever knows study, stimuli, assignment and answers knows what was
    shown. Parameters as in `course_of`; a trial with an answer is never shown again.
    """
    return course_of(study, stimuli, assignment, answers_so_far).next


class FixedCourse(Course):
    """The course of a session whose trials are all known beforehand."""

    def __init__(self, study: Study, stimuli: StimulusSet, assignment: Assignment) -> None:
        self._trials = planned_trials(study, stimuli, assignment)
        self._answered: set[int] = set()
        self.limit = len(self._trials)

    @property
    def trials(self) -> tuple[Trial, ...]:
        """All trials."""
        return self._trials

    @property
    def next(self) -> Trial | None:
        """The first trial without an answer."""
        return next((each for each in self._trials if each.index not in self._answered), None)

    @property
    def possible(self) -> frozenset[str]:
        """The images of the trials without an answer."""
        left = (trial for trial in self._trials if trial.index not in self._answered)
        return frozenset(image for trial in left for image in trial.stimuli)

    @property
    def practice(self) -> int:
        """How many of the trials are practice."""
        return sum(trial.phase == "practice" for trial in self._trials)

    def take(self, trial_index: int, answer: Answer) -> None:
        """Note that a trial has its answer."""
        del answer
        self._answered.add(trial_index)


@dataclass(frozen=True)
class _Decided:
    trial: Trial
    detail: Detail | None


class AdaptiveCourse(Course):
    """The course of a session in which each answer has a part in what comes next.

    Chance in trial k comes from the study's seed, the participant's number and k: the same answers
    lead to the same trials.
    """

    def __init__(self, study: Study, stimuli: StimulusSet, assignment: Assignment) -> None:
        # SciPy takes a second to import, which a server of fixed designs need not wait for.
        from experiments.planning.adaptive.active_pairs import ActivePairsOfSession
        from experiments.planning.adaptive.tracks import Tracks

        self._study, self._stimuli = study, stimuli
        self._seed = [study.design.seed, assignment.participant_number]
        self._rule: Tracks | ActivePairsOfSession
        if study.design.kind == "active-pairs":
            self._rule = ActivePairsOfSession(study, stimuli, assignment.pool)
        else:
            self._rule = Tracks(study, stimuli)
        self._beforehand = self._fixed_trials()
        self.limit = len(self._beforehand) + self._rule.limit
        self._decided: list[_Decided] = []
        self._answers: list[Answer] = []
        self._digest = hashlib.sha256()
        self._decide()

    @property
    def trials(self) -> tuple[Trial, ...]:
        """The answered trials, and the next one."""
        return tuple(each.trial for each in self._decided)

    @property
    def next(self) -> Trial | None:
        """The trial that is decided and not answered."""
        answered = len(self._answers) == len(self._decided)
        return None if answered else self._decided[-1].trial

    @property
    def possible(self) -> frozenset[str]:
        """All images that a trial may show; none at the end."""
        if self.next is None:
            return frozenset()
        fixed = (image for _, shown in self._beforehand.values() for image in shown)
        return frozenset((*self._rule.possible, *fixed))

    @property
    def practice(self) -> int:
        """How many of the trials are practice."""
        return sum(phase == "practice" for phase, _ in self._beforehand.values())

    def take(self, trial_index: int, answer: Answer) -> None:
        """Take the answer to the next trial and decide what follows it.

        Raises
        ------
        InputError
            If the trial is not decided yet, or has another answer.
        """
        if trial_index < len(self._answers):
            if answer != self._answers[trial_index]:
                raise InputError(f"answer: trial {trial_index} already has another answer")
            return
        if self.next is None or trial_index != self.next.index:
            raise InputError(f"trial_index: {trial_index} given, it is not decided yet")
        trial = self.next
        self._answers.append(answer)
        self._digest.update(json.dumps(answer).encode() + b"\n")
        if trial.phase == "main":
            self._learn(trial, answer)
        self._decide()

    def decision(self, trial_index: int) -> Detail | None:
        """Return why a decided trial was chosen, after which answers (their SHA-256).

        None for practice and catch trials, which no answer changes.
        """
        return self._decided[trial_index].detail

    def estimates(self) -> Detail | None:
        """Return what the answers so far have told, and their SHA-256."""
        found = self._rule.estimates()
        return {"estimates": found, "answers_sha256": self._digest.hexdigest()}

    def _fixed_trials(self) -> dict[int, tuple[Phase, Shown]]:
        """Return the trials that no answer changes, by their index: practice and catch trials."""
        study, stimuli = self._study, self._stimuli
        practice = arrange(study, chosen(study, stimuli, "practice"))[: study.practice.trials]
        generator = np.random.default_rng(self._seed)
        caught = catch_comparisons(study, stimuli, generator)
        rest = len(caught) + self._rule.limit
        places = len(practice) + np.sort(generator.choice(rest, len(caught), replace=False))
        return {
            **{index: ("practice", shown) for index, shown in enumerate(practice)},
            **{int(place): ("catch", shown) for place, shown in zip(places, caught, strict=True)},
        }

    def _decide(self) -> None:
        index = len(self._decided)
        before = self._decided[-1].trial.stimuli if self._decided else ()
        if index in self._beforehand:
            phase, shown = self._beforehand[index]
            feedback = phase == "practice" and self._study.practice.feedback
            self._decided.append(_Decided(Trial(index, phase, shown, feedback), None))
            return
        chosen_now = self._rule.choose(before, np.random.default_rng([*self._seed, index]))
        if chosen_now is not None:
            shown, why = chosen_now
            detail = {"trial_index": index, **why, "answers_sha256": self._digest.hexdigest()}
            self._decided.append(_Decided(Trial(index, "main", shown), detail))

    def _learn(self, trial: Trial, answer: Answer) -> None:
        from experiments.planning.adaptive.active_pairs import ActivePairsOfSession

        if isinstance(self._rule, ActivePairsOfSession):
            self._rule.learn(trial.stimuli, first=None if answer is None else answer == 1)
        else:
            right = is_right(self._study, self._stimuli, trial, answer) is True
            self._rule.learn(right=right)
