import doctest
from types import ModuleType

import pytest

from algorithms import color, light


@pytest.mark.parametrize("module", [color, light])
def test_examples_in_docstrings_are_true(module: ModuleType) -> None:
    found = doctest.testmod(module)
    assert found.attempted > 0
    assert found.failed == 0
