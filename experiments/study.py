"""The study file: one TOML file that the lab, the web and simulated observers all run."""

import hashlib
import math
import tomllib
from pathlib import Path
from typing import Literal, Self

from pydantic import Field, ValidationError, model_validator

from algorithms.errors import InputError
from experiments.study_parts import (
    Analysis,
    Answers,
    Consent,
    DemographicsField,
    Design,
    Exclusion,
    Name,
    Part,
    Practice,
    Screen,
    Stimuli,
    Stopping,
    Task,
    Text,
    Timing,
)
from stimuli.manifest import StimulusSet, first_fault

__all__ = ["READY_MADE", "Exclusion", "Study", "Task", "check_stimuli", "load_study"]

# A task compares single images, pairs of them, or whole sets.
_DESIGN_OF_TASK: dict[Task, str] = {
    "odd-one-out": "factorial",
    "yes-no": "factorial",
    "two-alternative": "pairs",
    "ranking": "sets",
}
# Keys and parts that came after the first studies were run.
_LATER_KEYS = {
    "stimuli": ("item", "within"),
    "timing": ("image_s", "mask_s"),
    "exclusion": ("catch_level", "least_catch_share", "largest_late_share"),
}
_LATER_PARTS = ("answers", "analysis")
# Keys that only some tasks have a use for.
_TASKS_OF_KEY: tuple[tuple[str, tuple[Task, ...]], ...] = (
    ("timing.image_s", ("yes-no", "two-alternative")),
    ("timing.mask_s", ("two-alternative",)),
    ("answers.labels", ("yes-no", "ranking")),
    ("answers.ties", ("ranking",)),
    ("exclusion.catch_level", ("odd-one-out",)),
    ("analysis.equivalence_margin", ("two-alternative",)),
)

READY_MADE = Path(__file__).parent / "studies"


class Study(Part):
    """A study: what is asked about which stimuli, of whom, in what order and under what rules."""

    name: Name
    title: Text
    version: int = Field(ge=1)
    task: Task
    question: Text
    instructions: tuple[Text, ...] = ()
    language: Literal["en"] = "en"
    stimuli: Stimuli
    design: Design
    practice: Practice = Practice(trials=0)
    timing: Timing = Timing()
    answers: Answers = Answers()
    consent: Consent
    demographics: tuple[DemographicsField, ...] = ()
    screen: Screen = Screen()
    stopping: Stopping
    exclusion: Exclusion = Exclusion()
    analysis: Analysis = Analysis()

    @property
    def digest(self) -> str:
        """The SHA-256 of everything the study says, whatever the layout of its file.

        Keys that came later are left out while they say nothing: an older study stays the same.
        """
        said_nothing: dict[str, bool | set[str]] = {
            part: {key for key in keys if self._is_default(part, key)}
            for part, keys in _LATER_KEYS.items()
        }
        said_nothing |= {part: True for part in _LATER_PARTS if self._is_default(part)}
        content = self.model_dump_json(exclude=said_nothing)
        return hashlib.sha256(content.encode()).hexdigest()

    def _is_default(self, part: str, key: str | None = None) -> bool:
        """Return whether a part, or a key of it, says what it says when it is left out."""
        if key is None:
            return bool(getattr(self, part) == type(self).model_fields[part].default)
        of_part: Part = getattr(self, part)
        return bool(getattr(of_part, key) == type(of_part).model_fields[key].default)

    @property
    def guess_rate(self) -> float:
        """The share of right answers, or of one of two answers, by chance; NaN for rankings."""
        if self.task == "ranking":
            return math.nan
        return 1 / (self.stimuli.choices or 2)

    @property
    def choices(self) -> int:
        """How many objects there are to choose among: of `odd-one-out` studies only."""
        if self.stimuli.choices is None:
            raise InputError(f"task: {self.task} given, odd-one-out accepted")
        return self.stimuli.choices

    @model_validator(mode="after")
    def _check_task(self) -> Self:
        """Refuse what the task needs and the study lacks, and what the task has no use for."""
        wanted = _DESIGN_OF_TASK[self.task]
        if self.design.kind != wanted:
            raise ValueError(
                f"design.kind: {self.design.kind!r} given, the task {self.task} takes {wanted!r}"
            )
        chooses = self.task == "odd-one-out"
        for key, given, needed in (
            ("choices", self.stimuli.choices, chooses),
            ("item", self.stimuli.item, not chooses),
        ):
            if needed and given is None:
                raise ValueError(f"stimuli.{key}: missing")
            if not needed and given is not None:
                raise ValueError(f"stimuli.{key}: the task {self.task} has no use for it")
        if self.stimuli.within and wanted == "factorial":
            raise ValueError(f"stimuli.within: the task {self.task} has no use for it")
        return self

    @model_validator(mode="after")
    def _check_rules(self) -> Self:
        """Refuse rules that the task has no use for, and halves of rules."""
        rule = self.exclusion
        if (rule.catch_level is None) != (rule.least_catch_share is None):
            raise ValueError("exclusion.catch_level, least_catch_share: one without the other")
        for name, tasks in _TASKS_OF_KEY:
            if self.task not in tasks and not self._is_default(*name.split(".")):
                raise ValueError(f"{name}: the task {self.task} has no use for it")
        return self


