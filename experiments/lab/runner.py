"""Running a study in the lab: one participant, one PsychoPy window, the rows of every runner."""

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from algorithms.errors import InputError
from algorithms.files import make_folder
from experiments.answers import response_in
from experiments.lab import pages
from experiments.lab.arrival import Entrant, ask_entrant, check_number, known_entrant
from experiments.lab.eye_tracker import TrackerConfig
from experiments.lab.gaze import Gaze, check_tracker, open_gaze
from experiments.lab.opening import open_window
from experiments.lab.pages import Page, show_page
from experiments.lab.pictures import Picture
from experiments.lab.presenter import Outcome, Surround, prepare_surround, present
from experiments.lab.progress import Progress, Status
from experiments.lab.psychopy_files import PsychoPyFiles
from experiments.lab.task_view import TaskView
from experiments.lab.tasks import view_of
from experiments.lab.texts import text
from experiments.lab.triggers import TriggerPlan, Triggers, check_triggers, open_triggers
from experiments.lab.window import LabWindow, WindowSettings
from experiments.planning.course import Course, course_of
from experiments.planning.right_answers import right_answer
from experiments.planning.trials import Answer, Assignment, Trial
from experiments.responses import POOL, Session
from experiments.storage.pool import assignment_of
from experiments.storage.store import NewSession, Store
from experiments.study import Study, check_stimuli
from stimuli.manifest import StimulusSet


def run_lab(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    *,
    demographics: Mapping[str, Any] | None,
    folder: Path,
    participant: str | None = None,
    participant_number: int | None = None,
    pilot: bool = False,
    settings: WindowSettings | None = None,
    triggers: TriggerPlan | None = None,
    eye_tracker: TrackerConfig | None = None,
    watch: Callable[[Status], None] = lambda _status: None,
) -> Session | None:
    """Run a study with one participant in a PsychoPy window.

    The same participant's unfinished session goes on at the first trial without an answer. Every
    answer is stored before the next trial begins.

    Parameters
    ----------
    study, stimuli, store
        What is run, and where its answers are kept.
    demographics
        What the participant said of themself: the fields that the study asks for; not looked at
        where an unfinished session goes on. None: a form in the window asks for them, and for the
        participant.
    folder
        Where PsychoPy's own CSV and psydat files go, and gaze.
    participant, participant_number
        Who (letters, digits, `_` and `-`), and the number, 1 or more, that fixes the order of the
        trials; the store gives those that are None.
    pilot
        Mark the answers as given for trying the study out.
    settings
        The window; None for a full screen.
    triggers
        Which codes go to which port when a stimulus appears and when it is answered.
    eye_tracker
        What records gaze during the trials; `free-viewing` cannot do without.
    watch
        Told how far the sitting is, once a page or trial is on the screen (`form`, `consent`,
        `instructions`, `trial 3`, `feedback 3`, `main`, `pause`, `thanks`).

    Returns
    -------
    The session, complete or not; None if the participant did not agree to take part, or the form
    was left.

    Raises
    ------
    InputError
        If an argument is not accepted, the participant has finished, or the window is too small
        for the study.
    UnavailableError
        If PsychoPy or a display is missing, the port of the triggers, or the eye tracker.
    """
    check_stimuli(study, stimuli)
    check_tracker(study, eye_tracker)
    course_of(study, stimuli, Assignment(1))  # a design that the stimuli do not allow is refused
    if triggers is not None:
        check_triggers(triggers, stimuli)
    entrant = known_entrant(study, stimuli, store, participant, demographics)
    if entrant is None or entrant.earlier is None:
        check_number(study, store, participant_number)
    make_folder(folder)
    store.register(study, stimuli)
    with ExitStack() as opened:
        progress = Progress(watch)
        window = opened.enter_context(open_window(settings or WindowSettings(), progress.announce))
        _check_size(study, window)
        view = view_of(window, study, stimuli)
        view.check_fit()
        codes = None
        if triggers is not None:
            codes = opened.enter_context(open_triggers(triggers, stimuli, window))
        gaze = opened.enter_context(open_gaze(eye_tracker, window, folder, store))
        entrant = entrant or ask_entrant(window, study, stimuli, store, participant)
        if entrant is None:
            return None
        new = partial(NewSession, runner="lab", pilot=pilot, participant_number=participant_number)
        session = _begin(study, stimuli, store, window, entrant, new)
        if session is None:
            return None
        files = PsychoPyFiles(folder, study, session, window.refresh_hz)
        events = store.events(session=session.id, kind=POOL)
        answers = store.answers(session.id)
        course = course_of(study, stimuli, assignment_of(session, events), answers)
        if triggers is not None:
            store.add_event(session.id, "triggers", triggers.model_dump(mode="json"))
        gaze.begin(session)
        progress.begin(session.participant, len(answers), course.limit)
        _Run(
            study, stimuli, store, session, window, view, files, course, codes, gaze, progress
        ).to_the_end()
    return store.session(session.id)


def _check_size(study: Study, window: LabWindow) -> None:
    least = (study.screen.minimum_width_px, study.screen.minimum_height_px)
    if window.width_px < least[0] or window.height_px < least[1]:
        raise InputError(
            f"screen: the window is {window.width_px} x {window.height_px} pixels,"
            f" {study.name} needs {least[0]} x {least[1]}"
        )


