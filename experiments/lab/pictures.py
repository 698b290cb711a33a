"""Stimuli in the window: their image, the numerals of their objects, an outlined object."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from PIL import Image

from algorithms.errors import InputError
from algorithms.images import read_labels
from experiments.lab.geometry import Area, Placement, Size, fit
from experiments.lab.inputs import KeyPress, Press, Release
from experiments.lab.window import Drawable, LabWindow
from experiments.regions import Point, Regions, numeral_places, outline
from stimuli.manifest import Stimulus, StimulusSet

OUTLINE_RGB = (255, 214, 10)

# A numeral's square and its distance from its object, in pixels of the window, as on the web.
_NUMERAL_SIZE_PX = 20
_NUMERAL_GAP_PX = 2
_NUMERAL_TEXT_PX = 14
_OUTLINE_WIDTH = 0.006  # of the image's height


@dataclass(frozen=True)
class Picture:
    """A stimulus that is ready to be drawn.

    Attributes
    ----------
    window, placement
        Where it is shown.
    regions
        The label image of its objects.
    numerals
        The centre of each object's numeral in the window, in pixels, by label.
    layers
        What is drawn, from back to front: the image and the numerals of its objects.
    """

    window: LabWindow
    placement: Placement
    regions: Regions
    numerals: Mapping[int, Point]
    layers: Sequence[Drawable]

    def draw(self) -> None:
        """Draw the image and its numerals into the next frame."""
        for layer in self.layers:
            layer.draw()

    def label_of(self, press: Press) -> int | None:
        """Return the object that a key or a click on it or its numeral means, None for none."""
        if isinstance(press, KeyPress):
            label = int(press.key) if press.key.isdigit() else None
            return label if label in self.numerals else None
        if isinstance(press, Release):
            return None
        for label, (x_px, y_px) in self.numerals.items():
            away_px = max(abs(press.x_px + 0.5 - x_px), abs(press.y_px + 0.5 - y_px))
            if away_px < _NUMERAL_SIZE_PX / 2:
                return label
        pixel = self.placement.image_pixel(press.x_px, press.y_px)
        return (int(self.regions[pixel]) or None) if pixel else None

    def outlined(self, *labels: int) -> "Picture":
        """Return the picture with a line around each of these objects."""
        height, width = self.regions.shape
        overlay = np.zeros((height, width, 4), np.uint8)
        for label in labels:
            mask = outline(self.regions, label, max(2, round(_OUTLINE_WIDTH * height)))
            overlay[mask] = (*OUTLINE_RGB, 255)
        layer = self.window.image(Image.fromarray(overlay), self.placement.area)
        return replace(self, layers=(*self.layers, layer))


def load_picture(
    window: LabWindow,
    stimuli: StimulusSet,
    stimulus: Stimulus,
    available: Area,
    width_px: int | None = None,
) -> Picture:
    """Load a stimulus onto the graphics card.

    Parameters
    ----------
    window
        The open window.
    stimuli, stimulus
        The set and the stimulus, which must have regions.
    available
        The part of the window that it may fill.
    width_px
        How wide it is shown; None for its own size, smaller if it does not fit.

    Raises
    ------
    InputError
        If one of its files cannot be read, or image and regions differ in size.
    """
    image = shown_image(stimuli, stimulus)
    if stimulus.regions is None:
        raise InputError(f"stimuli: {stimulus.id} has no regions to choose from")
    regions = read_labels(stimuli.path(stimulus.regions))
    if regions.shape != (image.height, image.width):
        raise InputError(f"stimuli: image and regions of {stimulus.id} differ in size")
    placement = fit(image.width, image.height, available, width_px)
    numerals = _numerals_in_window(regions, placement)
    texts = [window.text(str(label), *numerals[label], _NUMERAL_TEXT_PX) for label in numerals]
    layers = (window.image(image, placement.area), *texts)
    return Picture(window, placement, regions, numerals, layers)


def _numerals_in_window(regions: Regions, placement: Placement) -> dict[int, Point]:
    size_px, gap_px = _NUMERAL_SIZE_PX / placement.scale, _NUMERAL_GAP_PX / placement.scale
    places = numeral_places(regions, size_px, gap_px)
    return {label: placement.window_point(*place) for label, place in places.items()}


def image_size(stimuli: StimulusSet, stimulus: Stimulus) -> Size:
    """Return the width and height of an image, without reading all of it.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    with _opened(stimuli, stimulus) as file:
        return file.size


def shown_image(stimuli: StimulusSet, stimulus: Stimulus) -> Image.Image:
    """Read an image as the sRGB values, 0 to 255, that the window shows unchanged.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    with _opened(stimuli, stimulus) as file:
        return file.convert("RGB")


@contextmanager
def _opened(stimuli: StimulusSet, stimulus: Stimulus) -> Iterator[Image.Image]:
    path = stimuli.path(stimulus.file)
    try:
        with Image.open(path) as file:
            yield file
    except OSError as error:
        raise InputError(f"{path}: not an image that can be read") from error
