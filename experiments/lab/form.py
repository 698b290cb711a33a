"""The form in the window that asks who takes part, with the fields that the study declares.

PsychoPy's own dialog is not used: its Qt ends the whole process where a library of X11 is missing.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from algorithms.errors import InputError
from experiments.demographics import GENDERS, OLDEST_AGE
from experiments.lab.buttons import BUTTON_RGB
from experiments.lab.geometry import Area
from experiments.lab.inputs import Click, KeyPress, Press, Typed
from experiments.lab.pages import FOOTING_BAND, HEADING_BAND, footing, heading, line
from experiments.lab.pictures import OUTLINE_RGB
from experiments.lab.texts import text
from experiments.lab.window import Drawable, LabWindow
from experiments.study import Study
from experiments.study_parts import DemographicsField

PARTICIPANT = "participant"

_CHOSEN_RGB = (84, 120, 168)
_FRAME_WIDTH_PX = 3
_LONGEST_TEXT = 64

# Shares of the window's height and width.
_TEXT = 0.026
_BOX = 0.055
_TOLD_BAND = 0.07
_LARGEST_BAND = 0.15
_WIDTH = 0.7
_GAP = 0.01

Accepted = TypeVar("Accepted")


class Field(ABC):
    """One thing that is asked.

    Parameters
    ----------
    name
        What it is called in what is returned.
    label
        What it is called on the screen.
    """

    def __init__(self, name: str, label: str) -> None:
        self.name, self.label = name, label

    @property
    @abstractmethod
    def value(self) -> Any:  # noqa: ANN401 - whatever was given, still to be checked
        """What was given, or None for nothing."""

    @abstractmethod
    def take(self, entry: Press | Typed, area: Area) -> None:
        """Do what a key or a click asks for; the field lies in that area."""

    @abstractmethod
    def parts(self, window: LabWindow, area: Area) -> list[Drawable]:
        """Prepare what stands in the field's area."""


class TextField(Field):
    """A line to type in; `read` turns it into the value."""

    def __init__(
        self, name: str, label: str, read: Callable[[str], object] = str, given: str = ""
    ) -> None:
        super().__init__(name, label)
        self._read, self._text = read, given

    @property
    def value(self) -> Any:  # noqa: ANN401
        """What was typed, or None for nothing."""
        return self._read(self._text.strip()) if self._text.strip() else None

    def take(self, entry: Press | Typed, area: Area) -> None:  # noqa: ARG002
        """Add what is typed at the end; Backspace takes it away again."""
        if isinstance(entry, Typed):
            self._text = (self._text + entry.character)[:_LONGEST_TEXT]
        elif isinstance(entry, KeyPress) and entry.key == "backspace":
            self._text = self._text[:-1]

    def parts(self, window: LabWindow, area: Area) -> list[Drawable]:
        """Prepare the line and what was typed."""
        return [window.bar(area, BUTTON_RGB), *_centred(window, self._text, area)]


class ChoiceField(Field):
    """Answers side by side, of which one is chosen.

    Parameters
    ----------
    options
        The values, by what they are called on the screen.
    """

    def __init__(self, name: str, label: str, options: Mapping[str, object]) -> None:
        super().__init__(name, label)
        self._options = tuple(options.items())
        self._chosen: int | None = None

    @property
    def value(self) -> Any:  # noqa: ANN401
        """The value chosen, or None for none."""
        return None if self._chosen is None else self._options[self._chosen][1]

    def take(self, entry: Press | Typed, area: Area) -> None:
        """Choose what is clicked, or by the arrows."""
        last = len(self._options) - 1
        if isinstance(entry, KeyPress) and entry.key == "right":
            self._chosen = 0 if self._chosen is None else min(last, self._chosen + 1)
        elif isinstance(entry, KeyPress) and entry.key == "left":
            self._chosen = last if self._chosen is None else max(0, self._chosen - 1)
        elif isinstance(entry, Click):
            for number, box in enumerate(self._boxes(area)):
                if box.holds(entry.x_px, entry.y_px):
                    self._chosen = number

    def parts(self, window: LabWindow, area: Area) -> list[Drawable]:
        """Prepare the answers, the chosen one in another colour."""
        parts: list[Drawable] = []
        for number, box in enumerate(self._boxes(area)):
            parts.append(window.bar(box, _CHOSEN_RGB if number == self._chosen else BUTTON_RGB))
            parts += _centred(window, self._options[number][0], box)
        return parts

    def _boxes(self, area: Area) -> list[Area]:
        count = len(self._options)
        step_px = area.width_px // count
        gap_px = max(2, round(_GAP * area.width_px))
        return [
            Area(area.left_px + n * step_px, area.top_px, step_px - gap_px, area.height_px)
            for n in range(count)
        ]


def fields_for(study: Study, participant: str | None) -> list[Field]:
    """Return the fields for a participant of a study; the name may be known already."""
    who = TextField(PARTICIPANT, text(study, "form.participant"), given=participant or "")
    return [who, *(_demographics_field(study, name) for name in study.demographics)]


