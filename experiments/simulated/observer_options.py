"""Simulated observers from what is said of them on the command line."""

from algorithms.errors import InputError
from experiments.simulated.item_observers import ItemObserver
from experiments.simulated.observers import Observer
from experiments.study import CHOOSES, Study


def observer_of(
    study: Study,
    *,
    threshold: str,
    condition: str | None,
    width: float,
    salience: str | None,
    qualities: str | None,
    spread: float,
    position_bias: float,
    lapse_rate: float,
    fatigue: float,
) -> Observer | ItemObserver:
    """Return the observer that a study's task needs.

    Parameters
    ----------
    study
        Its task and level.
    threshold
        A number, or one for each value of `condition`: `front=20,back=30`.
    salience, qualities
        By label and by item, in the same form; None for none.
    condition, width, spread, position_bias, lapse_rate, fatigue
        As in `Observer` and `ItemObserver`.

    Raises
    ------
    InputError
        If what the task needs is missing, or something is no number.
    """
    by_level = study.task == "yes-no" and study.stimuli.level and qualities is None
    if study.task in CHOOSES or by_level:
        return Observer(
            threshold=_threshold_of(threshold),
            width=width,
            lapse_rate=lapse_rate,
            condition=condition,
            salience=_salience_of(salience),
            fatigue=fatigue,
        )
    if qualities is None:
        raise InputError(f"qualities: needed to simulate {study.task}")
    given = _pairs("qualities", qualities)
    return ItemObserver(given, spread, position_bias, lapse_rate=lapse_rate, fatigue=fatigue)


def _threshold_of(text: str) -> float | dict[str, float]:
    return _pairs("threshold", text) if "=" in text else _number("threshold", text)


def _salience_of(text: str | None) -> dict[int, float] | None:
    if text is None:
        return None
    return {
        int(_number("salience", label)): weight
        for label, weight in _pairs("salience", text).items()
    }


def _pairs(option: str, text: str) -> dict[str, float]:
    parts = [part.partition("=") for part in text.split(",")]
    return {name.strip(): _number(option, value) for name, _, value in parts}


def _number(option: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{option}: {text!r} given, a number accepted") from None
