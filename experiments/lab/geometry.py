"""Where an image lies in a window, and which of its pixels a click meets."""

from collections.abc import Sequence
from dataclasses import dataclass

from algorithms.errors import InputError

Size = tuple[int, int]

# Between neighbours in a grid, as on the web.
_GAP_SHARE = 0.02
_LEAST_GAP_PX = 8

# A width that was asked for is not to lose a pixel to the last digit of a scale.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Area:
    """A rectangle of a window, in pixels from the window's upper left corner."""

    left_px: int
    top_px: int
    width_px: int
    height_px: int

    def holds(self, x_px: int, y_px: int) -> bool:
        """Return whether a pixel of the window lies in it."""
        across, down = x_px - self.left_px, y_px - self.top_px
        return 0 <= across < self.width_px and 0 <= down < self.height_px

    def grown(self, by_px: int) -> "Area":
        """Return an area with a margin of that many pixels around this one."""
        return Area(
            self.left_px - by_px,
            self.top_px - by_px,
            self.width_px + 2 * by_px,
            self.height_px + 2 * by_px,
        )


@dataclass(frozen=True)
class Placement:
    """An image scaled into a rectangle of a window.

    Attributes
    ----------
    area
        The rectangle that the image fills.
    image_width_px, image_height_px
        The size of the image itself.
    """

    area: Area
    image_width_px: int
    image_height_px: int

    def image_pixel(self, x_px: int, y_px: int) -> tuple[int, int] | None:
        """Return the image's pixel that is shown at a pixel of the window.

        Parameters
        ----------
        x_px, y_px
            A pixel of the window, counted from 0 at its upper left corner.

        Returns
        -------
        (row, column) of the image's pixel that holds the centre of the window's pixel, or None
        outside the image.
        """
        column = (
            (2 * (x_px - self.area.left_px) + 1) * self.image_width_px // (2 * self.area.width_px)
        )
        row = (
            (2 * (y_px - self.area.top_px) + 1) * self.image_height_px // (2 * self.area.height_px)
        )
        if 0 <= column < self.image_width_px and 0 <= row < self.image_height_px:
            return row, column
        return None

    @property
    def scale(self) -> float:
        """Pixels of the window per pixel of the image."""
        return self.area.width_px / self.image_width_px

    def window_point(self, x_px: float, y_px: float) -> tuple[float, float]:
        """Return the window's point at a point of the image, both in pixels from upper left."""
        return (
            self.area.left_px + x_px * self.area.width_px / self.image_width_px,
            self.area.top_px + y_px * self.area.height_px / self.image_height_px,
        )


def fit(
    image_width_px: int, image_height_px: int, available: Area, width_px: int | None = None
) -> Placement:
    """Place an image in the middle of an area.

    Its edges lie on whole pixels of the window, so that an image shown at its own size is shown
    pixel by pixel; the web places images alike.

    Parameters
    ----------
    image_width_px, image_height_px
        The size of the image.
    available
        The area; at least one pixel wide and high.
    width_px
        How wide the image is shown; None for its own size, shrunk to fit and never enlarged.

    Raises
    ------
    InputError
        If it does not fit at that width.

    Examples
    --------
    >>> fit(200, 100, Area(0, 0, 100, 400)).area
    Area(left_px=0, top_px=175, width_px=100, height_px=50)
    """
    size = (image_width_px, image_height_px)
    scale = _scale(_largest_scale(size, available.width_px, available.height_px), size, width_px)
    area = _centred(size, available, scale)
    return Placement(area, image_width_px, image_height_px)


def fit_grid(
    sizes_px: Sequence[Size],
    available: Area,
    columns: int | None = None,
    caption_px: int = 0,
    width_px: int | None = None,
) -> list[Area]:
    """Place images in a grid in the middle of an area, all at one scale.

    Parameters
    ----------
    sizes_px
        (width, height) of each image.
    available
        The area; neighbours are 2 % of its width apart, as on the web.
    columns
        How many side by side; None for as many as make the images largest.
    caption_px
        The height of the line above each image.
    width_px
        How wide the widest is shown; None: as large as they fit, and never enlarged.

    Raises
    ------
    InputError
        If they do not fit at that width.
    """
    gap_px = max(_LEAST_GAP_PX, round(_GAP_SHARE * available.width_px))
    largest = (max(width for width, _ in sizes_px), max(height for _, height in sizes_px))
    count = len(sizes_px)

    def largest_scale(across: int) -> float:
        down = -(-count // across)
        room_px = (available.width_px - gap_px * (across - 1)) / across
        height_px = (available.height_px - gap_px * (down - 1)) / down - caption_px
        return _largest_scale(largest, room_px, height_px)

    def rank(across: int) -> tuple[float, int]:
        room = largest_scale(across)
        return min(1.0, room) if width_px is None else room, -(-count % across)

    # Of grids with images of one size, the one with fewest empty places is best.
    across = columns or max(range(count, 0, -1), key=rank)
    scale = _scale(largest_scale(across), largest, width_px)
    cell = _centred(largest, Area(0, 0, 0, 0), scale)
    step_px = (cell.width_px + gap_px, cell.height_px + caption_px + gap_px)
    down = -(-count // across)
    left_px = available.left_px + (available.width_px - across * step_px[0] + gap_px) // 2
    top_px = available.top_px + (available.height_px - down * step_px[1] + gap_px) // 2
    return [
        _centred(
            size,
            Area(
                left_px + n % across * step_px[0],
                top_px + n // across * step_px[1] + caption_px,
                cell.width_px,
                cell.height_px,
            ),
            scale,
        )
        for n, size in enumerate(sizes_px)
    ]


def _largest_scale(size_px: Size, width_px: float, height_px: float) -> float:
    return min(width_px / size_px[0], height_px / size_px[1])


def _scale(largest: float, size_px: Size, width_px: int | None) -> float:
    """Return the scale that makes an image so wide, or lets it fit where no width is given."""
    if width_px is None:
        return min(1.0, largest)
    if width_px > largest * size_px[0] + _ROUNDING:
        raise InputError(
            f"display: images {width_px} pixels wide do not fit into the window,"
            f" at most {int(largest * size_px[0] + _ROUNDING)} pixels accepted"
        )
    return width_px / size_px[0]


def _centred(size_px: Size, available: Area, scale: float) -> Area:
    width_px, height_px = (max(1, int(side * scale + _ROUNDING)) for side in size_px)
    return Area(
        available.left_px + (available.width_px - width_px) // 2,
        available.top_px + (available.height_px - height_px) // 2,
        width_px,
        height_px,
    )
