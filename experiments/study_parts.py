"""The parts of a study file: what each table of it may say."""

import math
import re
from collections.abc import Mapping
from typing import Annotated, Literal, Self
from urllib.parse import quote

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    StringConstraints,
    field_validator,
    model_validator,
)

from stimuli.manifest import Factor

Name = Annotated[str, StringConstraints(pattern=r"^[a-z0-9][a-z0-9-]{0,63}$")]
Text = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1)]
Parameter = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,39}$")]
Gamut = Literal["srgb", "p3", "rec2020"]
DemographicsField = Literal["age", "gender", "artistic_background"]

Task = Literal["odd-one-out", "two-alternative", "yes-no", "ranking", "pick", "free-viewing"]


class Part(BaseModel):
    """A table of the file: frozen, and nothing in it but what is known."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Stimuli(Part):
    """Which stimuli are shown, and what of them is analysed.

    Attributes
    ----------
    set
        The name of the stimulus set (`trompe stimuli make SET DIR` makes it).
    made_by
        The command that makes the images, for who has not got them yet.
    choices
        How many objects a participant can choose among in `odd-one-out` and `pick`.
    item
        The factor whose levels are compared in `two-alternative` and `ranking`, and judged in
        `yes-no`: for instance the method that made an image.
    within
        The factors that are equal for all images that are compared at once.
    only
        By factor, the levels whose stimuli take part; a factor that is not named takes all.
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
    made_by: str = ""
    choices: int | None = Field(default=None, ge=2, le=9)
    item: str | None = None
    within: tuple[str, ...] = ()
    only: Mapping[str, tuple[Factor, ...]] = Field(default_factory=dict)
    level: str | None = None
    level_unit: str = ""
    conditions: tuple[str, ...] = ()
    encoding: Literal["srgb"] = "srgb"


class Staircase(Part):
    """How the level of the next trial follows from the last answers, in each track.

    Attributes
    ----------
    down, up
        So many right answers in a row make it harder, so many wrong ones easier.
    steps
        How many levels of the set each change goes, the next one after each reversal.
    up_factor
        How many times as far it goes up as down.
    start
        The level of the first trial, the nearest that there is; None: the largest.
    reversals
        A track ends with so many changes of direction, or None;
    trials
        at the latest after so many trials.
    """

    down: int = Field(default=2, ge=1, le=10)
    up: int = Field(default=1, ge=1, le=10)
    steps: tuple[Annotated[int, Field(ge=1, le=100)], ...] = Field(default=(2, 1), min_length=1)
    up_factor: int = Field(default=1, ge=1, le=20)
    start: float | None = Field(default=None, allow_inf_nan=False)
    reversals: int | None = Field(default=None, ge=1, le=1000)
    trials: int = Field(default=40, ge=1, le=1000)


class QuestPlus(Part):
    """What is thought possible of the psychometric function of each track, and when it is known.

    Attributes
    ----------
    thresholds
        How many thresholds, evenly from the smallest to the largest level, all equally likely.
    widths
        The widths (from 5 % to 95 %), in the level's unit; none: an eighth to all of that range.
    lapse_rates
        The shares of wrong answers however clear the difference.
    sd
        A track ends once the standard deviation of its threshold is at most this, or None;
    trials
        at the latest after so many trials.
    """

    thresholds: int = Field(default=61, ge=2, le=1000)
    widths: tuple[Annotated[float, Field(gt=0, allow_inf_nan=False)], ...] = Field(
        default=(), max_length=100
    )
    lapse_rates: tuple[Annotated[float, Field(ge=0, lt=0.5)], ...] = Field(
        default=(0.02,), min_length=1, max_length=20
    )
    sd: float | None = Field(default=None, gt=0)
    trials: int = Field(default=40, ge=1, le=1000)


class ActivePairs(Part):
    """How pairs are chosen by what is known already.

    Attributes
    ----------
    trials
        How many pairs a participant compares, catch trials not counted.
    each_image
        Until every image has been compared so often, by all participants together, those that
        lack most come first; then the most informative pairs.
    spread
        The standard deviation of the images' qualities that is expected, in just-objectionable
        differences.
    """

    trials: int = Field(ge=1, le=1000)
    each_image: int = Field(default=2, ge=0, le=1000)
    spread: float = Field(default=2.0, gt=0, le=100)


