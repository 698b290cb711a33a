"""The square in a corner of the window that a photodiode reads: white while a stimulus is shown."""

from dataclasses import dataclass

from algorithms.errors import InputError
from experiments.lab.geometry import Area

CORNERS = ("top-left", "top-right", "bottom-left", "bottom-right")
LIT_RGB = (255, 255, 255)
DARK_RGB = (0, 0, 0)


@dataclass(frozen=True)
class Photodiode:
    """Where the square is.

    Attributes
    ----------
    corner
        `top-left`, `top-right`, `bottom-left` or `bottom-right`.
    size_px
        Its side; 1 or more.
    """

    corner: str
    size_px: int = 40

    def __post_init__(self) -> None:
        if self.corner not in CORNERS:
            raise InputError(f"photodiode: {self.corner!r} given, {', '.join(CORNERS)} accepted")
        if self.size_px < 1:
            raise InputError(f"photodiode_size: {self.size_px} given, 1 or more accepted")

    def area(self, width_px: int, height_px: int) -> Area:
        """Return the square's place in a window of that size."""
        down, across = self.corner.split("-")
        left_px = width_px - self.size_px if across == "right" else 0
        top_px = height_px - self.size_px if down == "bottom" else 0
        return Area(left_px, top_px, self.size_px, self.size_px)
