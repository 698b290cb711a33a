"""Lifting a shadow: recovery of the surface that was darkened, and nothing else."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.errors import InputError
from algorithms.shadows import lift_shadow

Image = NDArray[np.float32]
SHAPE = (90, 120)
LEFT = np.array([0.3, 0.35, 0.45])  # of the light: what the sky alone gives


def outline() -> NDArray[np.bool_]:
    row, column = np.mgrid[: SHAPE[0], : SHAPE[1]] + 0.5
    return np.asarray(((row - 45) / 20) ** 2 + ((column - 60) / 35) ** 2 < 1)


def surface() -> Image:
    texture = np.random.default_rng(1).uniform(0.9, 1.1, (*SHAPE, 1))
    gradient = np.linspace(0.4, 0.8, SHAPE[1])[None, :, None]
    return np.asarray(texture * gradient * [0.8, 0.7, 0.5], dtype=np.float32)


def shadowed(penumbra_px: float = 3.0) -> Image:
    coverage = ndimage.gaussian_filter(outline().astype(float), penumbra_px, truncate=3)
    return np.asarray(surface() * (1 - coverage[..., None] * (1 - LEFT)), dtype=np.float32)


@pytest.mark.parametrize("penumbra_px", [1.0, 3.0])
@pytest.mark.parametrize("wrong_px", [0, 1])
def test_the_surface_in_light_comes_back(penumbra_px: float, wrong_px: int) -> None:
    mask = np.roll(outline(), wrong_px, axis=1)
    lifted = lift_shadow(shadowed(penumbra_px), mask, penumbra_px=2 * penumbra_px + wrong_px)
    error = lifted / surface() - 1
    # The bands on both sides are some pixels apart, and so is the gradient between them.
    assert np.abs(error).max() < 0.3  # of a shadow of a third
    assert np.abs(np.median(error[outline()], axis=0)).max() < 0.08


def test_half_an_amount_is_half_of_the_missing_light() -> None:
    image = shadowed()
    whole, half = (lift_shadow(image, outline(), amount) for amount in (1.0, 0.5))
    np.testing.assert_allclose(half, (whole + image) / 2, atol=1e-5)


def test_what_is_spared_stays_and_tells_nothing() -> None:
    image, spared = shadowed(), np.zeros(SHAPE, bool)
    spared[:45, 40:80] = True
    image[spared] = (3.0, 0.0, 0.0)
    lifted = lift_shadow(image, outline(), spared=spared)
    np.testing.assert_array_equal(lifted[spared], image[spared])
    error = lifted / surface() - 1
    assert np.abs(error[50:, 30:90]).max() < 0.15


def test_nothing_changes_beyond_the_penumbra() -> None:
    image = shadowed()
    beyond = ~ndimage.binary_dilation(outline(), np.ones((3, 3), bool), iterations=14)
    np.testing.assert_array_equal(lift_shadow(image, outline())[beyond], image[beyond])


@pytest.mark.parametrize(("shadow", "amount"), [(outline(), 0.0), (np.zeros(SHAPE, bool), 1.0)])
def test_no_amount_or_no_shadow_returns_the_input(shadow: NDArray[np.bool_], amount: float) -> None:
    np.testing.assert_array_equal(lift_shadow(shadowed(), shadow, amount), shadowed())


def test_a_bright_mark_is_not_darkened() -> None:
    image = surface()
    image[outline()] *= 2
    np.testing.assert_allclose(lift_shadow(image, outline()), image, rtol=1e-5)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"image": np.zeros(SHAPE)}, "image: .height, width, 3."),
        ({"shadow": np.zeros((3, 3), bool)}, "shadow: .90, 120. is accepted"),
        ({"shadow": np.ones(SHAPE, bool)}, "shadow: one with the same surface in light"),
        ({"spared": np.zeros((3, 3), bool)}, "spared: .90, 120. is accepted"),
        ({"amount": 1.5}, "amount: 0..1"),
        ({"penumbra_px": 0.0}, "penumbra_px: a finite number of more than 0"),
    ],
)
def test_refuses(changes: dict[str, Any], message: str) -> None:
    arguments: dict[str, Any] = {"image": shadowed(), "shadow": outline()} | changes
    with pytest.raises(InputError, match=message):
        lift_shadow(**arguments)
