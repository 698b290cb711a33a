"""Trigger codes for a recording device: one when a stimulus appears, one when it is answered."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from pydantic import Field

from algorithms.errors import InputError
from experiments.lab.ports import Port, PortSettings, open_port
from experiments.lab.window import LabWindow
from experiments.planning.trials import Answer, Phase, Trial
from experiments.study_parts import Part
from experiments.toml_files import read_toml
from stimuli.manifest import Factor, StimulusSet

LARGEST_CODE = 255


class OnsetRule(Part):
    """Which trials have a code; what is left out holds for all of them.

    Attributes
    ----------
    code
        1 to 255.
    phase, trial
        Trials of that phase; the trial of that index, from 0.
    factors
        Trials all of whose images have these levels.
    """

    code: int = Field(ge=1, le=LARGEST_CODE)
    phase: Phase | None = None
    trial: int | None = Field(default=None, ge=0)
    factors: Mapping[str, Factor] = Field(default_factory=dict)

    def holds(self, trial: Trial, stimuli: StimulusSet) -> bool:
        """Return whether a trial has this code."""
        return (
            self.phase in (None, trial.phase)
            and self.trial in (None, trial.index)
            and all(
                stimuli[identifier].factors.get(name) == level
                for identifier in trial.stimuli
                for name, level in self.factors.items()
            )
        )


class AnswerRule(OnsetRule):
    """Which answers have a code.

    Attributes
    ----------
    answer
        That answer, as it is stored; `none` where the time limit passed; left out for any.
    """

    answer: int | Literal["none"] | None = None

    def holds_of(self, trial: Trial, stimuli: StimulusSet, answer: Answer) -> bool:
        """Return whether an answer to a trial has this code."""
        given = "none" if answer is None else answer
        return self.answer in (None, given) and self.holds(trial, stimuli)


class TriggerPlan(Part):
    """A file of trigger codes: the port, and rules of which the first that holds gives the code."""

    port: PortSettings
    onset: tuple[OnsetRule, ...] = ()
    answer: tuple[AnswerRule, ...] = ()


def load_triggers(path: Path) -> TriggerPlan:
    """Load a file of trigger codes.

    Raises
    ------
    InputError
        If it cannot be read or has an unknown, missing or impossible entry.
    """
    return read_toml(path, TriggerPlan)


def check_triggers(plan: TriggerPlan, stimuli: StimulusSet) -> None:
    """Check that a stimulus set has the factors and levels that a plan names.

    Raises
    ------
    InputError
        Naming the level that no image has.
    """
    for key, rules in (("onset", plan.onset), ("answer", plan.answer)):
        for name, level in (pair for rule in rules for pair in rule.factors.items()):
            levels = {each.factors[name] for each in stimuli.stimuli if name in each.factors}
            if level not in levels:
                there = ", ".join(sorted(map(str, levels))) or "no such factor"
                raise InputError(
                    f"triggers: {key}.factors.{name}: {level} given, the set has {there}"
                )


@dataclass(frozen=True)
class Triggers:
    """Sends the codes of a plan."""

    plan: TriggerPlan
    stimuli: StimulusSet
    window: LabWindow
    port: Port

    def onset(self, trial: Trial) -> None:
        """Send the code of a trial's onset."""
        self._send(rule.code for rule in self.plan.onset if rule.holds(trial, self.stimuli))

    def answered(self, trial: Trial, answer: Answer) -> None:
        """Send the code of an answer."""
        rules = self.plan.answer
        self._send(rule.code for rule in rules if rule.holds_of(trial, self.stimuli, answer))

    def _send(self, codes: Iterable[int]) -> None:
        code = next(iter(codes), None)
        if code is not None:
            self.port.send(code)
            if self.plan.port.reset:
                self.window.on_flip(lambda: self.port.send(0))


@contextmanager
def open_triggers(plan: TriggerPlan, stimuli: StimulusSet, window: LabWindow) -> Iterator[Triggers]:
    """Open the port of a plan and close it afterwards.

    Raises
    ------
    UnavailableError, InputError
        If the port cannot be used.
    """
    with open_port(plan.port, window.time_s) as port:
        yield Triggers(plan, stimuli, window, port)
