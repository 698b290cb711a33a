"""Simulated viewers: programs that look at images without a task, region after region."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.images import read_labels
from experiments.answers import Measurement, make_response
from experiments.gaze import GAZE, Place, write_gaze
from experiments.planning.trials import Assignment, Trial, planned_trials
from experiments.regions import Regions
from experiments.responses import Session
from experiments.storage.store import NewSession, Store
from experiments.study import Study
from stimuli.manifest import StimulusSet

if TYPE_CHECKING:
    import pandas as pd

Floats = NDArray[np.float64]

# The duration of a saccade by its size, of which the eye tracker of PsychoPy's mouse has the same.
_SACCADE_S, _SACCADE_S_PER_DEG = 0.021, 0.0022


@dataclass(frozen=True)
class Viewer:
    """A viewer who looks at one object after another.

    A fixation's place is drawn anew each time: an object, by its weight, then a point on it. The
    right objects of an image weigh `attraction`, the others 1 each.

    Attributes
    ----------
    attraction
        How much more than others the right objects are looked at, 0 or more.
    fixation_s, spread
        The median duration of a fixation, and the standard deviation of its logarithm.
    noise_deg
        The standard deviation of a sample on each axis.
    lost_share
        The share of samples that the tracker loses, 0 to 1.
    rate_hz, pixels_per_degree
        Of the tracker and the screen.

    Raises
    ------
    InputError
        If one of them is out of its range.

    References
    ----------
    The duration of saccades is that of Carpenter 1988, Movements of the Eyes.
    """

    attraction: float = 1.0
    fixation_s: float = 0.25
    spread: float = 0.4
    noise_deg: float = 0.1
    lost_share: float = 0.01
    rate_hz: float = 100.0
    pixels_per_degree: float = 38.0

    def __post_init__(self) -> None:
        for name, given, low, high in (
            ("attraction", self.attraction, 0.0, np.inf),
            ("spread", self.spread, 0.0, np.inf),
            ("noise_deg", self.noise_deg, 0.0, np.inf),
            ("lost_share", self.lost_share, 0.0, 1.0),
        ):
            if not low <= given <= high:
                raise InputError(f"{name}: {given} given, {low:g} to {high:g} accepted")
        for name in ("fixation_s", "rate_hz", "pixels_per_degree"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name}: {getattr(self, name)} given, more than 0 accepted")

    def look(
        self,
        regions: Regions,
        right: tuple[int, ...],
        duration_s: float,
        generator: np.random.Generator,
    ) -> "pd.DataFrame":
        """Return the samples of one image.

        Parameters
        ----------
        regions
            The label image of its objects.
        right
            The labels that weigh `attraction`.
        duration_s
            How long it is shown.
        generator
            Where chance comes from.

        Returns
        -------
        `time_s` from the onset, `x_window_px`, `y_window_px`, `valid`; the image fills the window.
        """
        import pandas as pd

        times_s = np.arange(0, duration_s, 1 / self.rate_hz)
        knots_s, knots_px = self._path(regions, right, duration_s, generator)
        noise_px = self.noise_deg * self.pixels_per_degree
        x, y = (
            np.interp(times_s, knots_s, axis) + generator.normal(0, noise_px, len(times_s))
            for axis in knots_px.T
        )
        valid = generator.random(len(times_s)) >= self.lost_share
        return pd.DataFrame({"time_s": times_s, "x_window_px": x, "y_window_px": y, "valid": valid})

    def _path(
        self,
        regions: Regions,
        right: tuple[int, ...],
        duration_s: float,
        generator: np.random.Generator,
    ) -> tuple[Floats, Floats]:
        """Return times, and where gaze is at each: it rests between two and moves between two."""
        labels = np.unique(regions[regions > 0])
        weights = np.where(np.isin(labels, right), self.attraction, 1.0)
        if not weights.sum() > 0:
            raise InputError("regions: no object to look at, one or more accepted")
        points = {label: np.argwhere(regions == label)[:, ::-1] + 0.5 for label in labels}
        here = np.array([regions.shape[1] / 2, regions.shape[0] / 2])
        now_s, times_s, places = 0.0, list[float](), list[Floats]()
        while now_s < duration_s:
            rest_s = self.fixation_s * float(generator.lognormal(0, self.spread))
            times_s += [now_s, now_s + rest_s]
            places += [here, here]
            own = points[generator.choice(labels, p=weights / weights.sum())]
            there = own[generator.integers(len(own))]
            degrees = float(np.hypot(*(there - here))) / self.pixels_per_degree
            now_s += rest_s + _SACCADE_S + _SACCADE_S_PER_DEG * degrees
            here = there
        return np.array(times_s), np.array(places)

    def describe(self) -> str:
        """Return the viewer's parameters in one line, as the answers' `device` keeps them."""
        return (
            f"simulated viewer: attraction {self.attraction:g}; fixations of"
            f" {self.fixation_s:g} s; noise {self.noise_deg:g} deg; {self.rate_hz:g} Hz"
        )


def simulate_viewing(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    viewer: Viewer,
    participants: int,
    generator: np.random.Generator,
    folder: Path,
) -> list[Session]:
    """Let simulated viewers take a study of free viewing, straight into a store.

    Parameters
    ----------
    study, stimuli
        What they look at; the images need regions.
    store
        Where their rows go, each flagged `simulated`.
    viewer
        How they look.
    participants
        How many, 1 or more.
    generator
        Where chance comes from.
    folder
        Where the gaze goes (`experiments.gaze`).

    Returns
    -------
    Their sessions, all completed.

    Raises
    ------
    InputError
        If the study's task is another one, or an image has no regions.
    """
    if study.task != "free-viewing":
        raise InputError(f"task: {study.task} given, free-viewing accepted")
    if participants < 1:
        raise InputError(f"participants: {participants} given, 1 or more accepted")
    store.register(study, stimuli)
    return [_take(study, stimuli, store, viewer, generator, folder) for _ in range(participants)]


def _take(
    study: Study,
    stimuli: StimulusSet,
    store: Store,
    viewer: Viewer,
    generator: np.random.Generator,
    folder: Path,
) -> Session:
    new = NewSession("simulation", viewer.describe(), {}, {}, simulated=True)
    session, _ = store.begin_session(study, stimuli, new)
    measured = Measurement(None, None, None, None, None, "none")
    for trial in planned_trials(study, stimuli, Assignment(session.participant_number)):
        detail = _look_at(study, stimuli, session, trial, viewer, generator, folder)
        store.add_event(session.id, GAZE, detail)
        store.record(make_response(study, stimuli, session, trial.index, None, measured))
    store.complete(session.id)
    completed = store.session(session.id)
    assert completed is not None
    return completed


def _look_at(
    study: Study,
    stimuli: StimulusSet,
    session: Session,
    trial: Trial,
    viewer: Viewer,
    generator: np.random.Generator,
    folder: Path,
) -> dict[str, object]:
    (identifier,) = trial.stimuli
    stimulus, duration_s = stimuli[identifier], study.timing.image_s
    assert duration_s is not None  # the study has seen to it
    if stimulus.regions is None:
        raise InputError(f"stimuli: {identifier} has no regions to look at")
    regions = read_labels(stimuli.path(stimulus.regions))
    samples = viewer.look(regions, stimulus.right_labels, duration_s, generator)
    height_px, width_px = regions.shape
    place = Place(identifier, 0, 0, width_px, height_px)
    return write_gaze(folder, session, trial, samples, [place], viewer.pixels_per_degree)
