"""`free-viewing` in the window: one image for a while, and nothing else."""

from collections.abc import Sequence

from experiments.lab.geometry import Area, Size, fit_grid
from experiments.lab.presenter import Presentation, Scene
from experiments.lab.task_view import PlainTaskView
from experiments.lab.window import Drawable
from experiments.planning.trials import Answer, Trial


class FreeViewingView(PlainTaskView):
    """Shows an image for as long as the study says; there is nothing to answer."""

    @property
    def how_to(self) -> str:
        """How the trials are answered, for the instructions."""
        return self.text("free_viewing.how_to", image_s=f"{self.study.timing.image_s:g}")

    def places(self, sizes_px: Sequence[Size]) -> list[Area]:
        """Return where images of these sizes lie when they are shown at once."""
        return fit_grid(sizes_px, self.area, columns=1, width_px=self.width_px)

    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""
        duration_s = self.study.timing.image_s
        assert duration_s is not None  # the study has seen to it
        (picture,) = self.pictures(trial)
        (area,) = self.places([picture.size_px])
        return Presentation([Scene([picture.at(area)], duration_s)], lambda _: None)

    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Refuse: nothing is asked, so nothing is right."""
        raise NotImplementedError
