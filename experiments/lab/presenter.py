"""One trial: a blank screen, the stimulus, and the first answer to it."""

from dataclasses import dataclass

from experiments.answers import Measurement
from experiments.lab.geometry import Area
from experiments.lab.inputs import Click, KeyPress, Press
from experiments.lab.pages import FOOTING_BAND, HEADING_BAND, heading
from experiments.lab.pictures import Picture
from experiments.lab.window import Drawable, Frames, LabWindow
from experiments.responses import Input
from experiments.study import Timing
from experiments.trials import Answer

_TRACK_RGB = (112, 112, 112)
_DONE_RGB = (176, 176, 176)


@dataclass(frozen=True)
class Outcome:
    """An answer (None: not in time) and what was measured of its trial."""

    answer: Answer
    measured: Measurement


@dataclass(frozen=True)
class Surround:
    """What is drawn around every stimulus: the question above, the progress below."""

    window: LabWindow
    question: Drawable
    track: Drawable

    def parts(self, done: float) -> tuple[Drawable, ...]:
        """Prepare the question and the progress, `done` from 0 to 1, for drawing."""
        bar = _progress_area(self.window)
        width_px = round(done * bar.width_px)
        if not width_px:
            return self.question, self.track
        area = Area(bar.left_px, bar.top_px, width_px, bar.height_px)
        return self.question, self.track, self.window.bar(area, _DONE_RGB)


def prepare_surround(window: LabWindow, question: str) -> Surround:
    """Return what is drawn around every stimulus."""
    track = window.bar(_progress_area(window), _TRACK_RGB)
    return Surround(window, heading(window, question), track)


def stimulus_area(window: LabWindow) -> Area:
    """Return the part of the window that a stimulus may fill."""
    top_px = round(HEADING_BAND * window.height_px)
    bottom_px = round(FOOTING_BAND * window.height_px)
    return Area(0, top_px, window.width_px, window.height_px - top_px - bottom_px)


def present(
    window: LabWindow, picture: Picture, surround: Surround, timing: Timing, name: str, done: float
) -> Outcome | None:
    """Show one trial until it is answered, its time is over or Escape is pressed.

    Parameters
    ----------
    window, picture, surround
        What is shown, and where.
    timing
        The blank before the stimulus and the time limit; the stimulus appears in the frame
        nearest to the end of the blank.
    name
        What the trial is called to the experimenter.
    done
        The share of trials answered so far.

    Returns
    -------
    The outcome, or None after Escape. Its times are exact to one frame.
    """
    parts = (picture, *surround.parts(done))
    window.start_frames()
    requested_s = window.flip() + timing.blank_s
    while window.time_s() < requested_s - window.frame_s / 2:
        window.flip()
    onset_s = window.show(parts)
    if any(_is_escape(press) for press in window.take_presses()):
        return None  # all other presses before the onset are no answers
    window.announce(name)
    while True:
        shown_s = window.show(parts)
        for press in window.take_presses():
            if _is_escape(press):
                return None
            label = picture.label_of(press)
            if label is not None:
                onset = (requested_s, onset_s)
                return _outcome(label, press, onset, window.end_frames())
        if timing.time_limit_s is not None and shown_s - onset_s >= timing.time_limit_s:
            return _outcome(None, None, (requested_s, onset_s), window.end_frames())


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
    match press:
        case KeyPress():
            return "keyboard"
        case Click():
            return "mouse"
        case None:
            return "none"


def _is_escape(press: Press) -> bool:
    return isinstance(press, KeyPress) and press.key == "escape"


def _progress_area(window: LabWindow) -> Area:
    height_px = max(3, round(0.008 * window.height_px))
    middle_px = round((1 - FOOTING_BAND / 2) * window.height_px)
    width_px = round(0.4 * window.width_px)
    return Area((window.width_px - width_px) // 2, middle_px - height_px // 2, width_px, height_px)