class Design(Part):
    """The order of the main trials.

    Attributes
    ----------
    kind
        `factorial`: every main stimulus; `pairs`: every pair of items within the same levels of
        the other factors, left and right balanced; `sets`: all such items at once. The order is
        another one for every participant. Adaptive, by the answers so far: `staircase` and
        `quest-plus` choose among the set's levels in one track for each combination of
        `stimuli.conditions`, in random turns; `active-pairs` chooses pairs.
    repeats
        How often each stimulus, pair or set is shown; no image follows itself where that can be.
    one_of_each, distinct
        Of `factorial`: show a participant one stimulus, drawn at random, for each level of the
        factor `one_of_each`, such that no level of the factor `distinct` comes twice.
    blocks
        The factor whose levels are shown one after the other, each as a block; over the
        participants every level comes equally often in every place and after every other.
    seed
        With the participant's number it fixes every order.
    staircase, quest_plus, active_pairs
        The rules of the adaptive kind of that name.
    """

    kind: Literal["factorial", "pairs", "sets", "staircase", "quest-plus", "active-pairs"] = (
        "factorial"
    )
    repeats: int = Field(default=1, ge=1, le=100)
    one_of_each: str | None = None
    distinct: str | None = None
    blocks: str | None = None
    seed: int = Field(ge=0)
    staircase: Staircase | None = None
    quest_plus: QuestPlus | None = None
    active_pairs: ActivePairs | None = None

    @property
    def is_adaptive(self) -> bool:
        """Whether what is shown depends on the answers."""
        return self.kind in ("staircase", "quest-plus", "active-pairs")

    @model_validator(mode="after")
    def _check_rules(self) -> Self:
        """Refuse rules of another kind of design, and what an adaptive one has no use for."""
        for key in ("staircase", "quest_plus", "active_pairs"):
            if getattr(self, key) is not None and self.kind != key.replace("_", "-"):
                raise ValueError(f"design.{key}: a design of kind {self.kind!r} has no use for it")
        if self.kind == "active-pairs" and self.active_pairs is None:
            raise ValueError("design.active_pairs: missing")
        for key in ("one_of_each", "distinct", "blocks"):
            if self.is_adaptive and getattr(self, key) is not None:
                raise ValueError(f"design.{key}: a design of kind {self.kind!r} has no use for it")
        if self.kind in ("staircase", "quest-plus") and self.repeats != 1:
            raise ValueError(f"design.repeats: a design of kind {self.kind!r} has no use for it")
        return self


class Practice(Part):
    """Trials before the main ones, with the set's practice stimuli.

    Attributes
    ----------
    trials
        How many, the same for everybody.
    feedback
        Whether the right answer is told, where there is one.
    best_first
        Of `two-alternative` and `ranking`: the items in the order that the feedback calls right.
    """

    trials: int = Field(ge=0, le=100)
    feedback: bool = True
    best_first: tuple[str, ...] = ()


class Catch(Part):
    """Trials plain to see for who pays attention, among the main ones and in no result themselves.

    Attributes
    ----------
    better, worse
        Two items of `stimuli.item`, whether they are compared otherwise or not. A pair is made of
        both; a ranking has the worse one added, and the better one must be ranked above it.
    trials
        How many, drawn from the comparisons that have both items.
    """

    better: Text
    worse: Text
    trials: int = Field(ge=1, le=100)


class Timing(Part):
    """Durations within a trial.

    Attributes
    ----------
    blank_s
        The empty screen before each stimulus.
    image_s
        Of `yes-no` and `two-alternative`: how long an image stays; the answer may come later. None:
        until the answer. Of `free-viewing`: how long each image is shown.
    mask_s
        Of `two-alternative`: show one image after the other, each for `image_s`, and a mask of
        noise for so long after each; 0 for an empty place. None: side by side.
    time_limit_s
        How long an answer may take from the onset (one after the other: of the second image), or
        None for no limit; a trial without an answer in that time is stored with the answer None.
    """

    blank_s: float = Field(default=0.5, ge=0, le=10)
    image_s: float | None = Field(default=None, gt=0, le=3600)
    mask_s: float | None = Field(default=None, ge=0, le=10)
    time_limit_s: float | None = Field(default=None, gt=0, le=3600)

    @property
    def in_turn(self) -> bool:
        """Whether two images are shown one after the other."""
        return self.mask_s is not None

    @model_validator(mode="after")
    def _check_durations(self) -> Self:
        """Refuse a mask without an image that ends, and an image that outlasts the time limit."""
        if self.mask_s is not None and self.image_s is None:
            raise ValueError("timing.image_s: missing; mask_s needs it")
        if not self.in_turn and self.image_s and self.image_s > (self.time_limit_s or math.inf):
            raise ValueError(
                f"timing.image_s: {self.image_s:g} given, at most time_limit_s accepted"
            )
        return self


class Answers(Part):
    """How answers are given.

    Attributes
    ----------
    labels
        Of `yes-no`: what the two buttons say, yes first; of `ranking`: what the two ends of the
        order are called, best first. None: in the runner's own words.
    ties
        Of `ranking`: whether images may share a rank.
    picks
        Of `pick`: how many objects are chosen in an image, at least and at most.
    """

    labels: tuple[Text, Text] | None = None
    ties: bool = False
    picks: tuple[int, int] | None = None

    @field_validator("picks")
    @classmethod
    def _check_picks(cls, picks: tuple[int, int] | None) -> tuple[int, int] | None:
        if picks is not None and not 1 <= picks[0] <= picks[1]:
            raise ValueError(f"{list(picks)} given, [least, most] from 1 on accepted")
        return picks


