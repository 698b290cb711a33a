"""The study file: one TOML file that the lab, the web and simulated observers all run."""

import hashlib
import math
import tomllib
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    StringConstraints,
    ValidationError,
    model_validator,
)

from algorithms.errors import InputError, UnavailableError
from stimuli.manifest import StimulusSet, first_fault

Name = Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")]
Text = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1)]
DemographicsField = Literal["age", "gender", "artistic_background"]

Task = Literal["odd-one-out", "two-alternative", "yes-no", "ranking"]

# A task compares single images, pairs of them, or whole sets.
_DESIGN_OF_TASK: dict[Task, str] = {
    "odd-one-out": "factorial",
    "yes-no": "factorial",
    "two-alternative": "pairs",
    "ranking": "sets",
}
# Keys that came after the first studies were run.
_LATER_KEYS = {
    "stimuli": ("item", "within"),
    "exclusion": ("catch_level", "least_catch_share", "largest_late_share"),
}
_PRESENTED: tuple[Task, ...] = ("odd-one-out",)

READY_MADE = Path(__file__).parent / "studies"


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Stimuli(_Part):
    """Which stimuli are shown, and what of them is analysed.

    Attributes
    ----------
    set
        The name of the stimulus set (`trompe stimuli make SET DIR` makes it).
    choices
        How many objects a participant can choose among in `odd-one-out`; chance is 1 / choices.
    item
        The factor whose levels are compared in `two-alternative` and `ranking`, and judged in
        `yes-no`: for instance the method that made an image.
    within
        The factors that are equal for all images that are compared at once.
    level
        The factor whose threshold is sought, or None.
    level_unit
        Its unit, as figures print it.
    conditions
        The factors that split the analysis.
    encoding
        How the images' values relate to light; it must be the set's own.
    """

    set: Name
    choices: int | None = Field(default=None, ge=2, le=9)
    item: str | None = None
    within: tuple[str, ...] = ()
    level: str | None = None
    level_unit: str = ""
    conditions: tuple[str, ...] = ()
    encoding: Literal["srgb"] = "srgb"


class Design(_Part):
    """The order of the main trials.

    Attributes
    ----------
    kind
        `factorial`: every main stimulus; `pairs`: every pair of items within the same levels of
        the other factors, left and right balanced; `sets`: all such items at once. The order is
        another one for every participant.
    repeats
        How often each stimulus, pair or set is shown; no image follows itself where that can be.
    seed
        With the participant's number it fixes every order.
    """

    kind: Literal["factorial", "pairs", "sets"] = "factorial"
    repeats: int = Field(default=1, ge=1, le=100)
    seed: int = Field(ge=0)


class Practice(_Part):
    """Trials before the main ones, with the set's practice stimuli."""

    trials: int = Field(ge=0, le=100)
    feedback: bool = True


class Timing(_Part):
    """Durations within a trial.

    Attributes
    ----------
    blank_s
        The empty screen before each stimulus.
    time_limit_s
        How long an answer may take, or None for no limit; a trial without an answer in that time
        is stored with the answer None.
    """

    blank_s: float = Field(default=0.5, ge=0, le=10)
    time_limit_s: float | None = Field(default=None, gt=0, le=3600)


class Consent(_Part):
    """What a participant agrees to; its version is stored with the session."""

    version: Text
    text: Text


class Screen(_Part):
    """The smallest usable window, in CSS pixels on the web and in pixels in the lab."""

    minimum_width_px: int = Field(default=0, ge=0, le=10_000)
    minimum_height_px: int = Field(default=0, ge=0, le=10_000)


class Stopping(_Part):
    """How many complete participants end the collection."""

    participants: int = Field(ge=1)


class Exclusion(_Part):
    """Who is left out of the analysis; declared before the first answer.

    Attributes
    ----------
    incomplete
        Leave out participants who did not finish.
    shortest_median_s
        Leave out participants whose median time per main answer is below this.
    catch_level
        Of `odd-one-out`: main trials at this level or above are catch trials, plain to see for who
        pays attention. They only tell whose answers count, and are in no result themselves.
    least_catch_share
        Leave out participants who are right in a smaller share of the catch trials.
    largest_late_share
        Leave out participants who saw late frames in a larger share of the main trials.
    """

    incomplete: bool = True
    shortest_median_s: float | None = Field(default=None, gt=0)
    catch_level: float | None = None
    least_catch_share: float | None = Field(default=None, gt=0, le=1)
    largest_late_share: float | None = Field(default=None, ge=0, lt=1)


class Analysis(_Part):
    """What is tested; declared before the first answer.

    Attributes
    ----------
    equivalence_margin
        Of `two-alternative`: how far from one half the share of answers for an item of a pair may
        lie and the two still count as equally good, such as 0.1; None: equivalence is not tested.
    """

    equivalence_margin: float | None = Field(default=None, gt=0, lt=0.5)


class Study(_Part):
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
            part: {key for key in keys if getattr(getattr(self, part), key) in (None, ())}
            for part, keys in _LATER_KEYS.items()
        }
        if self.analysis == Analysis():
            said_nothing["analysis"] = True
        content = self.model_dump_json(exclude=said_nothing)
        return hashlib.sha256(content.encode()).hexdigest()

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
        if rule.catch_level is not None and self.task != "odd-one-out":
            raise ValueError(f"exclusion.catch_level: the task {self.task} has no use for it")
        if self.analysis.equivalence_margin is not None and self.task != "two-alternative":
            raise ValueError(f"analysis.equivalence_margin: the task {self.task} has no use for it")
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


def check_presented(study: Study, runner: str) -> None:
    """Check that a runner can show a study's task.

    Raises
    ------
    UnavailableError
        If it cannot yet.
    """
    if study.task not in _PRESENTED:
        raise UnavailableError(
            f"task: the {runner} runner does not show {study.task} yet; simulated observers take"
            " it, and answers that were collected elsewhere can be analysed"
        )


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
