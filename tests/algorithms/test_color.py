import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from skimage.color import rgb2xyz
from skimage.color.colorconv import xyz_from_rgb

from algorithms.color import decode_srgb, encode_srgb, luminance

DIGITS = np.arange(256) / 255


@pytest.mark.parametrize(
    ("linear", "encoded"),
    [
        (0.0, 0.0),
        (0.0031308, 0.04045),  # where the line meets the power
        (0.001, 0.01292),
        (0.18, 0.46136),  # middle grey
        (0.214041, 0.5),
        (1.0, 1.0),
    ],
)
def test_published_values_of_srgb(linear: float, encoded: float) -> None:
    # IEC 61966-2-1, to the digits of its constants.
    assert_allclose(encode_srgb(np.array(linear)), encoded, atol=1e-5)
    assert_allclose(decode_srgb(np.array(encoded)), linear, atol=1e-5)


def test_transfer_agrees_with_scikit_image() -> None:
    # Another implementation: scikit-image decodes sRGB on its way to CIE XYZ.
    grey = np.repeat(DIGITS[:, None], 3, axis=1)
    in_xyz = rgb2xyz(grey) @ np.linalg.inv(xyz_from_rgb).T
    assert_allclose(in_xyz[:, 0], decode_srgb(DIGITS), atol=1e-12)


@given(st.floats(0, 1))
def test_encoding_and_decoding_undo_each_other(value: float) -> None:
    # The standard's rounded constants leave a step of about 1e-8 where the two branches meet.
    assert_allclose(decode_srgb(encode_srgb(np.array(value))), value, atol=1e-7)


def test_eight_bits_survive() -> None:
    assert (np.round(encode_srgb(decode_srgb(DIGITS)) * 255) == np.arange(256)).all()


@given(st.floats(0, 1), st.floats(0, 1))
def test_encoding_keeps_order(first: float, second: float) -> None:
    low, high = sorted((first, second))
    # Rounding of the power may undo an order of neighbouring numbers.
    assert encode_srgb(np.array(low)) <= encode_srgb(np.array(high)) + 1e-7


def test_values_outside_the_display_are_clipped() -> None:
    assert_allclose(encode_srgb(np.array([-1.0, 7.0])), [0, 1])
    assert_allclose(decode_srgb(np.array([-1.0, 7.0])), [0, 1])


def test_luminance_is_the_y_of_cie_xyz() -> None:
    # Another implementation: scikit-image's matrix from Rec. 709 primaries to CIE XYZ.
    image = np.random.default_rng(1).uniform(size=(4, 5, 3))
    assert_allclose(luminance(image), image @ xyz_from_rgb[1], atol=1e-4)
    assert_allclose(luminance(np.ones(3)), 1)
