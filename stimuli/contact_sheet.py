"""A contact sheet: all images of a set side by side, each with what made it written below."""

from pathlib import Path
from typing import Final

from PIL import Image, ImageDraw, ImageFont

from algorithms.errors import InputError
from algorithms.images import write_picture
from stimuli.manifest import Stimulus, StimulusSet

_MARGIN_PX: Final = 12
_CAPTION_PX: Final = 34
_FONT_PX: Final = 12
_PAPER: Final = (246, 246, 244)
_INK: Final = (30, 30, 30)

Font = ImageFont.FreeTypeFont | ImageFont.ImageFont


def draw_contact_sheet(stimuli: StimulusSet, *, columns: int, thumbnail_px: int) -> Image.Image:
    """Draw all images of a set.

    Parameters
    ----------
    stimuli
        The set, in its folder.
    columns
        Images side by side, 1 or more; fewer where there are not so many.
    thumbnail_px
        Width of an image on the sheet, 16 or more.

    Raises
    ------
    InputError
        If an argument is out of range or an image is missing.
    """
    for name, value, lowest in (("columns", columns, 1), ("thumbnail_px", thumbnail_px, 16)):
        if value < lowest:
            raise InputError(f"{name}: {value} given, {lowest} or more accepted")
    columns = min(columns, len(stimuli.stimuli))
    thumbnails = [_thumbnail(stimuli.path(s.file), thumbnail_px) for s in stimuli.stimuli]
    cell_height_px = max(picture.height for picture in thumbnails) + _CAPTION_PX + _MARGIN_PX
    rows = -(-len(thumbnails) // columns)
    sheet = Image.new(
        "RGB",
        (_MARGIN_PX + columns * (thumbnail_px + _MARGIN_PX), _MARGIN_PX + rows * cell_height_px),
        _PAPER,
    )
    for index, (stimulus, picture) in enumerate(zip(stimuli.stimuli, thumbnails, strict=True)):
        row, column = divmod(index, columns)
        x = _MARGIN_PX + column * (thumbnail_px + _MARGIN_PX)
        y = _MARGIN_PX + row * cell_height_px
        sheet.paste(picture, (x, y))
        sheet.paste(_text(caption(stimulus), thumbnail_px), (x, y + picture.height))
    return sheet


def caption(stimulus: Stimulus) -> str:
    """Return what is written below a stimulus: its factors, then its role and answer."""
    answer = "no answer" if stimulus.answer is None else f"answer {stimulus.answer}"
    factors = ", ".join(_short(value) for value in stimulus.factors.values())
    return f"{factors}\n{stimulus.role}, {answer}"


def _short(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def write_contact_sheet(path: Path, stimuli: StimulusSet, columns: int, thumbnail_px: int) -> None:
    """Draw all images of a set and write them as one PNG or JPEG."""
    write_picture(path, draw_contact_sheet(stimuli, columns=columns, thumbnail_px=thumbnail_px))


def _text(text: str, width_px: int) -> Image.Image:
    """Draw lines of text, ended by dots where they are too long."""
    drawn = Image.new("RGB", (width_px, _CAPTION_PX), _PAPER)
    font = ImageFont.load_default(size=_FONT_PX)
    lines = "\n".join(_fitted(line, font, width_px) for line in text.splitlines())
    ImageDraw.Draw(drawn).text((0, 2), lines, font=font, fill=_INK)
    return drawn


def _fitted(line: str, font: Font, width_px: int) -> str:
    if font.getlength(line) <= width_px:
        return line
    fitting = [n for n in range(len(line)) if font.getlength(line[:n] + "...") <= width_px]
    return line[: max(fitting, default=0)] + "..."


def _thumbnail(path: Path, width_px: int) -> Image.Image:
    try:
        with Image.open(path) as picture:
            size_px = (width_px, max(1, round(picture.height * width_px / picture.width)))
            small: Image.Image = picture.convert("RGB").resize(size_px, Image.Resampling.LANCZOS)
            return small
    except OSError as error:
        raise InputError(f"{path}: cannot be read") from error