def load_study(path: str | Path) -> Study:
    """Load a study from its TOML file, or a ready-made one by its name.

    Parameters
    ----------
    path
        A file, or the name of one of the studies that come with Trompe (`lights-synthetic`).

    Raises
    ------
    InputError
        If the file cannot be read, is not TOML, or has an unknown, missing or impossible entry:
        the message names the key.
    """
    path = Path(path)
    if not path.suffix and not path.exists():
        path = _ready_made(path.name)
    try:
        return Study.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a TOML file ({error})") from error
    except ValidationError as error:
        raise InputError(f"{path}: {first_fault(error)}") from error


def _ready_made(name: str) -> Path:
    path = READY_MADE / f"{name}.toml"
    if not path.is_file():
        names = ", ".join(sorted(file.stem for file in READY_MADE.glob("*.toml")))
        raise InputError(f"study: no file and no ready-made study {name!r}; there are: {names}")
    return path


def check_stimuli(study: Study, stimuli: StimulusSet) -> None:
    """Check that a study can run with a stimulus set.

    Raises
    ------
    InputError
        Naming the study's key that does not fit the set.
    """
    main, practice = stimuli.with_role("main"), stimuli.with_role("practice")
    _require(study.stimuli.set == stimuli.name, "stimuli.set", study.stimuli.set, stimuli.name)
    factors = sorted(main[0].factors) if main else []
    for key, names in (
        ("level", [study.stimuli.level] if study.stimuli.level else []),
        ("conditions", study.stimuli.conditions),
        ("item", [study.stimuli.item] if study.stimuli.item else []),
        ("within", study.stimuli.within),
    ):
        for name in names:
            _require(name in factors, f"stimuli.{key}", name, f"the factors {', '.join(factors)}")
    _require(
        study.practice.trials <= len(practice),
        "practice.trials",
        study.practice.trials,
        f"{len(practice)} practice stimuli",
    )
    if study.task == "odd-one-out":
        _check_regions(study, stimuli)


def _check_regions(study: Study, stimuli: StimulusSet) -> None:
    _require(
        study.stimuli.choices == len(stimuli.objects),
        "stimuli.choices",
        study.stimuli.choices,
        f"{len(stimuli.objects)} objects",
    )
    for stimulus in (*stimuli.with_role("main"), *stimuli.with_role("practice")):
        if stimulus.regions is None:
            raise InputError(f"stimuli.set: {stimulus.id} of the set has no regions to choose from")


def _require(fits: bool, key: str, given: object, available: object) -> None:
    if not fits:
        raise InputError(f"{key}: the study says {given}, the stimulus set has {available}")
