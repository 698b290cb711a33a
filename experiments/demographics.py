"""What participants say of themselves: checked the same way in the lab and on the web."""

from collections.abc import Mapping

from algorithms.errors import InputError
from experiments.study import Study

GENDERS = ("female", "male", "other", "undisclosed")
OLDEST_YEARS = 120


def check_demographics(study: Study, given: Mapping[str, object]) -> dict[str, object]:
    """Return what a participant said, checked against what the study asks.

    Parameters
    ----------
    study
        Its `demographics` names what is asked: nothing less and nothing else is accepted.
    given
        `age` in whole years, 1 to 120; `gender`, one of `GENDERS`; `artistic_background`, True or
        False.

    Raises
    ------
    InputError
        Naming the first key that is unknown, missing or out of its range.
    """
    for key in given:
        if key not in study.demographics:
            raise InputError(
                f"demographics.{ascii(key)[1:-1]}: not asked by the study, which asks"
                f" {', '.join(study.demographics) or 'nothing'}"
            )
    for key in study.demographics:
        if key not in given:
            raise InputError(f"demographics.{key}: missing")
        _CHECKS[key](given[key])
    return {key: given[key] for key in study.demographics}


def _check_age(age: object) -> None:
    # True is an int in Python, yet not an age.
    if not isinstance(age, int) or isinstance(age, bool) or not 1 <= age <= OLDEST_YEARS:
        raise InputError(f"demographics.age: whole years from 1 to {OLDEST_YEARS} are accepted")


def _check_gender(gender: object) -> None:
    if gender not in GENDERS:
        raise InputError(f"demographics.gender: one of {', '.join(GENDERS)} is accepted")


def _check_artistic_background(artistic_background: object) -> None:
    if not isinstance(artistic_background, bool):
        raise InputError("demographics.artistic_background: true or false is accepted")


_CHECKS = {
    "age": _check_age,
    "gender": _check_gender,
    "artistic_background": _check_artistic_background,
}
