"""`odd-one-out` in the window: one image with numbered objects."""

from collections.abc import Sequence

from experiments.lab.geometry import Area, Size, fit
from experiments.lab.pictures import Picture, load_picture
from experiments.lab.presenter import Presentation, Scene
from experiments.lab.task_view import TaskView
from experiments.lab.window import Drawable
from experiments.trials import Answer, Trial
from stimuli.manifest import Stimulus


class OddOneOutView(TaskView[Picture]):
    """Shows an image; a click on an object, or its number, is the answer."""

    def _load(self, stimulus: Stimulus) -> Picture:
        return load_picture(self.window, self.stimuli, stimulus, self.area, self.width_px)

    def places(self, sizes_px: Sequence[Size]) -> list[Area]:
        """Return where images of these sizes lie when they are shown at once."""
        return [fit(*size, self.area, self.width_px).area for size in sizes_px]

    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""
        picture = self.loaded[trial.stimuli[0]]
        return Presentation([Scene([picture])], picture.label_of)

    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""
        assert isinstance(right, int)
        return [self.loaded[trial.stimuli[0]].outlined(right)], self.text("odd_one_out.right")
