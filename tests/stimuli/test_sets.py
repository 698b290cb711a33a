"""The sets that can be made by name."""

import inspect

import pytest

from stimuli.sets import SUMMARIES, maker


@pytest.mark.parametrize("name", SUMMARIES)
def test_every_set_of_the_list_is_there_and_takes_what_the_command_gives(name: str) -> None:
    make = maker(name)
    assert callable(make)
    module = __import__(f"stimuli.sets.{name.replace('-', '_')}", fromlist=["make"])
    accepted = inspect.signature(module.make).parameters
    assert {"folder", "seed", "quick", "engine", "progress"} <= accepted.keys()
    assert module.__doc__
