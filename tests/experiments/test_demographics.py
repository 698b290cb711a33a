"""What participants may say of themselves, at the borders of what is accepted."""

from collections.abc import Mapping
from typing import Any

import pytest

from algorithms.errors import InputError
from experiments.demographics import check_demographics
from experiments.study import Study

ALL = {"artistic_background": True, "gender": "other", "age": 120}


def test_what_is_asked_comes_back_in_the_studys_order(study: Study) -> None:
    checked = check_demographics(study, ALL)
    assert checked == ALL
    assert tuple(checked) == study.demographics


def test_a_study_that_asks_nothing_accepts_nothing(study: Study) -> None:
    silent = study.model_copy(update={"demographics": ()})
    assert check_demographics(silent, {}) == {}
    with pytest.raises(InputError, match=r"^demographics\.age: lights-synthetic does not ask"):
        check_demographics(silent, {"age": 30})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"age": 0}, r"^demographics\.age: 0 given, a whole number of years"),
        ({"age": 121}, r"^demographics\.age: 121 given"),
        ({"age": 30.0}, r"^demographics\.age: 30\.0 given"),
        ({"age": True}, r"^demographics\.age: True given"),
        ({"age": "30"}, r"^demographics\.age: '30' given"),
        ({"gender": "F"}, r"^demographics\.gender: 'F' given, female, male, other, undisclosed"),
        ({"gender": None}, r"^demographics\.gender: None given"),
        ({"gender": ["male"]}, r"^demographics\.gender: \['male'\] given"),
        ({"artistic_background": 1}, r"^demographics\.artistic_background: 1 given"),
        ({"name": "Ada"}, r"^demographics\.name: "),
    ],
)
def test_what_is_not_accepted_is_named(
    study: Study, changes: Mapping[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        check_demographics(study, ALL | dict(changes))


@pytest.mark.parametrize("field", sorted(ALL))
def test_what_is_missing_is_named(study: Study, field: str) -> None:
    given = {key: value for key, value in ALL.items() if key != field}
    with pytest.raises(InputError, match=rf"^demographics\.{field}: missing"):
        check_demographics(study, given)
