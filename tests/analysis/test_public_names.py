"""What the package promises by name is there, and the list of it is complete."""

import ast
import inspect
import pkgutil
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import analysis

# The names that the project's design fixes.
FIXED = (
    "agreement",
    "consistency",
    "fit_threshold",
    "light_error",
    "rank_summary",
    "scale_pairs",
    "score_groups",
)
# Modules that can be imported by these names, with a function that each must have.
MODULES = {
    "analysis.thresholds": "fit_threshold",
    "analysis.paired": "analyse_pairs",
    "analysis.ranking": "rank_summary",
    "analysis.gaze": "dwell_ratios",
    "analysis.report": "analyse",
}


def test_every_name_is_a_function_or_a_result_that_explains_itself() -> None:
    assert set(FIXED) <= set(analysis.__all__)
    assert list(analysis.__all__) == sorted(set(analysis.__all__))
    for name in analysis.__all__:
        found = getattr(analysis, name)
        assert callable(found), name
        assert found.__name__ == name
        assert inspect.getdoc(found), name
    with pytest.raises(AttributeError, match="'analysis' has no attribute 'fit_treshold'"):
        analysis.fit_treshold  # type: ignore[attr-defined]  # noqa: B018


def test_type_checkers_and_python_see_the_same_names() -> None:
    source = Path(inspect.getfile(analysis)).read_text(encoding="utf-8")
    typed = {
        (alias.name, node.module)
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("analysis.")
        for alias in node.names
    }
    assert {name for name, _ in typed} == set(analysis.__all__)
    for name, module in typed:
        assert module is not None
        assert getattr(import_module(module), name) is getattr(analysis, name)


def test_no_module_hides_a_function_of_its_name() -> None:
    # A submodule becomes an attribute of its package as soon as anything imports it.
    modules = {module.name for module in pkgutil.iter_modules(analysis.__path__)}
    assert not modules & set(analysis.__all__)
    wins = np.array([[0, 1, 1], [0, 0, 1], [0, 0, 0]])
    assert analysis.consistency(wins).zeta == 1


@pytest.mark.parametrize(("module", "function"), MODULES.items())
def test_modules_keep_their_names(module: str, function: str) -> None:
    assert callable(getattr(import_module(module), function))
