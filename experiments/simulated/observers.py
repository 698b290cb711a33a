"""Simulated observers: programs that answer a study's trials with a known psychometric function."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from algorithms.errors import InputError
from experiments.planning.trials import Assignment, Trial, planned_trials
from experiments.psychometric import psychometric_function, sigmoid
from experiments.responses import now, response_id
from experiments.study import Study
from stimuli.manifest import Stimulus, StimulusSet

__all__ = ["Observer", "psychometric_function", "simulate_responses"]

Floats = NDArray[np.float64]
Labels = NDArray[np.int64]


@dataclass(frozen=True)
class Observer:
    """An observer who notices the odd object with a known probability, and else guesses.

    With guess rate g (1 / choices), lapse rate l and F a cumulative normal, the observer notices
    the odd object with probability d = (1 - l / (1 - g)) F(level) and then names it; else one of
    all objects is chosen, each with a probability proportional to its salience. Without salience
    the right one of them is hit with probability g, so that

        P(right) = d + (1 - d) g = g + (1 - g) d = g + (1 - g - l) F(level),

    which is exactly the psychometric function that is fitted (`psychometric_function`). With
    salience the observer is biased: g gives way to the odd object's share of the salience.
    Where nothing is odd (controls) the choice is by salience alone. In `yes-no` the observer
    notices with that probability what an image is (g = 1/2), and else says yes or no alike.

    In `pick` every inserted object is noticed with that probability d, each by itself. How many
    objects are picked is drawn evenly between the least and the most, or is the number of those
    noticed if that is larger; noticed ones first, then others by salience.

    Attributes
    ----------
    threshold
        The level at which F is one half, in the level's unit; or one threshold for each value of
        the factor named by `condition`.
    width
        The levels from F = 5 % to F = 95 %, more than 0.
    lapse_rate
        The share of wrong answers however clear the difference; 0 to 0.5.
    fatigue
        By how much the lapse rate grows over a hundred trials, 0 or more; it stays within 0.5.
    condition
        The factor that `threshold` depends on, such as `placement`; None for a single threshold.
    salience
        How much each label draws guesses, 0 or more; labels not named have 1. None: all alike.
    noticed_time_s, guessed_time_s
        The median time of an answer where the odd object was noticed, and of a guess.
    time_spread
        The standard deviation of the time's logarithm.

    Raises
    ------
    InputError
        If one of them is out of its range.

    References
    ----------
    Wichmann and Hill 2001, Perception & Psychophysics 63(8), eq. 1; the width is defined as by
    Schuett et al. 2016, Vision Research 122.
    """

    threshold: float | Mapping[str, float]
    width: float
    lapse_rate: float = 0.02
    fatigue: float = 0.0
    condition: str | None = None
    salience: Mapping[int, float] | None = None
    noticed_time_s: float = 5.0
    guessed_time_s: float = 12.0
    time_spread: float = 0.5

    def __post_init__(self) -> None:
        _require(self.width > 0, "width", self.width, "more than 0")
        _require(0 <= self.lapse_rate <= 0.5, "lapse_rate", self.lapse_rate, "0 to 0.5")
        _require(0 <= self.fatigue < np.inf, "fatigue", self.fatigue, "0 or more")
        weights = (self.salience or {}).values()
        _require(all(weight >= 0 for weight in weights), "salience", self.salience, "0 or more")
        times = min(self.noticed_time_s, self.guessed_time_s)
        _require(times > 0, "noticed_time_s, guessed_time_s", times, "more than 0")
        _require(self.time_spread >= 0, "time_spread", self.time_spread, "0 or more")
        if isinstance(self.threshold, Mapping) != (self.condition is not None):
            raise InputError("condition: given when, and only when, there are several thresholds")

    def after(self, trials: int) -> "Observer":
        """Return the observer as they are after so many trials."""
        if self.fatigue == 0:
            return self
        return replace(self, lapse_rate=min(self.lapse_rate + self.fatigue * trials / 100, 0.5))

    def answer(
        self, study: Study, stimulus: Stimulus, generator: np.random.Generator
    ) -> tuple[int | tuple[int, ...], float]:
        """Return the chosen label, those picked, or 1 for yes and 0 for no; and the seconds taken.

        Parameters
        ----------
        study
            Its `stimuli.level` names the factor that the psychometric function is over.
        stimulus
            What is shown, truth included.
        generator
            Where chance comes from.
        """
        if study.task == "pick":
            return _pick(self, study, stimulus, generator)
        if study.task == "yes-no":
            return _judge(self, study, stimulus, generator)
        shown = _Shown.of(study, [stimulus], self)
        labels, times_s = _answer_all(self, study.choices, shown, generator)
        return int(labels[0]), float(times_s[0])

    def describe(self) -> str:
        """Return the observer's parameters in one line, as the answers' `device` keeps them."""
        threshold = self.threshold
        if isinstance(threshold, Mapping):
            threshold_text = ", ".join(f"{key} {value:g}" for key, value in threshold.items())
        else:
            threshold_text = f"{threshold:g}"
        bias = "" if self.salience is None else "; guesses by salience"
        bias += f"; fatigue {self.fatigue:g}" if self.fatigue else ""
        return (
            f"simulated observer: threshold {threshold_text}; width {self.width:g};"
            f" lapse rate {self.lapse_rate:g}{bias}"
        )


def simulate_responses(
    study: Study,
    stimuli: StimulusSet,
    observer: Observer,
    participants: int,
    generator: np.random.Generator,
) -> pd.DataFrame:
    """Return what a number of simulated participants answer, without server or store.

    Parameters
    ----------
    study, stimuli
        What they take; participants are numbered from 1.
    observer
        How they answer.
    participants
        How many, 1 or more.
    generator
        Where chance comes from.

    Returns
    -------
    One row an answer in the columns of `responses_frame`, every row flagged `simulated`.
    """
    _require(participants >= 1, "participants", participants, "1 or more")
    plans = [planned_trials(study, stimuli, Assignment(n + 1)) for n in range(participants)]
    trials = [trial for plan in plans for trial in plan]
    if study.task == "pick":
        picked = [
            _pick(observer.after(trial.index), study, stimuli[trial.stimuli[0]], generator)
            for trial in trials
        ]
        return _frame(study, stimuli, observer, plans, *zip(*picked, strict=True))
    seen = list(dict.fromkeys(trial.stimuli[0] for plan in plans for trial in plan))
    number_of = {identifier: number for number, identifier in enumerate(seen)}
    shown = _Shown.of(study, [stimuli[identifier] for identifier in seen], observer)
    shown = shown.take([number_of[trial.stimuli[0]] for trial in trials])
    shown = shown.tired(observer, [trial.index for trial in trials])
    labels, times_s = _answer_all(observer, study.choices, shown, generator)
    return _frame(study, stimuli, observer, plans, labels.tolist(), times_s.tolist())


@dataclass(frozen=True)
class _Shown:
    """What an observer needs of each stimulus; `odd` is 0 where nothing is odd."""

    level: Floats
    threshold: Floats
    odd: Labels
    lapse_rate: Floats

    @classmethod
    def of(
        cls, study: Study, stimuli: list[Stimulus] | tuple[Stimulus, ...], observer: Observer
    ) -> "_Shown":
        level = _level(study)
        return cls(
            level=np.array([_number(stimulus, level) for stimulus in stimuli], np.float64),
            threshold=np.array([_threshold(observer, s) for s in stimuli], np.float64),
            odd=np.array([_odd(stimulus) for stimulus in stimuli], np.int64),
            lapse_rate=np.full(len(stimuli), observer.lapse_rate),
        )

    def take(self, order: list[int]) -> "_Shown":
        return _Shown(*(each[order] for each in vars(self).values()))

    def tired(self, observer: Observer, trials: list[int]) -> "_Shown":
        lapse_rate = [observer.after(trial).lapse_rate for trial in trials]
        return replace(self, lapse_rate=np.array(lapse_rate, np.float64))


def _answer_all(
    observer: Observer, choices: int, shown: _Shown, generator: np.random.Generator
) -> tuple[Labels, Floats]:
    lapse_rate, level, threshold = shown.lapse_rate, shown.level, shown.threshold
    notice_rate = _notice_rate(lapse_rate, choices, level, threshold, observer.width)
    size = len(shown.level)
    noticed = (generator.random(size) < notice_rate) & (shown.odd > 0)
    guesses = generator.choice(np.arange(1, choices + 1), size=size, p=_shares(observer, choices))
    labels = np.where(noticed, shown.odd, guesses)
    medians_s = np.where(noticed, observer.noticed_time_s, observer.guessed_time_s)
    return labels, medians_s * generator.lognormal(0, observer.time_spread, size)


def _notice_rate(
    lapse_rate: ArrayLike, choices: int, level: ArrayLike, threshold: ArrayLike, width: float
) -> Floats:
    lapses = np.asarray(lapse_rate) / (1 - 1 / choices)
    return np.asarray((1 - lapses) * sigmoid(level, threshold, width))


def _rate_of(observer: Observer, study: Study, stimulus: Stimulus, choices: int) -> float:
    level, threshold = _number(stimulus, _level(study)), _threshold(observer, stimulus)
    return float(_notice_rate(observer.lapse_rate, choices, level, threshold, observer.width))


def _pick(
    observer: Observer, study: Study, stimulus: Stimulus, generator: np.random.Generator
) -> tuple[tuple[int, ...], float]:
    assert study.answers.picks is not None  # the study has seen to it
    least, most = study.answers.picks
    rate = _rate_of(observer, study, stimulus, study.choices)
    noticed = [label for label in stimulus.right_labels if generator.random() < rate]
    picked = [int(label) for label in generator.permutation(noticed)[:most]]
    wanted = int(generator.integers(least, most + 1))
    shares = _shares(observer, study.choices)
    while len(picked) < wanted:
        left = np.setdiff1d(np.arange(1, study.choices + 1), picked)
        weights = shares[left - 1]
        p = weights / weights.sum() if weights.any() else None
        picked.append(int(generator.choice(left, p=p)))
    median_s = observer.noticed_time_s if noticed else observer.guessed_time_s
    return tuple(sorted(picked)), median_s * float(generator.lognormal(0, observer.time_spread))


def _level(study: Study) -> str:
    if study.stimuli.level is None:
        raise InputError("stimuli.level: an observer needs a study that names its level")
    return study.stimuli.level


def _judge(
    observer: Observer, study: Study, stimulus: Stimulus, generator: np.random.Generator
) -> tuple[int, float]:
    rate, truth = _rate_of(observer, study, stimulus, 2), stimulus.answer
    noticed = isinstance(truth, int) and bool(generator.random() < rate)
    said = truth if isinstance(truth, int) and noticed else generator.integers(2)
    median_s = observer.noticed_time_s if noticed else observer.guessed_time_s
    return int(said), median_s * float(generator.lognormal(0, observer.time_spread))


def _shares(observer: Observer, choices: int) -> Floats:
    salience = observer.salience or {}
    for label in salience:
        _require(1 <= label <= choices, "salience", f"label {label}", f"labels 1 to {choices}")
    weights = np.array([salience.get(label, 1.0) for label in range(1, choices + 1)], np.float64)
    _require(weights.sum() > 0, "salience", "0 for every label", "more than 0 for one")
    shares: Floats = weights / weights.sum()
    return shares


def _number(stimulus: Stimulus, factor: str) -> float:
    value = stimulus.factors.get(factor)
    if isinstance(value, str) or value is None:
        raise InputError(f"stimuli.level: {factor} of {stimulus.id} is {value!r}, not a number")
    return float(value)


def _threshold(observer: Observer, stimulus: Stimulus) -> float:
    if not isinstance(observer.threshold, Mapping):
        return observer.threshold
    value = str(stimulus.factors.get(observer.condition or ""))
    if value not in observer.threshold:
        raise InputError(f"threshold: none is given for {observer.condition} {value}")
    return observer.threshold[value]


def _odd(stimulus: Stimulus) -> int:
    if stimulus.answer is None:
        return 0
    if not isinstance(stimulus.answer, int):
        raise InputError(f"answer: {stimulus.id} has {stimulus.answer!r}, a label is accepted")
    return stimulus.answer


def _frame(
    study: Study,
    stimuli: StimulusSet,
    observer: Observer,
    plans: list[tuple[Trial, ...]],
    answers: Sequence[object],
    times_s: Sequence[float],
) -> pd.DataFrame:
    people = [f"P{number:04d}" for number, plan in enumerate(plans, start=1) for _ in plan]
    sessions = [f"{study.name}.{participant}.1" for participant in people]
    trials = [trial for plan in plans for trial in plan]
    return pd.DataFrame(
        {
            "id": [response_id(s, t.index) for s, t in zip(sessions, trials, strict=True)],
            "study": study.name,
            "study_digest": study.digest,
            "stimuli_digest": stimuli.digest,
            "participant": people,
            "session": sessions,
            "trial_index": [trial.index for trial in trials],
            "phase": [trial.phase for trial in trials],
            "stimuli": [trial.stimuli for trial in trials],
            "answer": answers,
            "reaction_time_s": times_s,
            "onset_requested_s": None,
            "onset_measured_s": None,
            "frame_interval_s": None,
            "dropped_frames": None,
            "input": "none",
            "device": observer.describe(),
            "runner": "simulation",
            "simulated": True,
            "pilot": False,
            "recorded_at": now(),
        }
    )


def _require(fits: bool, name: str, given: object, accepted: str) -> None:
    if not fits:
        raise InputError(f"{name}: {given} given, {accepted} accepted")
