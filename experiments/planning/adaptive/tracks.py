"""Interleaved tracks: one staircase or QUEST+ for each combination of conditions."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import numpy as np

from algorithms.errors import InputError
from experiments.planning.adaptive.quest_plus import QuestPlusTrack
from experiments.planning.adaptive.staircase import StaircaseTrack
from experiments.planning.designs import Shown, arrange
from experiments.planning.presentations import Trial
from experiments.planning.right_answers import right_answer
from experiments.study import Study, chosen
from experiments.study_parts import QuestPlus, Staircase
from stimuli.manifest import Stimulus, StimulusSet

ByLevel = Mapping[float, Sequence[Shown]]


class Track(Protocol):
    """A procedure over the levels of one combination of conditions."""

    trials: int

    @property
    def done(self) -> bool:
        """Whether the track has ended."""

    def choose(self) -> float:
        """Return the level of the next trial."""

    def learn(self, level: float, *, right: bool) -> None:
        """Take an answer to a trial at that level."""

    def estimate(self) -> dict[str, float | int | None]:
        """Return what is known of the threshold."""


class Tracks:
    """All tracks of a session, in random turns.

    Parameters
    ----------
    study, stimuli
        A study of kind `staircase` or `quest-plus`.

    Raises
    ------
    InputError
        If a level is no number, or a combination of conditions has fewer than two levels.
    """

    def __init__(self, study: Study, stimuli: StimulusSet) -> None:
        self._presentations = _presentations(study, stimuli)
        make, trials = _maker(study)
        self._tracks = {name: make(sorted(found)) for name, found in self._presentations.items()}
        self.limit = trials * len(self._tracks)
        self.possible = tuple(
            identifier
            for levels in self._presentations.values()
            for presentations in levels.values()
            for shown in presentations
            for identifier in shown
        )
        self._shown: Counter[Shown] = Counter()
        self._asked: tuple[Track, float] | None = None

    def choose(
        self, before: Shown, generator: np.random.Generator
    ) -> tuple[Shown, dict[str, Any]] | None:
        """Return what to show next and why, or None when every track has ended.

        Of a level's images, or pairs in either order, one is drawn of those shown least, no image
        twice in a row where there is another.
        """
        running = [name for name, track in self._tracks.items() if not track.done]
        if not running:
            return None
        name = running[int(generator.integers(len(running)))]
        track = self._tracks[name]
        level = track.choose()
        there = self._presentations[name][level]
        fresh = [shown for shown in there if not {*shown} & {*before}] or there
        least = min(self._shown[shown] for shown in fresh)
        likely = [shown for shown in fresh if self._shown[shown] == least]
        shown = likely[int(generator.integers(len(likely)))]
        self._shown[shown] += 1
        self._asked = track, level
        if len(shown) == 2 and generator.integers(2):
            shown = shown[::-1]
        return shown, {"track": name, "level": level, **track.estimate()}

    def learn(self, *, right: bool) -> None:
        """Take the answer to what was chosen last."""
        assert self._asked is not None
        track, level = self._asked
        track.learn(level, right=right)

    def estimates(self) -> dict[str, dict[str, float | int | None]]:
        """Return what is known of each track's threshold, and after how many trials."""
        return {
            name: {"trials": track.trials, **track.estimate()}
            for name, track in self._tracks.items()
        }


def _maker(study: Study) -> tuple[Callable[[Sequence[float]], Track], int]:
    """Return what makes a track over levels, and how many trials it has at most."""
    if study.design.kind == "staircase":
        stairs = study.design.staircase or Staircase()
        return lambda levels: StaircaseTrack(stairs, levels), stairs.trials
    quest = study.design.quest_plus or QuestPlus()
    return lambda levels: QuestPlusTrack(quest, levels, study.guess_rate), quest.trials


def _presentations(study: Study, stimuli: StimulusSet) -> Mapping[str, ByLevel]:
    """Return the presentations that have a right answer, by track and level, as the set has them.

    The level of a pair is how far its images' levels lie apart; both are of one track.
    """
    tracks: dict[str, dict[float, list[Shown]]] = {}
    for shown in arrange(study, chosen(study, stimuli, "main")):
        names = {_name(study, stimuli[each]) for each in shown}
        if len(names) == 1 and right_answer(study, stimuli, Trial(0, "main", shown)) is not None:
            levels = [_level(study, stimuli[each]) for each in shown]
            level = levels[0] if len(levels) == 1 else abs(levels[0] - levels[1])
            tracks.setdefault(names.pop(), {}).setdefault(level, []).append(shown)
    if not tracks:
        raise InputError("stimuli.set: no main stimulus has a right answer to adapt to")
    for name, by_level in tracks.items():
        if len(by_level) < 2:
            raise InputError(
                f"stimuli.conditions: {name or 'the set'} has {len(by_level)} level of"
                f" {study.stimuli.level} with a right answer, two or more accepted"
            )
    return tracks


def _name(study: Study, stimulus: Stimulus) -> str:
    return ", ".join(f"{name}={stimulus.factors[name]}" for name in study.stimuli.conditions)


def _level(study: Study, stimulus: Stimulus) -> float:
    value = stimulus.factors[study.stimuli.level or ""]
    if isinstance(value, str):
        raise InputError(
            f"stimuli.level: {study.stimuli.level} of {stimulus.id} is {value!r}, not a number"
        )
    return float(value)
