"""`ranking` in the window: images in numbered places, brought into order by mouse or keyboard."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot

from experiments.lab.buttons import BUTTON_RGB, Buttons, above_buttons
from experiments.lab.geometry import Area, Size, fit_grid
from experiments.lab.inputs import Click, KeyPress, Press, Release
from experiments.lab.pictures import OUTLINE_RGB
from experiments.lab.presenter import Presentation, Scene
from experiments.lab.task_view import MARK_WIDTH_PX, PlainPicture, PlainTaskView
from experiments.lab.window import Drawable, LabWindow, Text
from experiments.ordering import Order
from experiments.planning.trials import Answer, Trial

_CAPTION = 0.05  # of the window's height
_TEXT = 0.026
_TIE_MARGIN_PX = 8
_LOOSE_RGB = (112, 112, 112)
_STEPS = {"left": -1, "up": -1, "right": 1, "down": 1}


@dataclass
class _Drag:
    """An image that follows the pointer."""

    source: int
    grip_px: tuple[int, int]  # from the image's upper left corner


class Board:
    """Images in places, best first.

    The mouse drags an image into another place. An image is selected by the arrow keys; a digit
    puts it into that place, and once Space has picked it up the arrows move it. Where ties are
    allowed, `=` (the key, or a click above a place) makes the image as good as the one before.

    Parameters
    ----------
    window, area
        Where it is.
    pictures
        The images in the order shown.
    ends
        What the ends are called, best first.
    ties
        Whether images may share a rank.
    width_px
        How wide the widest image is shown; None: as large as they fit.
    """

    def __init__(
        self,
        window: LabWindow,
        area: Area,
        pictures: Sequence[PlainPicture],
        ends: tuple[str, str],
        *,
        ties: bool,
        width_px: int | None = None,
    ) -> None:
        self._window, self._pictures, self._ties = window, pictures, ties
        caption_px = caption_height_px(window)
        sizes_px = [picture.size_px for picture in pictures]
        self._places = fit_grid(sizes_px, area, caption_px=caption_px, width_px=width_px)
        self._captions = [
            Area(place.left_px, place.top_px - caption_px, place.width_px, caption_px)
            for place in self._places
        ]
        self._frames = {
            held: [window.frame(place, rgb, MARK_WIDTH_PX) for place in self._places]
            for held, rgb in ((False, BUTTON_RGB), (True, OUTLINE_RGB))
        }
        self._ends = (ends[0], *("" for _ in pictures[2:]), ends[1])
        self._tie_buttons = {
            tied: [window.bar(_tie_area(caption), rgb) for caption in self._captions]
            for tied, rgb in ((False, _LOOSE_RGB), (True, BUTTON_RGB))
        }
        self._texts: dict[tuple[str, Area], Text] = {}
        self._order = Order.as_shown(len(pictures))
        self._selected: int | None = None
        self._held = False
        self._drag: _Drag | None = None

    @property
    def ranks(self) -> tuple[int, ...]:
        """The rank of each image in the order shown."""
        return self._order.ranks()

    def show_ranks(self, ranks: Sequence[int]) -> None:
        """Bring the images into the order of these ranks."""
        self._order = Order(tuple(sorted(range(len(ranks)), key=lambda image: ranks[image])))

    def draw(self) -> None:
        """Draw captions and images into the next frame, the dragged one above the others."""
        for place, caption in enumerate(self._captions):
            self._draw_caption(place, caption)
        pointer_px = self._window.pointer_px
        order = self._order if self._drag is None else self._preview(self._drag, pointer_px)
        for place, image in enumerate(order.images):
            if self._drag is None or image != self._order.images[self._drag.source]:
                self._pictures[image].at(self._places[place]).draw()
        if self._drag is not None:
            image = self._order.images[self._drag.source]
            self._pictures[image].at(self._dragged_area(self._drag, pointer_px)).draw()
        elif self._selected is not None:
            self._frames[self._held][self._selected].draw()

    def take(self, press: Press) -> None:
        """Do what a key or the mouse asks for."""
        if isinstance(press, KeyPress):
            self._take_key(press.key)
        elif isinstance(press, Click):
            self._take_click(press)
        elif isinstance(press, Release) and self._drag is not None:
            # The pointer may have gone on within the frame: where it was let go counts.
            let_go_px = (press.x_px, press.y_px)
            self._order, self._drag = self._preview(self._drag, let_go_px), None

    def _take_key(self, key: str) -> None:
        place = self._selected if self._selected is not None else 0
        if key in _STEPS:
            step = 0 if self._selected is None else _STEPS[key]
            target = min(len(self._places) - 1, max(0, place + step))
            if self._held:
                self._order = self._order.moved(place, target)
            self._selected = target
        elif self._selected is None:
            return
        elif key == "space":
            self._held = not self._held
        elif key == "equal" and self._ties:
            self._order = self._order.with_tie_changed(place)
        elif key.isdigit() and int(key) <= len(self._places):
            self._order = self._order.moved(place, int(key) - 1)
            self._selected = int(key) - 1

    def _take_click(self, click: Click) -> None:
        self._selected, self._held = None, False
        for place, area in enumerate(self._places):
            if area.holds(click.x_px, click.y_px):
                self._drag = _Drag(place, (click.x_px - area.left_px, click.y_px - area.top_px))
            elif self._ties and _tie_area(self._captions[place]).holds(click.x_px, click.y_px):
                self._order = self._order.with_tie_changed(place)

    def _dragged_area(self, drag: _Drag, pointer_px: tuple[int, int]) -> Area:
        (x_px, y_px), place = pointer_px, self._places[drag.source]
        left_px, top_px = x_px - drag.grip_px[0], y_px - drag.grip_px[1]
        return Area(left_px, top_px, place.width_px, place.height_px)

    def _preview(self, drag: _Drag, pointer_px: tuple[int, int]) -> Order:
        """Return the order that letting go of the dragged image there would make."""
        area = self._dragged_area(drag, pointer_px)
        nearest = min(
            range(len(self._places)),
            key=lambda place: hypot(
                self._places[place].left_px - area.left_px, self._places[place].top_px - area.top_px
            ),
        )
        return self._order.moved(drag.source, nearest)

    def _draw_caption(self, place: int, area: Area) -> None:
        words = f"{self._order.rank_of_place(place)}   {self._ends[place]}".rstrip()
        self._text(words, area).draw()
        if self._ties and place > 0:
            self._tie_buttons[place in self._order.tied][place].draw()
            self._text("=", _tie_area(area)).draw()

    def _text(self, words: str, area: Area) -> Text:
        """Return a text in the middle of an area, made once."""
        if (words, area) not in self._texts:
            middle = (area.left_px + area.width_px / 2, area.top_px + area.height_px / 2)
            size_px = _TEXT * self._window.height_px
            self._texts[words, area] = self._window.text(words, *middle, size_px)
        return self._texts[words, area]


def caption_height_px(window: LabWindow) -> int:
    """Return the height of the line above each place."""
    return round(_CAPTION * window.height_px)


def _tie_area(caption: Area) -> Area:
    """Return where the button is that makes a place as good as the one before."""
    side_px = caption.height_px - 2 * _TIE_MARGIN_PX
    left_px = caption.left_px + caption.width_px - side_px
    return Area(left_px, caption.top_px + _TIE_MARGIN_PX, side_px, side_px)


class RankingView(PlainTaskView):
    """Shows images to be brought into order; the answer is what stands there at the end."""

    def places(self, sizes_px: Sequence[Size]) -> list[Area]:
        """Return where images of these sizes lie when they are shown at once."""
        area, caption_px = above_buttons(self.area, self.window), caption_height_px(self.window)
        return fit_grid(sizes_px, area, caption_px=caption_px, width_px=self.width_px)

    @property
    def how_to(self) -> str:
        """How the trials are answered, for the instructions."""
        return self.text("ranking.how_to_ties" if self.study.answers.ties else "ranking.how_to")

    def present(self, trial: Trial) -> Presentation:
        """Prepare a trial, its stimuli loaded."""
        board = self._board(trial, ties=self.study.answers.ties)
        done = Buttons(self.window, self.area, [self.text("ranking.done")])

        def answer_of(press: Press) -> Answer:
            clicked = isinstance(press, Click) and done.number_of(press) is not None
            if clicked or (isinstance(press, KeyPress) and press.key == "enter"):
                return board.ranks
            board.take(press)
            return None

        return Presentation([Scene([board, *done.parts])], answer_of)

    def mark(self, trial: Trial, right: Answer) -> tuple[Sequence[Drawable], str]:
        """Prepare a trial with its right answer marked, and say which that is."""
        assert isinstance(right, tuple)
        board = self._board(trial, ties=False)
        board.show_ranks(right)
        return [board], self.text("ranking.right")

    def _board(self, trial: Trial, *, ties: bool) -> Board:
        return Board(
            self.window,
            above_buttons(self.area, self.window),
            self.pictures(trial),
            self.study.answers.labels or (self.text("ranking.best"), self.text("ranking.worst")),
            ties=ties,
            width_px=self.width_px,
        )
