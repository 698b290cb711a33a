"""Where an image lies in a window, and which of its pixels a click meets."""

from collections.abc import Sequence
from dataclasses import dataclass

Size = tuple[int, int]

# Between neighbours in a grid, as on the web.
_GAP_SHARE = 0.02
_LEAST_GAP_PX = 8


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


def fit(image_width_px: int, image_height_px: int, available: Area) -> Placement:
    """Place an image in the middle of an area, shrunk to fit and never enlarged.

    Its edges lie on whole pixels of the window, so that an image shown at its own size is shown
    pixel by pixel; the web places images alike.

    Parameters
    ----------
    image_width_px, image_height_px
        The size of the image.
    available
        The area; at least one pixel wide and high.

    Examples
    --------
    >>> fit(200, 100, Area(0, 0, 100, 400)).area
    Area(left_px=0, top_px=175, width_px=100, height_px=50)
    """
    size = (image_width_px, image_height_px)
    area = _centred(size, available, _fitting_scale(size, available.width_px, available.height_px))
    return Placement(area, image_width_px, image_height_px)


def fit_grid(
    sizes_px: Sequence[Size], available: Area, columns: int | None = None, caption_px: int = 0
) -> list[Area]:
    """Place images in a grid in the middle of an area, all at one scale, as large as they fit.

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
    """
    gap_px = max(_LEAST_GAP_PX, round(_GAP_SHARE * available.width_px))
    largest = (max(width for width, _ in sizes_px), max(height for _, height in sizes_px))
    count = len(sizes_px)

    def scale(across: int) -> float:
        down = -(-count // across)
        width_px = (available.width_px - gap_px * (across - 1)) / across
        height_px = (available.height_px - gap_px * (down - 1)) / down - caption_px
        return _fitting_scale(largest, width_px, height_px)

    # Of grids with images of one size, the one with fewest empty places is best.
    across = columns or max(range(count, 0, -1), key=lambda n: (scale(n), -(-count % n)))
    cell = _centred(largest, Area(0, 0, 0, 0), scale(across))
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
            scale(across),
        )
        for n, size in enumerate(sizes_px)
    ]


def _fitting_scale(size_px: Size, width_px: float, height_px: float) -> float:
    return min(1.0, width_px / size_px[0], height_px / size_px[1])


def _centred(size_px: Size, available: Area, scale: float) -> Area:
    width_px, height_px = (max(1, int(side * scale)) for side in size_px)
    return Area(
        available.left_px + (available.width_px - width_px) // 2,
        available.top_px + (available.height_px - height_px) // 2,
        width_px,
        height_px,
    )
