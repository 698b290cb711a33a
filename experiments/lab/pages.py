"""The pages around the trials: consent, instructions, feedback, pause and thanks."""

from collections.abc import Sequence
from dataclasses import dataclass

from experiments.lab.geometry import Area
from experiments.lab.pictures import Picture, load_picture
from experiments.lab.window import Drawable, KeyPress, LabWindow
from experiments.study import Study
from experiments.trials import Answer, Trial
from stimuli.manifest import StimulusSet

_MARGIN = 0.06  # of the window's height
_LINE = 0.032  # of the window's height: the largest size of a page's text
_SMALLEST_TEXT_PX = 10.0
_WIDEST_TEXT = 0.8  # of the window's width
_SHARE_OF_TEXT = 0.42  # of the window's height, where a picture follows


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
    prompt = "Enter: I agree and take part        Escape: leave, and nothing is stored"
    return Page("consent", (study.title, study.consent.text), prompt)


def instructions_page(study: Study) -> Page:
    """Return the page that explains the task."""
    return Page("instructions", (study.question, *study.instructions), "Enter: begin")


def main_page(trials: int) -> Page:
    """Return the page between practice and main trials."""
    paragraphs = (
        "The practice is over.",
        f"{trials} images follow, without a word on whether an answer was right.",
        "Escape: pause",
    )
    return Page("main", paragraphs, "Enter: begin")


def feedback_page(trial: Trial, answer: Answer, right: int | str | tuple[int, ...] | None) -> Page:
    """Return the page after a practice trial; its picture outlines the right object."""
    if answer == right:
        text = "Right: it is the outlined object."
    else:
        text = "Not this time: it is the outlined object."
    return Page(f"feedback {trial.index}", (text,), "Enter: go on")


def pause_page() -> Page:
    """Return the page that Escape leads to during a trial."""
    paragraphs = ("Paused.", "All answers so far are stored. The last image will be shown again.")
    return Page("pause", paragraphs, "Enter: go on        Escape: leave")


def thanks_page(completion_code: str) -> Page:
    """Return the last page."""
    return Page(
        "thanks",
        ("Thank you!", "All your answers are stored.", f"Completion code: {completion_code}"),
        "Enter: close",
    )


def example_picture(window: LabWindow, stimuli: StimulusSet) -> Picture | None:
    """Return the set's first example with its odd object outlined, or None if it has none."""
    for stimulus in stimuli.with_role("example"):
        if isinstance(stimulus.answer, int) and stimulus.regions is not None:
            picture = load_picture(window, stimuli, stimulus, picture_area(window))
            return picture.outlined(stimulus.answer)
    return None


def picture_area(window: LabWindow) -> Area:
    """Return the part of a page that a picture may fill, between text and prompt."""
    margin_px = round(_MARGIN * window.height_px)
    top_px = margin_px + round(_SHARE_OF_TEXT * window.height_px)
    height_px = window.height_px - top_px - 2 * margin_px
    return Area(margin_px, top_px, window.width_px - 2 * margin_px, height_px)


def show_page(
    window: LabWindow, page: Page, keys: Sequence[str] = ("enter",), picture: Picture | None = None
) -> str:
    """Show a page until one of the keys is pressed, and return that key."""
    parts = _lay_out(window, page, picture)
    announced = False
    window.take_presses()
    while True:
        for part in parts:
            part.draw()
        window.flip()
        if not announced:
            window.announce(page.name)
            announced = True
        for press in window.take_presses():
            if isinstance(press, KeyPress) and press.key in keys:
                return press.key


def _lay_out(window: LabWindow, page: Page, picture: Picture | None) -> list[Drawable]:
    margin_px = _MARGIN * window.height_px
    share = _SHARE_OF_TEXT if picture else 1 - 4 * _MARGIN
    size_px = _LINE * window.height_px
    parts, height_px = _paragraphs(window, page.paragraphs, size_px)
    while height_px > share * window.height_px and size_px > _SMALLEST_TEXT_PX:
        size_px *= 0.92
        parts, height_px = _paragraphs(window, page.paragraphs, size_px)
    prompt_px = min(size_px, 0.8 * _LINE * window.height_px)
    prompt = window.text(page.prompt, window.width_px / 2, window.height_px - margin_px, prompt_px)
    return [*parts, *([picture] if picture else []), prompt]


def _paragraphs(
    window: LabWindow, paragraphs: Sequence[str], size_px: float
) -> tuple[list[Drawable], float]:
    """Set paragraphs below each other; return them and the height that they take."""
    width_px = min(_WIDEST_TEXT * window.width_px, 48 * size_px)
    left_px = (window.width_px - width_px) / 2
    top_px = start_px = _MARGIN * window.height_px
    parts: list[Drawable] = []
    for number, paragraph in enumerate(paragraphs):
        this_px = 1.3 * size_px if number == 0 else size_px
        part = window.text(paragraph, left_px, top_px, this_px, width_px=width_px)
        parts.append(part)
        top_px += part.boundingBox[1] + 0.9 * size_px
    return parts, top_px - start_px
