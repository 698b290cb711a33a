"""Eye tracking through PsychoPy's ioHub: any tracker that it knows, or the mouse in its place."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from algorithms.errors import InputError, UnavailableError
from experiments.gaze import Place, pixels_per_degree
from experiments.lab.geometry import Placement
from experiments.lab.window import LabWindow
from experiments.planning.trials import Trial

if TYPE_CHECKING:
    import pandas as pd

TrackerConfig = Mapping[str, Mapping[str, Any]]
"""ioHub's configuration of one device: its settings by the name of its class."""

_TRACKERS: Final = "eyetracker.hw."
_MOUSE: Final = "eyetracker.hw.mouse."
# The tracker keeps a limited number of samples: they are fetched before it throws any away.
_FETCH_EVERY_S: Final = 0.2


def read_tracker(path: Path) -> TrackerConfig:
    """Read which eye tracker is used from a TOML file: ioHub's device settings, as its docs say.

    ::

        ["eyetracker.hw.mouse.EyeTracker"]
        runtime_settings = { sampling_rate = 100 }

    Raises
    ------
    InputError
        If the file cannot be read or names anything but one eye tracker.
    """
    try:
        given = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not a TOML file ({error})") from error
    if len(given) != 1 or not all(
        name.startswith(_TRACKERS) and isinstance(part, dict) for name, part in given.items()
    ):
        raise InputError(
            f'{path}: {", ".join(given) or "nothing"} given, one table ["{_TRACKERS}...EyeTracker"]'
            " with ioHub's settings accepted"
        )
    return given


class EyeTracker:
    """An eye tracker that records, in pixels of the window and on its clock.

    Parameters
    ----------
    window
        What is looked at.
    device
        ioHub's tracker.
    name
        The class of the tracker.
    """

    def __init__(self, window: LabWindow, device: Any, name: str) -> None:  # noqa: ANN401
        self._window, self._device = window, device
        self.name = name
        self._events: list[Any] = []
        self._fetched_s = 0.0

    @property
    def degree_px(self) -> float:
        """Pixels of the window per degree of visual angle."""
        screen = self._window.screen
        return pixels_per_degree(
            screen["width_px"], screen["monitor_width_cm"], screen["distance_cm"]
        )

    def calibrate(self) -> str:
        """Let the tracker calibrate itself and return what it says; the mouse needs none."""
        if self.name.startswith(_MOUSE):
            return "none needed"
        return str(self._device.runSetupProcedure())

    def start(self) -> None:
        """Begin to record."""
        self._events = []
        self._device.clearEvents()
        self._device.setRecordingState(True)

    def fetch(self) -> None:
        """Fetch what was recorded meanwhile; to be called once a frame."""
        if self._window.time_s() - self._fetched_s >= _FETCH_EVERY_S:
            self._events += self._device.getEvents()
            self._fetched_s = self._window.time_s()

    def stop(self, onset_s: float) -> "pd.DataFrame":
        """End the recording; return its samples from the onset on, as `write_gaze` takes them."""
        self._events += self._device.getEvents()
        self._device.setRecordingState(False)
        return self._samples(onset_s)

    def _samples(self, onset_s: float) -> "pd.DataFrame":
        import pandas as pd

        rows = {}  # by time: a sample that comes twice counts once
        for event in self._events:
            gaze = _gaze_of(event)
            if gaze is not None and event.time >= onset_s:
                rows[event.time - onset_s] = gaze
        times_s = sorted(rows)
        x = [self._window.width_px / 2 + rows[time_s][0] for time_s in times_s]
        y = [self._window.height_px / 2 - rows[time_s][1] for time_s in times_s]
        valid = [rows[time_s][2] for time_s in times_s]
        columns = {"time_s": times_s, "x_window_px": x, "y_window_px": y}
        return pd.DataFrame(columns, dtype=float).assign(valid=valid)


def places_of(trial: Trial, placements: Sequence[Placement]) -> list[Place]:
    """Return where each image of a trial is in the window."""
    return [
        Place(
            stimulus,
            each.area.left_px,
            each.area.top_px,
            each.area.width_px,
            each.area.height_px,
            each.scale,
        )
        for stimulus, each in zip(trial.stimuli, placements, strict=True)
    ]


def _gaze_of(event: Any) -> tuple[float, float, bool] | None:  # noqa: ANN401
    """Return x and y from the window's middle, y upwards, and whether they are valid.

    None for what is no sample. Of two eyes the mean of those that the tracker has.
    """
    from psychopy.iohub.constants import EventConstants

    if event.type == EventConstants.MONOCULAR_EYE_SAMPLE:
        return event.gaze_x, event.gaze_y, event.status == 0
    if event.type not in (EventConstants.BINOCULAR_EYE_SAMPLE, EventConstants.GAZEPOINT_SAMPLE):
        return None
    # Tens tell of the left eye, ones of the right: 2 where it is lost.
    lost = event.status // 10 >= 2, event.status % 10 >= 2
    eyes = (event.left_gaze_x, event.left_gaze_y), (event.right_gaze_x, event.right_gaze_y)
    seen = [eye for eye, gone in zip(eyes, lost, strict=True) if not gone] or list(eyes)
    x, y = (sum(axis) / len(seen) for axis in zip(*seen, strict=True))
    return x, y, not all(lost)


@contextmanager
def open_eye_tracker(config: TrackerConfig, window: LabWindow) -> Iterator[EyeTracker]:
    """Start ioHub with a tracker, and end it afterwards, whatever happens.

    Raises
    ------
    InputError
        If nothing is known of the monitor's size and distance.
    UnavailableError
        If the tracker cannot be started.
    """
    screen = window.screen
    if not screen["monitor_width_cm"] or not screen["distance_cm"]:
        raise InputError(
            "monitor: an eye tracker needs one whose width and distance PsychoPy knows (--monitor)"
        )
    ((name, settings),) = config.items()
    hub = _launch({name: {**settings, "name": "tracker"}}, window)
    try:
        device = getattr(hub.devices, "tracker", None)
        if device is None:
            raise UnavailableError(f"eye tracker: {name} could not be started; is it connected?")
        yield EyeTracker(window, device, name)
    finally:
        with redirect_stdout(StringIO()):  # ioHub tells there of its end
            hub.quit()


def _launch(devices: TrackerConfig, window: LabWindow) -> Any:  # noqa: ANN401
    from psychopy.iohub.client.connect import launchHubServer

    try:
        return launchHubServer(window=window.psychopy_window, **devices)
    except Exception as error:  # ioHub has no class of its own for what a device may lack
        ((name, _),) = devices.items()
        raise UnavailableError(f"eye tracker: {name} could not be started ({error})") from error