def _demographics_field(study: Study, name: DemographicsField) -> Field:
    match name:
        case "age":
            label = text(study, "form.age", oldest=OLDEST_AGE)
            return TextField(name, label, lambda typed: int(typed) if typed.isdecimal() else typed)
        case "gender":
            said = ("form.female", "form.male", "form.other", "form.undisclosed")
            options = {text(study, key): each for key, each in zip(said, GENDERS, strict=True)}
            return ChoiceField(name, text(study, "form.gender"), options)
        case "artistic_background":
            yes_no = {text(study, "yes_no.yes"): True, text(study, "yes_no.no"): False}
            return ChoiceField(name, text(study, "form.artistic_background"), yes_no)


def fill_in(
    window: LabWindow,
    study: Study,
    fields: Sequence[Field],
    accept: Callable[[dict[str, Any]], Accepted],
) -> Accepted | None:
    """Show a form until what it says is accepted, or Escape is pressed.

    Parameters
    ----------
    window, study
        Where, and in which language.
    fields
        What is asked.
    accept
        Is given what was filled in, by name; raises InputError, with the field's name at its
        beginning, for what must be changed. That is then said in the form.

    Returns
    -------
    What `accept` returned; None after Escape.
    """
    form = _Form(window, study, fields)
    window.take_typed()
    while True:
        window.show(form.parts())
        if not form.announced:
            window.announce("form")
            form.announced = True
        for entry in window.take_typed():
            if isinstance(entry, KeyPress) and entry.key == "escape":
                return None
            if isinstance(entry, KeyPress) and entry.key == "enter":
                try:
                    return accept(form.filled())
                except InputError as error:
                    form.point_out(str(error))
            else:
                form.take(entry)


class _Form:
    """Fields below each other, one of them active."""

    def __init__(self, window: LabWindow, study: Study, fields: Sequence[Field]) -> None:
        self._window, self._study, self._fields = window, study, fields
        top_px = round(HEADING_BAND * window.height_px)
        room = 1 - HEADING_BAND - FOOTING_BAND - _TOLD_BAND
        self._band_px = round(min(_LARGEST_BAND, room / len(fields)) * window.height_px)
        width_px, box_px = round(_WIDTH * window.width_px), round(_BOX * window.height_px)
        left_px = (window.width_px - width_px) // 2
        self._areas = [
            Area(left_px, top_px + (n + 1) * self._band_px - box_px, width_px, box_px)
            for n in range(len(fields))
        ]
        self._active = 0
        self._told = ""
        self._parts: list[Drawable] | None = None
        self.announced = False

    def filled(self) -> dict[str, Any]:
        """Return what was given, by name."""
        values = {field.name: field.value for field in self._fields}
        return {name: value for name, value in values.items() if value is not None}

    def point_out(self, fault: str) -> None:
        """Go to the field that a fault names, and say what is wrong."""
        named = fault.partition(":")[0].rpartition(".")[2]
        names = [field.name for field in self._fields]
        self._active = names.index(named) if named in names else 0
        label = self._fields[self._active].label
        # A participant's name is the experimenter's affair, and the reasons are many.
        known = named == PARTICIPANT
        self._told = fault if known else text(self._study, "form.check", field=label)
        self._parts = None

    def take(self, entry: Press | Typed) -> None:
        """Go to another field, or give what was pressed to the active one."""
        if isinstance(entry, KeyPress) and entry.key in ("tab", "down"):
            self._active = (self._active + 1) % len(self._fields)
        elif isinstance(entry, KeyPress) and entry.key == "up":
            self._active = (self._active - 1) % len(self._fields)
        else:
            if isinstance(entry, Click):
                self._active = self._field_at(entry)
            self._fields[self._active].take(entry, self._areas[self._active])
        self._parts = None

    def _field_at(self, click: Click) -> int:
        for number, area in enumerate(self._areas):
            if area.holds(click.x_px, click.y_px):
                return number
        return self._active

    def parts(self) -> list[Drawable]:
        """Prepare the form for drawing, anew after a change only."""
        if self._parts is None:
            window, active = self._window, self._areas[self._active]
            self._parts = [
                heading(window, text(self._study, "form.title", title=self._study.title)),
                *(part for n in range(len(self._fields)) for part in self._parts_of(n)),
                window.frame(active, OUTLINE_RGB, _FRAME_WIDTH_PX),
                footing(window, text(self._study, "form.prompt")),
            ]
            if self._told:
                self._parts.append(
                    line(window, self._told, 1 - FOOTING_BAND - _TOLD_BAND / 2, _TEXT)
                )
        return self._parts

    def _parts_of(self, number: int) -> list[Drawable]:
        window, area, field = self._window, self._areas[number], self._fields[number]
        size_px = _TEXT * window.height_px
        top_px = area.top_px - 1.7 * size_px
        label = window.text(
            field.label, area.left_px, top_px, size_px, width_px=float(area.width_px)
        )
        return [label, *field.parts(window, area)]


def _centred(window: LabWindow, words: str, area: Area) -> list[Drawable]:
    middle = (area.left_px + area.width_px / 2, area.top_px + area.height_px / 2)
    return [window.text(words, *middle, _TEXT * window.height_px)] if words else []
