"""How a task's trials look in the window: what the runner asks of every task."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from experiments.lab.geometry import Area, Placement, Size, fit
from experiments.lab.pictures import OUTLINE_RGB, Picture, image_size, load_picture, shown_image
from experiments.lab.presenter import Presentation, stimulus_area
from experiments.lab.texts import text
from experiments.lab.visual_angle import image_width_px
from experiments.lab.window import Drawable, LabWindow, Movable
from experiments.planning.designs import arrange
from experiments.planning.trials import Answer, Trial
from experiments.study import Study, chosen
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

    Raises
    ------
    InputError
        If the study says degrees, and size or distance of the monitor are not known.
    """

    def __init__(self, window: LabWindow, study: Study, stimuli: StimulusSet) -> None:
        self.window = window
        self.study = study
        self.stimuli = stimuli
        self.area = stimulus_area(window)
        self.width_px = image_width_px(
            study.display, window.pixels_per_cm, window.monitor.distance_cm
        )
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

    def check_fit(self) -> None:
        """Check that the images fit into the window if the study says how wide they are.

        Raises
        ------
        InputError
            If they do not, or a file cannot be read.
        """
        if self.width_px is None:
            return
        main = chosen(self.study, self.stimuli, "main")
        at_once = max(len(shown) for shown in arrange(self.study, main))
        if self.study.task == "ranking" and self.study.catch is not None:
            at_once += 1
        sizes_px = [
            image_size(self.stimuli, stimulus)
            for stimulus in (*main, *chosen(self.study, self.stimuli, "practice"))
        ]
        tallest = max(sizes_px, key=lambda size: size[1] / size[0])
        self.places([tallest] * at_once)

    @abstractmethod
    def places(self, sizes_px: Sequence[Size]) -> list[Area]:
        """Return where images of these sizes lie when they are shown at once.

        Raises
        ------
        InputError
            If they do not fit at the width that the study says.
        """

    def placements(self, trial: Trial) -> list[Placement]:
        """Return where the images of a trial lie at its onset."""
        sizes_px = [image_size(self.stimuli, self.stimuli[each]) for each in trial.stimuli]
        return [
            Placement(area, *size)
            for area, size in zip(self.places(sizes_px), sizes_px, strict=True)
        ]

    @abstractmethod
    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""

    @abstractmethod
    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""


class ObjectsView(TaskView[Picture]):
    """A task whose images have numbered objects to choose from."""

    @property
    def picture_area(self) -> Area:
        """The part of the window that an image may fill."""
        return self.area

    def _load(self, stimulus: Stimulus) -> Picture:
        return load_picture(self.window, self.stimuli, stimulus, self.picture_area, self.width_px)

    def places(self, sizes_px: Sequence[Size]) -> list[Area]:
        """Return where images of these sizes lie when they are shown at once."""
        return [fit(*size, self.picture_area, self.width_px).area for size in sizes_px]


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
