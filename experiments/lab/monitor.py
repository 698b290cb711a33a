"""What PsychoPy's Monitor Center knows of a monitor."""

from dataclasses import dataclass

import numpy as np

from algorithms.errors import InputError


@dataclass(frozen=True)
class Monitor:
    """A monitor as it was measured; None for what is not known.

    Attributes
    ----------
    name
        Its name in the Monitor Center.
    width_cm
        The width of what it shows.
    distance_cm
        How far the eyes are from it.
    gamma
        What its light follows, one number or one for each of red, green and blue.
    """

    name: str | None = None
    width_cm: float | None = None
    distance_cm: float | None = None
    gamma: tuple[float, ...] | None = None

    def uncorrected(self) -> object:
        """Return PsychoPy's own monitor of this size and distance, which corrects no gamma."""
        from psychopy import monitors

        monitor = monitors.Monitor("uncorrected")
        # Others, ioHub among them, may have saved something under that name.
        monitor.newCalib(width=self.width_cm, distance=self.distance_cm)
        return monitor


def find_monitor(name: str | None) -> Monitor:
    """Return a monitor of the Monitor Center by its name; without a name nothing is known.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    from psychopy import monitors

    if name is None:
        return Monitor()
    known = monitors.getAllMonitors()
    if name not in known:
        raise InputError(
            f"monitor: {name!r} is not in PsychoPy's Monitor Center; there are: {', '.join(known)}"
        )
    found = monitors.Monitor(name)
    gamma = None if found.gammaIsDefault() else tuple(np.ravel(found.getGamma()).tolist())
    return Monitor(name, found.getWidth() or None, found.getDistance() or None, gamma)
