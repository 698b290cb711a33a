"""The study file: one TOML file that the lab, the web and simulated observers all run."""

import hashlib
import math
from pathlib import Path
from typing import Final, Literal, Self

from pydantic import Field, model_validator

from algorithms.errors import InputError
from experiments.study_parts import (
    Analysis,
    Answers,
    Catch,
    Consent,
    DemographicsField,
    Design,
    Display,
    Exclusion,
    Name,
    Part,
    Practice,
    Recruitment,
    Screen,
    Stimuli,
    Stopping,
    Task,
    Text,
    Timing,
)
from experiments.toml_files import read_toml
from stimuli.manifest import Factor, Role, Stimulus, StimulusSet

__all__ = [
    "CHOOSES",
    "READY_MADE",
    "Exclusion",
    "Study",
    "Task",
    "check_stimuli",
    "chosen",
    "load_study",
]

# A task compares single images, pairs of them, or whole sets.
_DESIGNS_OF_TASK: dict[Task, tuple[str, ...]] = {
    "odd-one-out": ("factorial", "staircase", "quest-plus"),
    "yes-no": ("factorial", "staircase", "quest-plus"),
    "two-alternative": ("pairs", "staircase", "quest-plus", "active-pairs"),
    "ranking": ("sets",),
    "pick": ("factorial",),
    "free-viewing": ("factorial",),
}
# Of the tasks about objects in an image: an object is chosen among `stimuli.choices`.
CHOOSES: Final[tuple[Task, ...]] = ("odd-one-out", "pick")
# Keys and parts that came after the first studies were run.
_LATER_KEYS = {
    "stimuli": ("made_by", "item", "within", "only"),
    "design": (
        "one_of_each",
        "distinct",
        "blocks",
        "staircase",
        "quest_plus",
        "active_pairs",
    ),
    "practice": ("best_first",),
    "timing": ("image_s", "mask_s"),
    "answers": ("picks",),
    "screen": ("color_gamut", "allow_zoom", "rule", "fullscreen", "calibrate", "distance"),
    "stopping": ("abandoned_after_s",),
    "exclusion": ("catch_level", "least_catch_share", "largest_late_share"),
}
_LATER_PARTS = ("answers", "catch", "recruitment", "analysis", "display")
_ANSWERED: tuple[Task, ...] = ("odd-one-out", "two-alternative", "yes-no", "ranking", "pick")
# Keys that only some tasks have a use for.
_TASKS_OF_KEY: tuple[tuple[str, tuple[Task, ...]], ...] = (
    ("design.one_of_each", ("odd-one-out", "yes-no", "pick", "free-viewing")),
    ("design.distinct", ("odd-one-out", "yes-no", "pick", "free-viewing")),
    ("practice.best_first", ("two-alternative", "ranking")),
    ("catch", ("two-alternative", "ranking")),
    ("timing.image_s", ("yes-no", "two-alternative", "free-viewing")),
    ("timing.time_limit_s", _ANSWERED),
    ("practice", _ANSWERED),
    ("exclusion.shortest_median_s", _ANSWERED),
    ("timing.mask_s", ("two-alternative",)),
    ("answers.labels", ("yes-no", "ranking")),
    ("answers.ties", ("ranking",)),
    ("answers.picks", ("pick",)),
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
    language: Literal["en", "es"] = "en"
    stimuli: Stimuli
    design: Design
    practice: Practice = Practice(trials=0)
    catch: Catch | None = None
    timing: Timing = Timing()
    answers: Answers = Answers()
    consent: Consent
    demographics: tuple[DemographicsField, ...] = ()
    display: Display = Display()
    screen: Screen = Screen()
    recruitment: Recruitment = Recruitment()
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
        default = type(of_part).model_fields[key].get_default(call_default_factory=True)
        return bool(getattr(of_part, key) == default)

    @property
    def guess_rate(self) -> float:
        """The share of right answers, or of one of two answers, by chance.

        NaN for rankings, for picks, where it depends on how many objects are picked, and where
        nothing is answered.
        """
        if self.task in ("ranking", "pick", "free-viewing"):
            return math.nan
        return 1 / (self.stimuli.choices or 2)

    @property
    def choices(self) -> int:
        """How many objects there are to choose among, where objects are chosen."""
        if self.stimuli.choices is None:
            raise InputError(f"task: {self.task} given, {' or '.join(CHOOSES)} accepted")
        return self.stimuli.choices

    @model_validator(mode="after")
    def _check_task(self) -> Self:
        """Refuse what the task needs and the study lacks, and what the task has no use for."""
        wanted = _DESIGNS_OF_TASK[self.task]
        if self.design.kind not in wanted:
            raise ValueError(
                f"design.kind: {self.design.kind!r} given, the task {self.task} takes"
                f" {' or '.join(map(repr, wanted))}"
            )
        if self.design.kind in ("staircase", "quest-plus") and self.stimuli.level is None:
            raise ValueError(f"stimuli.level: missing; a {self.design.kind} chooses its levels")
        chooses = self.task in CHOOSES
        for key, given, needed in (
            ("choices", self.stimuli.choices, chooses),
            ("item", self.stimuli.item, not chooses and self.task != "free-viewing"),
        ):
            if needed and given is None:
                raise ValueError(f"stimuli.{key}: missing")
            if not needed and given is not None:
                raise ValueError(f"stimuli.{key}: the task {self.task} has no use for it")
        if self.stimuli.within and "factorial" in wanted:
            raise ValueError(f"stimuli.within: the task {self.task} has no use for it")
        return self

    @model_validator(mode="after")
    def _check_needs(self) -> Self:
        """Refuse a task without the keys that are required for it alone."""
        if self.task == "free-viewing" and self.timing.image_s is None:
            raise ValueError("timing.image_s: missing")
        if self.task == "pick":
            if self.answers.picks is None:
                raise ValueError("answers.picks: missing")
            if self.answers.picks[1] > self.choices:
                raise ValueError(
                    f"answers.picks: {list(self.answers.picks)} given, at most stimuli.choices"
                    " accepted"
                )
        return self

    @model_validator(mode="after")
    def _check_rules(self) -> Self:
        """Refuse rules that the task has no use for, and halves of rules."""
        for name, tasks in _TASKS_OF_KEY:
            if self.task not in tasks and not self._is_default(*name.split(".")):
                raise ValueError(f"{name}: the task {self.task} has no use for it")
        rule = self.exclusion
        if self.design.kind in ("staircase", "quest-plus"):
            if self.task == "two-alternative" and not self.practice.best_first:
                raise ValueError("practice.best_first: missing; it says which of two is right")
            if self.catch is not None:
                raise ValueError(f"catch: a design of kind {self.design.kind!r} has no use for it")
        if self.catch is not None and rule.least_catch_share is None:
            raise ValueError("exclusion.least_catch_share: missing; there are catch trials")
        if self.catch is None and (rule.catch_level is None) != (rule.least_catch_share is None):
            raise ValueError("exclusion.catch_level, least_catch_share: one without the other")
        if (self.design.one_of_each is None) != (self.design.distinct is None):
            raise ValueError("design.one_of_each, distinct: one without the other")
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
    return read_toml(path, Study)


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
    main, practice = chosen(study, stimuli, "main"), chosen(study, stimuli, "practice")
    _require(study.stimuli.set == stimuli.name, "stimuli.set", study.stimuli.set, stimuli.name)
    factors = sorted(stimuli.with_role("main")[0].factors) if stimuli.with_role("main") else []
    for key, names in (
        ("level", [study.stimuli.level] if study.stimuli.level else []),
        ("conditions", study.stimuli.conditions),
        ("item", [study.stimuli.item] if study.stimuli.item else []),
        ("within", study.stimuli.within),
        ("only", study.stimuli.only),
    ):
        for name in names:
            _require(name in factors, f"stimuli.{key}", name, f"the factors {', '.join(factors)}")
    for name, levels in study.stimuli.only.items():
        there = {each.factors[name] for each in stimuli.with_role("main")}
        for level in levels:
            _require(level in there, f"stimuli.only.{name}", level, _listed(there))
    for key in ("one_of_each", "distinct", "blocks"):
        name = getattr(study.design, key)
        if name is not None:
            _require(name in factors, f"design.{key}", name, f"the factors {', '.join(factors)}")
    if not main:
        raise InputError("stimuli.only: no main stimulus of the set has these levels")
    _require(
        study.practice.trials <= len(practice),
        "practice.trials",
        study.practice.trials,
        f"{len(practice)} practice stimuli",
    )
    if study.task in CHOOSES:
        _check_regions(study, stimuli)


def _listed(levels: set[Factor]) -> str:
    return ", ".join(sorted(map(str, levels)))


def chosen(study: Study, stimuli: StimulusSet, role: Role) -> tuple[Stimulus, ...]:
    """Return the stimuli of a role that take part: those with the levels of `stimuli.only`."""
    only = study.stimuli.only
    return tuple(
        stimulus
        for stimulus in stimuli.with_role(role)
        if all(stimulus.factors.get(name) in levels for name, levels in only.items())
    )


def _check_regions(study: Study, stimuli: StimulusSet) -> None:
    _require(
        study.stimuli.choices == len(stimuli.objects),
        "stimuli.choices",
        study.stimuli.choices,
        f"{len(stimuli.objects)} objects",
    )
    for stimulus in (*chosen(study, stimuli, "main"), *chosen(study, stimuli, "practice")):
        if stimulus.regions is None:
            raise InputError(f"stimuli.set: {stimulus.id} of the set has no regions to choose from")


def _require(fits: bool, key: str, given: object, available: object) -> None:
    if not fits:
        raise InputError(f"{key}: the study says {given}, the stimulus set has {available}")
