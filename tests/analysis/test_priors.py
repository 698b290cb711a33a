import numpy as np
import pytest
from psignifit._priors import default_prior

from analysis.thresholds.priors import default_priors


@pytest.mark.parametrize("name", ["threshold", "width", "lambda", "eta"])
def test_priors_are_those_of_psignifit(name: str) -> None:
    # Another implementation: psignifit's own, up to a constant factor.
    levels = [5.0, 15.0, 20.0, 45.0]
    theirs = default_prior(name, (5.0, 45.0), width_min=5.0, width_alpha=0.05, beta=10)
    ends = {"threshold": (-14.9, 64.9), "width": (5.01, 119.0)}.get(name, (0.0, 0.9))
    values = np.linspace(*ends, 500)
    density = default_priors(levels)[name](values)
    np.testing.assert_allclose(density / density.sum(), theirs(values) / theirs(values).sum())
