"""`pick` in the window: one image with numbered objects, of which some are picked."""

from collections.abc import Sequence

from experiments.lab.buttons import Buttons, above_buttons
from experiments.lab.geometry import Area
from experiments.lab.inputs import Click, KeyPress, Press
from experiments.lab.pictures import Picture
from experiments.lab.presenter import Presentation, Scene
from experiments.lab.task_view import ObjectsView
from experiments.lab.window import Drawable
from experiments.planning.trials import Answer, Trial


class Picks:
    """A picture whose objects are picked and taken back.

    Parameters
    ----------
    picture
        The picture.
    most
        How many may be picked; one more takes the place of the last.
    """

    def __init__(self, picture: Picture, most: int) -> None:
        self._plain = self._shown = picture
        self._most = most
        self._picked: list[int] = []

    @property
    def labels(self) -> tuple[int, ...]:
        """What is picked, from the smallest label on."""
        return tuple(sorted(self._picked))

    def take(self, press: Press) -> None:
        """Do what a key or a click asks for."""
        label = self._plain.label_of(press)
        if label is None:
            return
        if label in self._picked:
            self._picked.remove(label)
        else:
            self._picked = [*self._picked[: self._most - 1], label]
        self._shown = self._plain.outlined(*self._picked)

    def draw(self) -> None:
        """Draw the picture with a line around each object that is picked."""
        self._shown.draw()


class PickView(ObjectsView):
    """Shows an image; the answer is what is picked when it is said to be done."""

    @property
    def how_to(self) -> str:
        """How the trials are answered, for the instructions."""
        least, most = self._bounds
        return self.text("pick.how_to", picks=most if least == most else f"{least}-{most}")

    @property
    def picture_area(self) -> Area:
        """The part of the window that an image may fill."""
        return above_buttons(self.area, self.window)

    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""
        least, most = self._bounds
        picks = Picks(self.loaded[trial.stimuli[0]], most)
        done = Buttons(self.window, self.area, [self.text("pick.done")])

        def answer_of(press: Press) -> Answer:
            clicked = isinstance(press, Click) and done.number_of(press) is not None
            if clicked or (isinstance(press, KeyPress) and press.key == "enter"):
                return picks.labels if len(picks.labels) >= least else None
            picks.take(press)
            return None

        return Presentation([Scene([picks, *done.parts])], answer_of)

    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""
        assert isinstance(right, tuple)
        return [self.loaded[trial.stimuli[0]].outlined(*right)], self.text("pick.right")

    @property
    def _bounds(self) -> tuple[int, int]:
        assert self.study.answers.picks is not None  # the study has seen to it
        return self.study.answers.picks
