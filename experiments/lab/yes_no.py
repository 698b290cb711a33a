"""`yes-no` in the window: one image and two buttons."""

from collections.abc import Sequence

from experiments.lab.buttons import Buttons, above_buttons
from experiments.lab.geometry import Area, Size, fit_grid
from experiments.lab.inputs import Press
from experiments.lab.presenter import Presentation, Scene
from experiments.lab.task_view import PlainTaskView
from experiments.lab.window import Drawable
from experiments.planning.trials import Answer, Trial


class YesNoView(PlainTaskView):
    """Shows an image, perhaps for a while only; the first button is yes."""

    @property
    def how_to(self) -> str:
        """How the trials are answered, for the instructions."""
        return self.text("yes_no.how_to", yes=self._labels[0], no=self._labels[1])

    def places(self, sizes_px: Sequence[Size]) -> list[Area]:
        """Return where images of these sizes lie when they are shown at once."""
        area = above_buttons(self.area, self.window)
        return fit_grid(sizes_px, area, columns=1, width_px=self.width_px)

    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""
        buttons = Buttons(self.window, self.area, self._labels)
        scenes = [Scene([*self._picture(trial), *buttons.parts])]
        if self.study.timing.image_s is not None:
            first = Scene(scenes[0].parts, self.study.timing.image_s)
            scenes = [first, Scene(buttons.parts)]

        def answer_of(press: Press) -> Answer:
            number = buttons.number_of(press)
            return None if number is None else 2 - number

        return Presentation(scenes, answer_of)

    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""
        return self._picture(trial), self.text(
            "yes_no.right", answer=self._labels[0 if right == 1 else 1]
        )

    @property
    def _labels(self) -> tuple[str, str]:
        return self.study.answers.labels or (self.text("yes_no.yes"), self.text("yes_no.no"))

    def _picture(self, trial: Trial) -> list[Drawable]:
        (picture,) = self.pictures(trial)
        return [picture.at(*self.places([picture.size_px]))]
