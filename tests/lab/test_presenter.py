"""Which frame a stimulus appears in, on a display that is never late."""

from collections.abc import Callable, Iterable
from typing import cast

from hypothesis import given
from hypothesis import strategies as st

from experiments.lab.inputs import KeyPress
from experiments.lab.presenter import Presentation, Scene, Surround, present
from experiments.lab.window import Drawable, Frames, LabWindow
from experiments.study_parts import Timing

FRAME_S = 1 / 60
NEAREST_S = FRAME_S / 2 + 1e-9
FIRST, SECOND = cast(Drawable, "first"), cast(Drawable, "second")


class Display:
    """A window that shows a frame every 60th of a second and is answered at once."""

    frame_s = FRAME_S

    def __init__(self) -> None:
        self.next_frame_s = FRAME_S
        self.shown: list[tuple[float, tuple[Drawable, ...], bool]] = []
        self.calls: list[Callable[[], None]] = []

    def flip(self) -> float:
        return self.show(())

    def show(self, parts: Iterable[Drawable], *, lit: bool = False) -> float:
        now_s, self.next_frame_s = self.next_frame_s, self.next_frame_s + FRAME_S
        self.shown.append((now_s, tuple(parts), lit))
        while self.calls:
            self.calls.pop()()
        return now_s

    def on_flip(self, call: Callable[[], None]) -> None:
        self.calls.append(call)

    def take_presses(self) -> list[KeyPress]:
        return [KeyPress("1", self.next_frame_s)]

    def announce(self, name: str) -> None:
        assert name == "trial 0"

    def start_frames(self) -> None: ...

    def end_frames(self) -> Frames:
        return Frames(FRAME_S, 0)


class NoSurround:
    def parts(self, done: float) -> tuple[Drawable, ...]:
        assert done == 0.0
        return ()


@given(st.floats(0, 1), st.floats(0.02, 1))
def test_images_appear_in_the_frame_nearest_to_the_moment_asked_for(
    blank_s: float, first_s: float
) -> None:
    """Theory: within half a frame; no sooner than the frame after the one before."""
    display, marked = Display(), []
    outcome = present(
        cast(LabWindow, display),
        Presentation([Scene([SECOND])], lambda _: 1, [Scene([FIRST], first_s)]),
        cast(Surround, NoSurround()),
        Timing(blank_s=blank_s),
        "trial 0",
        0.0,
        lambda: marked.append(len(display.shown)),
    )
    assert outcome is not None
    measured = outcome.measured
    assert measured.onset_requested_s is not None
    assert measured.onset_measured_s is not None
    first_at_s = next(time_s for time_s, parts, _ in display.shown if FIRST in parts)
    asked_s = display.shown[0][0] + max(blank_s, FRAME_S / 2)
    assert abs(first_at_s - asked_s) <= NEAREST_S
    assert measured.onset_requested_s == first_at_s + first_s
    assert abs(measured.onset_measured_s - measured.onset_requested_s) <= NEAREST_S
    onset = next(n for n, (_, parts, _) in enumerate(display.shown) if SECOND in parts)
    assert display.shown[onset][0] == measured.onset_measured_s
    assert marked == [onset + 1]  # within the flip of that frame
    assert [lit for _, _, lit in display.shown] == [
        SECOND in parts for _, parts, _ in display.shown
    ]
