"""Where an image lies in a window, and which of its pixels a click meets."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Area:
    """A rectangle of a window, in pixels from the window's upper left corner."""

    left_px: int
    top_px: int
    width_px: int
    height_px: int


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
    scale = min(1.0, available.width_px / image_width_px, available.height_px / image_height_px)
    width_px = max(1, int(image_width_px * scale))
    height_px = max(1, int(image_height_px * scale))
    area = Area(
        available.left_px + (available.width_px - width_px) // 2,
        available.top_px + (available.height_px - height_px) // 2,
        width_px,
        height_px,
    )
    return Placement(area, image_width_px, image_height_px)
