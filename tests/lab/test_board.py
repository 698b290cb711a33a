"""The board of rankings, without a window."""

from types import SimpleNamespace
from typing import Any, cast

import pytest

from experiments.lab.geometry import Area, fit_grid
from experiments.lab.inputs import Click, KeyPress, Release
from experiments.lab.ranking import Board
from experiments.lab.task_view import PlainPicture
from experiments.lab.window import LabWindow, Movable

AREA = Area(0, 100, 1000, 500)
SIZE_PX = (200, 100)


@pytest.fixture
def window() -> SimpleNamespace:
    """Draws nothing; its pointer is far away."""

    def nothing(*_: Any, **__: Any) -> SimpleNamespace:  # noqa: ANN401
        return SimpleNamespace(draw=lambda: None)

    return SimpleNamespace(
        width_px=1000, height_px=800, pointer_px=(5, 5), frame=nothing, bar=nothing, text=nothing
    )


def make_board(window: SimpleNamespace, *, ties: bool = True) -> Board:
    shown = cast(LabWindow, window)
    pictures = [PlainPicture(shown, cast(Movable, None), SIZE_PX) for _ in range(3)]
    return Board(shown, AREA, pictures, ("best", "worst"), ties=ties)


def press(board: Board, *keys: str) -> None:
    for key in keys:
        board.take(KeyPress(key, 0.0))


def test_an_image_goes_where_it_was_let_go_wherever_the_pointer_is_by_now(
    window: SimpleNamespace,
) -> None:
    board = make_board(window)
    first, _, third = fit_grid([SIZE_PX] * 3, AREA, caption_px=40)
    board.take(Click(third.left_px + 20, third.top_px + 20, 0.0))
    board.take(Release(first.left_px + 30, first.top_px + 10, 0.1))
    assert board.ranks == (2, 3, 1)
    board.take(Click(first.left_px + 20, first.top_px + 20, 0.2))
    board.take(Release(first.left_px + 20, first.top_px + 20, 0.3))
    assert board.ranks == (2, 3, 1)


def test_keys_select_place_carry_and_tie(window: SimpleNamespace) -> None:
    board = make_board(window)
    press(board, "1")
    assert board.ranks == (1, 2, 3)  # nothing is selected yet
    press(board, "right", "right", "right", "1")
    assert board.ranks == (2, 3, 1)
    press(board, "space", "right", "right", "space", "left")
    assert board.ranks == (1, 2, 3)
    press(board, "equal")
    assert board.ranks == (1, 1, 3)


def test_ties_are_not_to_be_had_where_the_study_forbids_them(window: SimpleNamespace) -> None:
    board = make_board(window, ties=False)
    press(board, "right", "right", "equal", "9")
    assert board.ranks == (1, 2, 3)
