"""The texts of the window in every language."""

import re

from experiments.lab.texts import MESSAGES, text, texts
from experiments.study import Study
from tests.web.browser import changed


def test_every_language_has_the_same_texts_with_the_same_places_to_fill() -> None:
    english = texts("en")
    assert sorted(path.stem for path in MESSAGES.glob("*.json")) == ["en", "es"]
    for key, spanish in texts("es").items():
        assert sorted(re.findall(r"{\w+}", spanish)) == sorted(re.findall(r"{\w+}", english[key]))
    assert list(texts("es")) == list(english)


def test_every_text_is_used_and_no_other() -> None:
    sources = "\n".join(path.read_text("utf-8") for path in MESSAGES.parent.glob("*.py"))
    assert [key for key in texts("en") if f'"{key}"' not in sources] == []


def test_texts_are_those_of_the_studys_language(study: Study) -> None:
    assert text(study, "thanks.code", code="A1") == "Completion code: A1"
    spanish = changed(study, language="es")
    assert text(spanish, "thanks.code", code="A1") == "Código de finalización: A1"
