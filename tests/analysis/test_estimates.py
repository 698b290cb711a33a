import json

import numpy as np
import pandas as pd
import pytest

from analysis.estimates import Estimate, seed_of, to_json
from analysis.report.verdict import in_levels


def test_json_has_no_number_that_json_lacks() -> None:
    result = {
        "estimate": Estimate(1.5, -np.inf, np.nan),
        "table": pd.DataFrame({"level": [10, 20], "rate": [0.5, np.nan]}),
        "array": np.array([1, 2]),
        "flag": np.bool_(True),
    }
    assert json.loads(to_json(result)) == {
        "estimate": {"value": 1.5, "low": None, "high": None},
        "table": [{"level": 10, "rate": 0.5}, {"level": 20, "rate": None}],
        "array": [1, 2],
        "flag": True,
    }


def test_results_know_the_seed_of_spawned_generators() -> None:
    parent = np.random.default_rng(42)
    assert seed_of(parent) == seed_of(parent.spawn(1)[0]) == 42


@pytest.mark.parametrize(
    ("estimate", "expected"),
    [
        (Estimate(25.04, 23.96, 26.31), "25.0 deg [24.0, 26.3]"),
        (Estimate(14.1, -np.inf, 21.1), "14.1 deg [below the levels tested, 21.1]"),
        (Estimate(80, 60, np.inf), "80.0 deg [60.0, above the levels tested]"),
        (Estimate(np.inf, np.inf, np.inf), "above the levels tested"),
        (Estimate(-np.inf, -np.inf, -np.inf), "below the levels tested"),
    ],
)
def test_levels_in_words(estimate: Estimate, expected: str) -> None:
    assert in_levels(estimate, "deg") == expected
