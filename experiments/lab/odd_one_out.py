"""`odd-one-out` in the window: one image with numbered objects."""

from collections.abc import Sequence

from experiments.lab.presenter import Presentation, Scene
from experiments.lab.task_view import ObjectsView
from experiments.lab.window import Drawable
from experiments.planning.trials import Answer, Trial


class OddOneOutView(ObjectsView):
    """Shows an image; a click on an object, or its number, is the answer."""

    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""
        picture = self.loaded[trial.stimuli[0]]
        return Presentation([Scene([picture])], picture.label_of)

    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""
        assert isinstance(right, int)
        return [self.loaded[trial.stimuli[0]].outlined(right)], self.text("odd_one_out.right")