def _begin(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    window: LabWindow,
    entrant: Entrant,
    new: Callable[..., NewSession],
) -> Session | None:
    """Go on with the session that was left, or begin one if the participant agrees to take part."""
    if entrant.earlier is not None:
        return _taken_up(store, entrant.earlier, window)
    if show_page(window, pages.consent_page(study), ("enter", "escape")) == "escape":
        return None
    details = new(
        device=window.device,
        screen=window.screen,
        demographics=entrant.demographics,
        participant=entrant.participant,
    )
    session, _ = store.begin_session(study, stimuli, details)
    return session


def _taken_up(store: Store, session: Session, window: LabWindow) -> Session:
    """Note that a session goes on, perhaps elsewhere; its rows name the device of their sitting."""
    detail = {"device": window.device, "screen": window.screen}
    store.add_event(session.id, "resume", detail)
    return replace(session, device=window.device)


class _Left(Exception):  # noqa: N818 - no error
    """The participant left before the end."""


@dataclass(frozen=True)
class _Run:
    """One sitting of a session."""

    study: Study
    stimuli: StimulusSet
    store: Store
    session: Session
    window: LabWindow
    view: TaskView[Any]
    files: PsychoPyFiles
    course: Course
    triggers: Triggers | None
    gaze: Gaze
    progress: Progress

    def to_the_end(self) -> None:
        """Show all that is left of the session, or leave early at the participant's wish."""
        try:
            self._load()
            if self.course.next is not None:
                self._explain()
            self._show_trials()
        except _Left:
            return
        except BaseException as error:
            detail = {"error": f"{type(error).__name__}: {error}"}
            self.store.add_event(self.session.id, "failure", detail)
            raise
        code = self.store.complete(self.session.id, self.course.estimates())
        show_page(self.window, pages.thanks_page(self.study, code))

    def _explain(self) -> None:
        example = pages.example_of(self.study, self.stimuli)
        page = pages.instructions_page(self.study, self.view.how_to, example)
        picture = None
        if example is not None:
            picture = pages.example_picture(self.window, self.stimuli, example)
        self._show_or_pause(page, picture)

    def _show_trials(self) -> None:
        asks = self.study.task != "free-viewing"  # a text beside the image would draw the eyes
        surround = prepare_surround(self.window, self.study.question if asks else None)
        if not asks:
            self.window.hide_pointer()
        before: Trial | None = None
        while (trial := self.course.next) is not None:
            if before is not None and before.phase == "practice" != trial.phase:
                left = self.course.limit - trial.index
                self._show_or_pause(pages.main_page(self.study, left))
            outcome = self._present(trial, surround)
            try:
                self._mark_answer(trial, outcome.answer)
                self.gaze.keep(self.session, trial, self.view.placements(trial), outcome)
            finally:  # a device that fails costs no answer
                self._record(trial, outcome)
            self.course.take(trial.index, outcome.answer)
            self.progress.answered(outcome.measured, self.course.limit)
            if trial.feedback:
                self._give_feedback(trial, outcome.answer)
            before = trial

    def _load(self) -> None:
        """Load every stimulus that may still be shown onto the graphics card."""
        left = self.course.possible
        for number, identifier in enumerate(sorted(left), start=1):
            self.view.load(identifier).draw()
            self.window.discard()
            self._show_loading(number, len(left))

    def _show_loading(self, loaded: int, total: int) -> None:
        middle = (self.window.width_px / 2, self.window.height_px / 2)
        told = text(self.study, "loading", loaded=loaded, total=total)
        self.window.show([self.window.text(told, *middle, 0.03 * self.window.height_px)])

    def _present(self, trial: Trial, surround: Surround) -> Outcome:
        """Present a trial, again after each pause."""
        done = trial.index / self.course.limit
        timing, name = self.study.timing, f"trial {trial.index}"
        while True:
            self.gaze.start()
            shown = self.view.present(trial)
            at_onset = partial(self._mark_onset, trial)
            outcome = present(
                self.window, shown, surround, timing, name, done, at_onset, self.gaze.fetch
            )
            if outcome is not None:
                return outcome
            self._pause(name)

    def _mark_answer(self, trial: Trial, answer: Answer) -> None:
        if self.triggers is not None:
            self.triggers.answered(trial, answer)

    def _mark_onset(self, trial: Trial) -> None:
        if self.triggers is not None:
            self.triggers.onset(trial)

    def _show_or_pause(self, page: Page, picture: Picture | None = None) -> None:
        while show_page(self.window, page, ("enter", "escape"), picture) == "escape":
            self._pause(page.name)

    def _pause(self, place: str) -> None:
        """Show the pause page; raise `_Left` if the participant leaves there."""
        self.store.add_event(self.session.id, "pause", {"at": place})
        if show_page(self.window, pages.pause_page(self.study), ("enter", "escape")) == "escape":
            self.store.add_event(self.session.id, "leave", {"at": place})
            raise _Left
        self.store.add_event(self.session.id, "continue", {"at": place})

    def _record(self, trial: Trial, outcome: Outcome) -> None:
        response = response_in(
            self.course.trials,
            self.study,
            self.session,
            trial.index,
            outcome.answer,
            outcome.measured,
        )
        self.store.record(response, self.course.decision(trial.index))
        self.files.add(response)

    def _give_feedback(self, trial: Trial, answer: Answer) -> None:
        right = right_answer(self.study, self.stimuli, trial)
        if right is not None:
            marked, name = self.view.mark(trial, right)
            verdict = "feedback.right" if answer == right else "feedback.wrong"
            told = text(self.study, verdict, right=name)
            prompt = text(self.study, "feedback.prompt")
            pages.show_feedback(self.window, trial, marked, told, prompt)
