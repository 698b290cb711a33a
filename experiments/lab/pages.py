"""The pages around the trials: consent, instructions, feedback, pause and thanks."""

from collections.abc import Sequence
from dataclasses import dataclass

from experiments.lab.geometry import Area
from experiments.lab.inputs import KeyPress
from experiments.lab.pictures import Picture, load_picture
from experiments.lab.texts import text
from experiments.lab.window import Drawable, LabWindow
from experiments.planning.trials import Trial
from experiments.study import CHOOSES, Study
from stimuli.manifest import Stimulus, StimulusSet

# Shares of the window's height.
HEADING_BAND = 0.09
FOOTING_BAND = 0.06
_LINE = 0.032  # the largest size of a page's text
_TOP = 0.16  # where a page's text begins
_TOP_WITH_PICTURE = 0.05
_SHARE_OF_TEXT = 0.4  # where a picture follows

_WIDEST_TEXT = 0.8  # of the window's width
_SMALLEST_TEXT_PX = 10.0

# Letters are on average a little more than half as wide as the text is high.
_WIDEST_LINE = 1.7


@dataclass(frozen=True)
class Page:
    """Something to read, left by a key.

    Attributes
    ----------
    name
        What it is called to the experimenter.
    paragraphs
        The first one is the title.
    prompt
        Which keys do what; the page's last line.
    """

    name: str
    paragraphs: Sequence[str]
    prompt: str


def consent_page(study: Study) -> Page:
    """Return the page with the consent text."""
    return Page("consent", (study.title, study.consent.text), text(study, "consent.prompt"))


def instructions_page(study: Study, how_to: str, example: Stimulus | None) -> Page:
    """Return the page that explains the task and how to answer, perhaps with an example below."""
    said = (*study.instructions, how_to) if how_to else study.instructions
    paragraphs = [study.question, *said]
    if example is not None:
        several = len(example.right_labels) > 1
        key = "instructions.example_several" if several else "instructions.example"
        paragraphs.append(text(study, key))
    return Page("instructions", paragraphs, text(study, "begin.prompt"))


def main_page(study: Study, trials: int) -> Page:
    """Return the page between practice and main trials."""
    paragraphs = (
        text(study, "main.title"),
        text(
            study, "main.text_at_most" if study.design.is_adaptive else "main.text", trials=trials
        ),
        text(study, "main.pause"),
    )
    return Page("main", paragraphs, text(study, "begin.prompt"))


def pause_page(study: Study) -> Page:
    """Return the page that Escape leads to during a trial."""
    paragraphs = (text(study, "pause.title"), text(study, "pause.text"))
    return Page("pause", paragraphs, text(study, "pause.prompt"))


def thanks_page(study: Study, completion_code: str) -> Page:
    """Return the last page."""
    paragraphs = (
        text(study, "thanks.title"),
        text(study, "thanks.text"),
        text(study, "thanks.code", code=completion_code),
    )
    return Page("thanks", paragraphs, text(study, "thanks.prompt"))


def example_of(study: Study, stimuli: StimulusSet) -> Stimulus | None:
    """Return the set's first example where objects are chosen, or None if it has none."""
    if study.task not in CHOOSES:
        return None
    examples = stimuli.with_role("example")
    return next((each for each in examples if each.right_labels and each.regions), None)


def example_picture(window: LabWindow, stimuli: StimulusSet, example: Stimulus) -> Picture:
    """Return an example with its right objects outlined."""
    picture = load_picture(window, stimuli, example, _example_area(window))
    return picture.outlined(*example.right_labels)


def _example_area(window: LabWindow) -> Area:
    """Return the part of a page between the text and the last line."""
    top_px = round((_TOP_WITH_PICTURE + _SHARE_OF_TEXT) * window.height_px)
    bottom_px = round((1 - FOOTING_BAND) * window.height_px)
    return Area(0, top_px, window.width_px, bottom_px - top_px)


def show_page(
    window: LabWindow, page: Page, keys: Sequence[str] = ("enter",), picture: Picture | None = None
) -> str:
    """Show a page until one of the keys is pressed, and return that key."""
    return _wait(window, page.name, _lay_out(window, page, picture), keys)


def show_feedback(
    window: LabWindow, trial: Trial, marked: Sequence[Drawable], told: str, prompt: str
) -> None:
    """Say whether an answer was right, over the stimuli in their place, until Enter is pressed.

    Parameters
    ----------
    window, trial
        Where, and after which trial.
    marked
        The trial's stimuli with the right answer marked.
    told, prompt
        What is said above them, and the page's last line.
    """
    parts = (*marked, heading(window, told), footing(window, prompt))
    _wait(window, f"feedback {trial.index}", parts, ("enter",))


def heading(window: LabWindow, text: str) -> Drawable:
    """Prepare the line above a stimulus."""
    return line(window, text, HEADING_BAND / 2, _LINE)


def footing(window: LabWindow, text: str) -> Drawable:
    """Prepare a page's last line, which says which keys do what."""
    return line(window, text, 1 - FOOTING_BAND / 2, 0.8 * _LINE)


def line(window: LabWindow, text: str, y: float, size: float) -> Drawable:
    """Set one line in the middle, smaller where it would be wider than the window.

    Parameters
    ----------
    window, text
        Where, and what it says.
    y, size
        How far down its middle lies, and how high its letters are: shares of the window's height.
    """
    size_px = min(size * window.height_px, _WIDEST_LINE * window.width_px / len(text))
    return window.text(text, window.width_px / 2, y * window.height_px, size_px)


def _wait(window: LabWindow, name: str, parts: Sequence[Drawable], keys: Sequence[str]) -> str:
    announced = False
    window.take_presses()
    while True:
        window.show(parts)
        if not announced:
            window.announce(name)
            announced = True
        for press in window.take_presses():
            if isinstance(press, KeyPress) and press.key in keys:
                return press.key


def _lay_out(window: LabWindow, page: Page, picture: Picture | None) -> list[Drawable]:
    """Set a page in the largest text that leaves room for the picture and the last line."""
    top, share = (_TOP_WITH_PICTURE, _SHARE_OF_TEXT) if picture else (_TOP, 1 - 2 * _TOP)
    size_px = _LINE * window.height_px
    parts, height_px = _paragraphs(window, page.paragraphs, top, size_px)
    while height_px > share * window.height_px and size_px > _SMALLEST_TEXT_PX:
        size_px *= 0.92
        parts, height_px = _paragraphs(window, page.paragraphs, top, size_px)
    return [*parts, *([picture] if picture else []), footing(window, page.prompt)]


def _paragraphs(
    window: LabWindow, paragraphs: Sequence[str], top: float, size_px: float
) -> tuple[list[Drawable], float]:
    """Set paragraphs below each other; return them and the height that they take."""
    width_px = min(_WIDEST_TEXT * window.width_px, 48 * size_px)
    left_px = (window.width_px - width_px) / 2
    top_px = start_px = top * window.height_px
    parts: list[Drawable] = []
    for number, paragraph in enumerate(paragraphs):
        this_px = 1.3 * size_px if number == 0 else size_px
        part = window.text(paragraph, left_px, top_px, this_px, width_px=width_px)
        parts.append(part)
        top_px += part.boundingBox[1] + 0.9 * size_px
    return parts, top_px - start_px
