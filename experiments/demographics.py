"""What a study may ask of its participants, checked alike on the web and in the lab."""

from collections.abc import Mapping
from typing import Any

from algorithms.errors import InputError
from experiments.study import Study
from experiments.study_parts import DemographicsField

GENDERS = ("female", "male", "other", "undisclosed")
OLDEST_AGE = 120

_ACCEPTED: Mapping[DemographicsField, str] = {
    "age": f"a whole number of years, 1 to {OLDEST_AGE}",
    "gender": ", ".join(GENDERS),
    "artistic_background": "true or false",
}


def check_demographics(study: Study, given: Mapping[str, Any]) -> dict[str, Any]:
    """Check that a participant said of themself just what the study asks, and return it.

    Parameters
    ----------
    study
        Its `demographics` names the fields asked.
    given
        `age` in years (int, 1 to 120), `gender` (female, male, other or undisclosed) and
        `artistic_background` (bool); exactly those of them that the study asks.

    Returns
    -------
    The fields in the study's order.

    Raises
    ------
    InputError
        Naming the field that is missing, not asked for or not accepted.
    """
    for field in given:
        if field not in study.demographics:
            raise InputError(f"demographics.{field}: {study.name} does not ask for it")
    for field in study.demographics:
        if field not in given:
            raise InputError(f"demographics.{field}: missing; {_ACCEPTED[field]} accepted")
        if not _is_accepted(field, given[field]):
            raise InputError(
                f"demographics.{field}: {given[field]!r} given, {_ACCEPTED[field]} accepted"
            )
    return {field: given[field] for field in study.demographics}


def _is_accepted(field: DemographicsField, value: object) -> bool:
    match field:
        case "age":
            return type(value) is int and 1 <= value <= OLDEST_AGE
        case "gender":
            return value in GENDERS
        case "artistic_background":
            return isinstance(value, bool)
