"""What clients send, checked to the letter before anything is done with it."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, field_validator

from experiments.answers import Measurement
from experiments.planning.trials import Answer
from experiments.responses import RESERVED_KINDS, Input

# Bounds only keep nonsense out of the store: no honest client comes near them.
Seconds = Annotated[float, Field(ge=0, le=1e9, allow_inf_nan=False)]
Count = Annotated[int, Field(ge=0, le=1_000_000)]
ShortText = Annotated[str, StringConstraints(max_length=300)]
Word = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z_-]{0,39}$")]
Value = (
    bool
    | Annotated[int, Field(ge=-(10**12), le=10**12)]
    | Annotated[float, Field(allow_inf_nan=False)]
    | ShortText
    | None
)
# So long that nobody guesses it; what a browser draws, or a page calls itself.
Drawn = Annotated[str, StringConstraints(pattern=r"^[0-9a-f-]{32,64}$")]
Recruited = Annotated[
    dict[Annotated[str, StringConstraints(max_length=40)], ShortText], Field(max_length=10)
]
Facts = Annotated[dict[Word, Value], Field(max_length=30)]


class _Message(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class NewSessionMessage(_Message):
    """Consent, and what a participant and the browser say of themselves.

    `arrival` is a number that the browser draws: posted again, it begins no second session.
    """

    consent_version: ShortText
    demographics: dict[Word, Any]
    screen: Facts
    device: ShortText
    arrival: Drawn | None = None
    recruitment: Recruited = Field(default_factory=dict)
    simulated: bool = False


class ReturnMessage(_Message):
    """What a participant came by, of whom there may be a session already."""

    recruitment: Recruited


class LeaseMessage(_Message):
    """The page that has a session open."""

    page: Drawn


class AnswerMessage(_Message):
    """One answer; `id` is made by the client with `responses.response_id`."""

    id: ShortText
    trial_index: Count
    answer: Count | Annotated[list[Count], Field(max_length=100)] | None
    reaction_time_s: Seconds | None
    onset_requested_s: Seconds | None
    onset_measured_s: Seconds | None
    frame_interval_s: Seconds | None
    dropped_frames: Count | None
    input: Input

    def given(self) -> Answer:
        """Return the answer as the rows have it."""
        return tuple(self.answer) if isinstance(self.answer, list) else self.answer

    def measurement(self) -> Measurement:
        """Return what the browser measured."""
        return Measurement(
            reaction_time_s=self.reaction_time_s,
            onset_requested_s=self.onset_requested_s,
            onset_measured_s=self.onset_measured_s,
            frame_interval_s=self.frame_interval_s,
            dropped_frames=self.dropped_frames,
            input=self.input,
        )


class EventMessage(_Message):
    """Something that happened besides answers: `blur`, `resize`, `resume`, `offline`, ..."""

    kind: Word
    detail: Facts = Field(default_factory=dict)

    @field_validator("kind")
    @classmethod
    def _not_the_researchers(cls, kind: str) -> str:
        if kind in RESERVED_KINDS:
            raise ValueError(f"{kind!r} is not for participants to say")
        return kind


class ExclusionMessage(_Message):
    """Why a session is left out of the analysis."""

    reason: Annotated[str, StringConstraints(min_length=1, max_length=500)]
