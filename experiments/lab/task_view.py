"""How a task's trials look in the window: what the runner asks of every task."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from experiments.lab.geometry import Area, Size
from experiments.lab.pictures import OUTLINE_RGB, shown_image
from experiments.lab.presenter import Presentation, stimulus_area
from experiments.lab.texts import text
from experiments.lab.window import Drawable, LabWindow, Movable
from experiments.study import Study
from experiments.trials import Answer, Trial
from stimuli.manifest import Stimulus, StimulusSet

MARK_WIDTH_PX = 4

Loaded = TypeVar("Loaded", bound=Drawable)


@dataclass(frozen=True)
class PlainPicture:
    """An image on the graphics card, to be drawn wherever it is wanted."""

    window: LabWindow
    image: Movable
    size_px: Size

    def draw(self) -> None:
        """Draw it where it was put last."""
        self.image.draw()

    def at(self, area: Area) -> "PlainPicture":
        """Put it into an area, and return it."""
        self.window.move(self.image, area)
        return self


class TaskView(ABC, Generic[Loaded]):
    """Shows the trials of a study in a window.

    Parameters
    ----------
    window, study, stimuli
        What is shown, and where.
    """

    def __init__(self, window: LabWindow, study: Study, stimuli: StimulusSet) -> None:
        self.window = window
        self.study = study
        self.stimuli = stimuli
        self.area = stimulus_area(window)
        self.loaded: dict[str, Loaded] = {}

    def load(self, identifier: str) -> Loaded:
        """Load a stimulus onto the graphics card and keep it.

        Raises
        ------
        InputError
            If its file cannot be read.
        """
        self.loaded[identifier] = loaded = self._load(self.stimuli[identifier])
        return loaded

    @abstractmethod
    def _load(self, stimulus: Stimulus) -> Loaded: ...

    def text(self, key: str, **values: object) -> str:
        """Return a text in the study's language."""
        return text(self.study, key, **values)

    @property
    def how_to(self) -> str:
        """How the trials are answered, for the instructions; nothing where the study says it."""
        return ""

    @abstractmethod
    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""

    @abstractmethod
    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""


class PlainTaskView(TaskView[PlainPicture]):
    """A task whose images are shown as they are."""

    def _load(self, stimulus: Stimulus) -> PlainPicture:
        image = shown_image(self.stimuli, stimulus)
        whole = Area(0, 0, image.width, image.height)
        return PlainPicture(self.window, self.window.image(image, whole), image.size)

    def pictures(self, trial: Trial) -> list[PlainPicture]:
        """Return the loaded images of a trial, in their places."""
        return [self.loaded[identifier] for identifier in trial.stimuli]

    def marked(self, area: Area) -> Drawable:
        """Prepare a line around an area."""
        return self.window.frame(area, OUTLINE_RGB, MARK_WIDTH_PX)