class Consent(Part):
    """What a participant agrees to; its version is stored with the session."""

    version: Text
    text: Text


class Display(Part):
    """How large images are shown; left out: pixel by pixel where they fit, else smaller.

    Attributes
    ----------
    width_deg
        The width of a trial's widest image in degrees of visual angle, its middle straight ahead;
        the other images of the trial are in proportion.
    width_px
        The same in pixels of the window.
    """

    width_deg: float | None = Field(default=None, gt=0, le=120)
    width_px: int | None = Field(default=None, ge=1, le=10_000)

    @model_validator(mode="after")
    def _check_unit(self) -> Self:
        """Refuse two units at once."""
        if self.width_deg is not None and self.width_px is not None:
            raise ValueError("width_deg, width_px: one of them accepted, not both")
        return self


class Screen(Part):
    """What the screen must be like; all but the window's size is for the web alone.

    Attributes
    ----------
    minimum_width_px, minimum_height_px
        The smallest usable window, in CSS pixels on the web and in pixels in the lab.
    color_gamut
        The least gamut, as the browser tells it, or None for any.
    allow_zoom
        Whether the page may be zoomed by the browser.
    rule
        What becomes of a screen that falls short: `refuse` it, or `flag` its session.
    fullscreen
        Whether the trials ask for the full screen.
    calibrate
        Whether participants match a bank card on the screen, which tells its pixels' size.
    distance
        Whether they then find their blind spot, which tells how far away they sit.
    """

    minimum_width_px: int = Field(default=0, ge=0, le=10_000)
    minimum_height_px: int = Field(default=0, ge=0, le=10_000)
    color_gamut: Gamut | None = None
    allow_zoom: bool = True
    rule: Literal["refuse", "flag"] = "refuse"
    fullscreen: bool = False
    calibrate: bool = False
    distance: bool = False

    @model_validator(mode="after")
    def _check_distance(self) -> Self:
        """Refuse a distance without the size of a pixel."""
        if self.distance and not self.calibrate:
            raise ValueError("distance: needs calibrate = true")
        return self


class Stopping(Part):
    """How many complete participants end the collection.

    Attributes
    ----------
    participants
        As many are wanted. On the web no more may begin than can still be needed: those who are
        under way hold a place.
    abandoned_after_s
        Who has given no answer for so long holds none any more, though they may still go on.
    """

    participants: int = Field(ge=1)
    abandoned_after_s: float = Field(default=3600, ge=60, le=1e7)


class Recruitment(Part):
    """How participants come to the study and leave it, on the web.

    Attributes
    ----------
    parameters
        What of the address is kept with the session. The first tells who somebody is: they come
        back to their own session, so it must be nothing that others guess.
    completion_url
        Where participants are sent when the server has everything; `{PARAMETER}` and
        `{completion_code}` are filled in.
    export
        Whether the parameters stand in exported tables of sessions.
    """

    parameters: tuple[Parameter, ...] = Field(default=(), max_length=10)
    completion_url: str | None = None
    export: bool = False

    @model_validator(mode="after")
    def _check_address(self) -> Self:
        """Refuse what is no address, and what nothing is known of."""
        if len(set(self.parameters)) < len(self.parameters):
            raise ValueError("parameters: each once accepted")
        if self.completion_url is None:
            return self
        if not re.match(r"https?://[^\s{}/]+(/|$)", self.completion_url):
            raise ValueError("completion_url: an http(s) address accepted")
        known = {*self.parameters, "completion_code"}
        for name in re.findall(r"\{(.*?)\}", self.completion_url):
            if name not in known:
                raise ValueError(
                    f"completion_url: {{{name}}} given, accepted: {', '.join(sorted(known))}"
                )
        return self

    def completed_at(self, given: Mapping[str, str], completion_code: str) -> str | None:
        """Return where a participant is sent, with what they came with filled in."""
        address = self.completion_url
        for name, value in {**given, "completion_code": completion_code}.items():
            address = address and address.replace(f"{{{name}}}", quote(value, safe=""))
        return address


class Exclusion(Part):
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
        Leave out participants who are right in a smaller share of the catch trials: those of
        `catch_level`, or those of the study's `catch`.
    largest_late_share
        Leave out participants who saw late frames in a larger share of the main trials.
    """

    incomplete: bool = True
    shortest_median_s: float | None = Field(default=None, gt=0)
    catch_level: float | None = None
    least_catch_share: float | None = Field(default=None, gt=0, le=1)
    largest_late_share: float | None = Field(default=None, ge=0, lt=1)


class Analysis(Part):
    """What is tested; declared before the first answer.

    Attributes
    ----------
    equivalence_margin
        Of `two-alternative`: how far from one half the share of answers for an item of a pair may
        lie and the two still count as equally good, such as 0.1; None: equivalence is not tested.
    """

    equivalence_margin: float | None = Field(default=None, gt=0, lt=0.5)
