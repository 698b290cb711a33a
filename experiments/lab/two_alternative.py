"""`two-alternative` in the window: two images side by side, or one after the other."""

from collections.abc import Sequence

from experiments.lab.buttons import Buttons, above_buttons
from experiments.lab.geometry import Area, Size, fit_grid
from experiments.lab.inputs import Click, Press
from experiments.lab.mask import draw_mask
from experiments.lab.presenter import Presentation, Scene
from experiments.lab.task_view import PlainPicture, PlainTaskView
from experiments.lab.window import Drawable
from experiments.planning.trials import Answer, Trial

SIDES = ("pair.left", "pair.right_image")
TURNS = ("pair.first", "pair.second")


class TwoAlternativeView(PlainTaskView):
    """Shows two images; a button, or side by side a click on an image, is the answer."""

    @property
    def how_to(self) -> str:
        """How the trials are answered, for the instructions."""
        return self.text("pair.how_to_in_turn" if self.study.timing.in_turn else "pair.how_to")

    def places(self, sizes_px: Sequence[Size]) -> list[Area]:
        """Return where images of these sizes lie: side by side, or each in the same place."""
        area = above_buttons(self.area, self.window)
        if self.study.timing.in_turn:
            return [fit_grid([size], area, width_px=self.width_px)[0] for size in sizes_px]
        return fit_grid(sizes_px, area, columns=2, width_px=self.width_px)

    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""
        if self.study.timing.in_turn:
            return self._in_turn(trial)
        return self._side_by_side(trial)

    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""
        assert isinstance(right, int)
        pictures, areas = self.pictures(trial), self._sides(trial)
        shown = [picture.at(area) for picture, area in zip(pictures, areas, strict=True)]
        marked = self.marked(areas[right - 1])
        return [*shown, marked], self.text("pair.right", image=self._names[right - 1])

    @property
    def _names(self) -> list[str]:
        return [self.text(key) for key in (TURNS if self.study.timing.in_turn else SIDES)]

    def _sides(self, trial: Trial) -> list[Area]:
        return self.places([picture.size_px for picture in self.pictures(trial)])

    def _side_by_side(self, trial: Trial) -> Presentation:
        areas, buttons = self._sides(trial), Buttons(self.window, self.area, self._names)
        pictures = [
            picture.at(area) for picture, area in zip(self.pictures(trial), areas, strict=True)
        ]
        scenes = [Scene([*pictures, *buttons.parts])]
        if self.study.timing.image_s is not None:
            scenes = [Scene(scenes[0].parts, self.study.timing.image_s), Scene(buttons.parts)]

        def answer_of(press: Press) -> Answer:
            if isinstance(press, Click):
                for place, area in enumerate(areas, start=1):
                    if area.holds(press.x_px, press.y_px):
                        return place
            return buttons.number_of(press)

        return Presentation(scenes, answer_of)

    def _in_turn(self, trial: Trial) -> Presentation:
        timing, buttons = self.study.timing, Buttons(self.window, self.area, self._names)
        assert timing.image_s is not None
        assert timing.mask_s is not None
        images, masks = [], []
        for number, picture in enumerate(self.pictures(trial)):
            (area,) = self.places([picture.size_px])
            images.append(picture.at(area))
            masks.append(self._mask(picture, area, 2 * trial.index + number))
        first, second = (Scene([image], timing.image_s) for image in images)
        hidden, ended = (Scene([mask], timing.mask_s) for mask in masks)
        asked = [
            Scene([*second.parts, *buttons.parts], timing.image_s),
            *([Scene([*ended.parts, *buttons.parts], timing.mask_s)] if timing.mask_s else []),
            Scene(buttons.parts),
        ]
        before = [first, *([hidden] if timing.mask_s else [])]
        return Presentation(asked, buttons.number_of, before)

    def _mask(self, picture: PlainPicture, area: Area, seed: int) -> Drawable:
        return self.window.image(draw_mask(*picture.size_px, seed), area)
