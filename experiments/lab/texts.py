"""The texts of the window's pages, from the message file of the study's language."""

import json
from functools import cache
from pathlib import Path

from experiments.study import Study

MESSAGES = Path(__file__).parent / "messages"


def text(study: Study, key: str, **values: object) -> str:
    """Return a text in the study's language, with its `{placeholders}` filled in."""
    return texts(study.language)[key].format(**values)


@cache
def texts(language: str) -> dict[str, str]:
    """Return all texts of a language, by key."""
    content = (MESSAGES / f"{language}.json").read_text(encoding="utf-8")
    return {str(key): str(value) for key, value in json.loads(content).items()}
