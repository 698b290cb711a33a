"""Noise that is estimated, and passes that are added until it is low enough."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms.color import encode_srgb
from algorithms.errors import InputError
from stimuli.convergence import half_difference_rms_of_255, render_until

TRUTH = np.linspace(0.2, 0.6, 64 * 64 * 3).reshape(64, 64, 3)
SIGMA = 0.05


def noisy(seed: int) -> NDArray[np.float32]:
    """Return the known image with known noise."""
    noise = np.random.default_rng(seed).normal(0, SIGMA, TRUTH.shape)
    return (TRUTH + noise).astype(np.float32)


def test_noise_is_that_of_the_mean() -> None:
    # Recovery: where the truth is known, the estimate is the error that is really left.
    found = render_until(noisy, exposure=1.0, seed=3, limit_of_255=2.0)
    error = encode_srgb(found.radiance) - encode_srgb(TRUTH)
    assert found.noise_rms_of_255 <= 2.0
    assert_allclose(found.noise_rms_of_255, 255 * np.sqrt((error**2).mean()), rtol=0.03)
    assert found.coverage is None


def test_passes_grow_as_the_square_of_the_wanted_precision() -> None:
    # Theory: the variance of a mean falls with the number of its parts.
    passes = [
        render_until(noisy, exposure=1.0, seed=0, limit_of_255=limit).passes for limit in (2.0, 0.5)
    ]
    assert passes[1] / passes[0] == pytest.approx(16, rel=0.3)
    assert all(count % 2 == 0 for count in passes)


def test_without_noise_two_passes_do() -> None:
    found = render_until(lambda _: TRUTH.astype(np.float32), exposure=1.0, seed=0)
    assert (found.passes, found.noise_rms_of_255) == (2, 0.0)
    assert_allclose(found.radiance, TRUTH, rtol=1e-6)


def test_coverage_is_averaged_and_does_not_count_as_noise() -> None:
    def render(seed: int) -> NDArray[np.float32]:
        alpha = np.full((64, 64, 1), float(seed % 2), np.float32)
        return np.concatenate([TRUTH.astype(np.float32), alpha], axis=-1)

    found = render_until(render, exposure=1.0, seed=0)
    assert found.noise_rms_of_255 == 0
    assert found.radiance.shape == TRUTH.shape
    assert found.coverage is not None
    assert (found.coverage == 0.5).all()


def test_refuses_what_takes_too_long() -> None:
    with pytest.raises(InputError, match=r"noise: .*/255 is left after 4 passes; .* accepted"):
        render_until(noisy, exposure=1.0, seed=0, limit_of_255=0.1, most_passes=4)


def test_clipped_noise_is_not_seen() -> None:
    # Property: noise beyond the top of the scale does not show on a display.
    first, second = (5 + noisy(seed) for seed in (1, 2))
    assert half_difference_rms_of_255(first, second, exposure=1.0) == 0
    assert half_difference_rms_of_255(first, second, exposure=0.1) > 0
