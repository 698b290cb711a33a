from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm
from statsmodels.stats.multitest import multipletests

from algorithms.errors import InputError
from analysis.multiplicity import family, holm

P_VALUES = st.lists(st.floats(0, 1), min_size=1, max_size=12)


@given(P_VALUES)
def test_holm_is_that_of_statsmodels(p_values: list[float]) -> None:
    # Another implementation; it collects garbage at each call, which takes long beside other tests.
    with patch("gc.collect"):
        expected = multipletests(p_values, method="holm")[1]
    np.testing.assert_allclose(holm(p_values), expected, rtol=1e-12)


@given(P_VALUES)
def test_tests_that_were_not_made_do_not_count(p_values: list[float]) -> None:
    with_gaps = holm([np.nan, *p_values, np.nan])
    np.testing.assert_array_equal(with_gaps[1:-1], holm(p_values))
    assert np.isnan(with_gaps[[0, -1]]).all()


def test_worked_by_hand() -> None:
    # Theory: times 4, 3, 2 and 1, and never below the one before.
    assert holm([0.02, 0.005, 0.04, 0.011]) == pytest.approx([0.04, 0.02, 0.04, 0.033])


def test_familywise_errors_keep_alpha_where_tests_depend() -> None:
    # Theory: at most 5 % of families with an error, here with strongly correlated tests.
    generator = np.random.default_rng(1)
    shared = generator.normal(size=(4000, 1))
    scores = np.sqrt(0.8) * shared + np.sqrt(0.2) * generator.normal(size=(4000, 6))
    errors = sum(bool((holm(p) < 0.05).any()) for p in 2 * norm.sf(np.abs(scores)))
    assert errors / 4000 < 0.05 + 3 * np.sqrt(0.05 * 0.95 / 4000)


def test_a_family_names_itself() -> None:
    frame = family("effects", {"a": 0.01, "b": np.nan, "c": 0.03}).to_frame()
    assert frame["family"].unique().tolist() == ["effects"]
    assert frame["family_size"].unique().tolist() == [2]
    np.testing.assert_allclose(frame["p_holm"], [0.02, np.nan, 0.03])


def test_refuses() -> None:
    with pytest.raises(InputError, match=r"p_values: shape \(1, 2\) given"):
        holm([[0.1, 0.2]])
    with pytest.raises(InputError, match="p_values: a value outside 0 to 1"):
        holm([0.1, 1.2])
    with pytest.raises(InputError, match="p_values: none given"):
        family("nothing", {})
