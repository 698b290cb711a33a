"""One trial: a blank screen, what is shown in it, and the first answer to it."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from experiments.answers import Measurement
from experiments.lab.geometry import Area
from experiments.lab.inputs import KeyPress, Press
from experiments.lab.pages import FOOTING_BAND, HEADING_BAND, heading
from experiments.lab.window import Drawable, Frames, LabWindow
from experiments.planning.trials import Answer
from experiments.responses import Input
from experiments.study_parts import Timing

_TRACK_RGB = (112, 112, 112)
_DONE_RGB = (176, 176, 176)


@dataclass(frozen=True)
class Scene:
    """What is shown for a while; without a duration until the answer."""

    parts: Sequence[Drawable]
    duration_s: float = math.inf


@dataclass(frozen=True)
class Presentation:
    """What a trial shows and how it is answered.

    Attributes
    ----------
    asked
        The scenes in which the trial can be answered; the first of them is the onset.
    answer_of
        Returns the answer that a key or a click means, or None for none; it is told of every press.
    before
        What comes before, each with a duration.
    """

    asked: Sequence[Scene]
    answer_of: Callable[[Press], Answer]
    before: Sequence[Scene] = ()


@dataclass(frozen=True)
class Outcome:
    """An answer (None: not in time) and what was measured of its trial."""

    answer: Answer
    measured: Measurement


@dataclass(frozen=True)
class Surround:
    """What is drawn around every stimulus: the question above, the progress below.

    Nothing without a question.
    """

    window: LabWindow
    question: Drawable | None
    track: Drawable

    def parts(self, done: float) -> tuple[Drawable, ...]:
        """Prepare the question and the progress, `done` from 0 to 1, for drawing."""
        if self.question is None:
            return ()
        bar = _progress_area(self.window)
        width_px = round(done * bar.width_px)
        if not width_px:
            return self.question, self.track
        area = Area(bar.left_px, bar.top_px, width_px, bar.height_px)
        return self.question, self.track, self.window.bar(area, _DONE_RGB)


def prepare_surround(window: LabWindow, question: str | None) -> Surround:
    """Return what is drawn around every stimulus."""
    track = window.bar(_progress_area(window), _TRACK_RGB)
    return Surround(window, heading(window, question) if question else None, track)


def stimulus_area(window: LabWindow) -> Area:
    """Return the part of the window that a stimulus may fill."""
    top_px = round(HEADING_BAND * window.height_px)
    bottom_px = round(FOOTING_BAND * window.height_px)
    return Area(0, top_px, window.width_px, window.height_px - top_px - bottom_px)


def present(
    window: LabWindow,
    shown: Presentation,
    surround: Surround,
    timing: Timing,
    name: str,
    done: float,
    at_onset: Callable[[], None],
    each_frame: Callable[[], None] = lambda: None,
) -> Outcome | None:
    """Show one trial until it is answered, its time is over or Escape is pressed.

    Parameters
    ----------
    window, shown, surround
        What is shown, and where.
    timing
        The blank before the stimulus and the time limit; every scene appears in the frame nearest
        to the end of the one before.
    name
        What the trial is called to the experimenter.
    done
        The share of trials answered so far.
    at_onset
        Called at once when the stimulus' first frame is on the screen.
    each_frame
        Called after each later frame.

    Returns
    -------
    The outcome, or None after Escape. Its times are exact to one frame.
    """
    around = surround.parts(done)
    window.start_frames()
    parts: Sequence[Drawable] = ()
    requested_s = window.flip() + timing.blank_s
    for scene in shown.before:
        _hold(window, parts, requested_s)
        parts = (*scene.parts, *around)
        requested_s = window.show(parts) + scene.duration_s
    _hold(window, parts, requested_s)
    window.on_flip(at_onset)
    onset_s = window.show((*shown.asked[0].parts, *around), lit=True)
    if any(_is_escape(press) for press in window.take_presses()):
        return None  # all other presses before the onset are no answers
    window.announce(name)
    given = _ask(window, shown, around, onset_s, timing.time_limit_s, each_frame)
    if given is None:
        return None
    return _outcome(*given, (requested_s, onset_s), window.end_frames())


def _hold(window: LabWindow, parts: Sequence[Drawable], until_s: float) -> None:
    """Show something up to the frame nearest to a time."""
    while window.next_frame_s < until_s - window.frame_s / 2:
        window.show(parts)


def _ask(
    window: LabWindow,
    shown: Presentation,
    around: Sequence[Drawable],
    onset_s: float,
    time_limit_s: float | None,
    each_frame: Callable[[], None],
) -> tuple[Answer, Press | None] | None:
    """Show the scenes to an answer or the end of the last; return it, or None after Escape."""
    scenes = list(shown.asked)
    ends_s = onset_s + scenes[0].duration_s
    while True:
        shown_s = window.show((*scenes[0].parts, *around), lit=True)
        each_frame()
        for press in window.take_presses():
            if _is_escape(press):
                return None
            answer = shown.answer_of(press)
            if answer is not None:
                return answer, press
        if time_limit_s is not None and shown_s - onset_s >= time_limit_s:
            return None, None
        if window.next_frame_s >= ends_s - window.frame_s / 2:
            if len(scenes) == 1:
                return None, None
            scenes.pop(0)
            ends_s += scenes[0].duration_s


def _outcome(
    answer: Answer, press: Press | None, onset_s: tuple[float, float], frames: Frames
) -> Outcome:
    requested_s, measured_s = onset_s
    return Outcome(
        answer,
        Measurement(
            reaction_time_s=None if press is None else press.time_s - measured_s,
            onset_requested_s=requested_s,
            onset_measured_s=measured_s,
            frame_interval_s=frames.interval_s,
            dropped_frames=frames.dropped,
            input=_input(press),
        ),
    )


def _input(press: Press | None) -> Input:
    if press is None:
        return "none"
    return "keyboard" if isinstance(press, KeyPress) else "mouse"


def _is_escape(press: Press) -> bool:
    return isinstance(press, KeyPress) and press.key == "escape"


def _progress_area(window: LabWindow) -> Area:
    height_px = max(3, round(0.008 * window.height_px))
    middle_px = round((1 - FOOTING_BAND / 2) * window.height_px)
    width_px = round(0.4 * window.width_px)
    return Area((window.width_px - width_px) // 2, middle_px - height_px // 2, width_px, height_px)
