"""The gaze of a session in the lab: recorded trial by trial, where there is an eye tracker."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from algorithms.errors import InputError
from experiments.gaze import GAZE, write_gaze
from experiments.lab.eye_tracker import EyeTracker, TrackerConfig, open_eye_tracker, places_of
from experiments.lab.geometry import Placement
from experiments.lab.presenter import Outcome
from experiments.lab.window import LabWindow
from experiments.planning.trials import Trial
from experiments.responses import Session
from experiments.storage.store import Store
from experiments.study import Study


class Gaze:
    """Keeps the gaze of a session's trials; without an eye tracker it does nothing.

    Parameters
    ----------
    eyes
        The eye tracker, or None.
    folder
        Where the files go (`experiments.gaze.write_gaze`).
    store
        Its events tell of them.
    """

    def __init__(self, eyes: EyeTracker | None, folder: Path, store: Store) -> None:
        self._eyes, self._folder, self._store = eyes, folder, store

    def begin(self, session: Session) -> None:
        """Calibrate the tracker for a session, and note what it said."""
        if self._eyes is not None:
            told = {"tracker": self._eyes.name, "calibration": self._eyes.calibrate()}
            self._store.add_event(session.id, "eye-tracker", told)

    def start(self) -> None:
        """Begin to record a trial; what was recorded and not kept is forgotten."""
        if self._eyes is not None:
            self._eyes.start()

    def fetch(self) -> None:
        """Fetch what was recorded meanwhile; to be called once a frame."""
        if self._eyes is not None:
            self._eyes.fetch()

    def keep(
        self, session: Session, trial: Trial, placements: Sequence[Placement], outcome: Outcome
    ) -> None:
        """Write what was recorded of a trial, and tell the store where."""
        onset_s = outcome.measured.onset_measured_s
        if self._eyes is not None and onset_s is not None:
            samples, places = self._eyes.stop(onset_s), places_of(trial, placements)
            degree_px = self._eyes.degree_px
            detail = write_gaze(self._folder, session, trial, samples, places, degree_px)
            self._store.add_event(session.id, GAZE, detail)


def check_tracker(study: Study, config: TrackerConfig | None) -> None:
    """Check that there is an eye tracker where the task cannot do without.

    Raises
    ------
    InputError
        If there is none.
    """
    if study.task == "free-viewing" and config is None:
        raise InputError("eye_tracker: none given; free-viewing records gaze (--eye-tracker FILE)")


@contextmanager
def open_gaze(
    config: TrackerConfig | None, window: LabWindow, folder: Path, store: Store
) -> Iterator[Gaze]:
    """Start the eye tracker, if there is one, and end it afterwards.

    Raises
    ------
    InputError, UnavailableError
        As `open_eye_tracker`.
    """
    if config is None:
        yield Gaze(None, folder, store)
        return
    with open_eye_tracker(config, window) as eyes:
        yield Gaze(eyes, folder, store)
