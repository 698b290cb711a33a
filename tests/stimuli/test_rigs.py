import doctest

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.light import angle_between_deg
from stimuli.light_linking import rigs
from stimuli.light_linking.rigs import AMBIENT, CENTRE_ELEVATIONS_DEG, KEY_INTENSITY, diverging_keys

PLACEMENTS = st.sampled_from(sorted(CENTRE_ELEVATIONS_DEG))
SIDES = st.sampled_from([-1, 1])


@given(PLACEMENTS, st.floats(0, 90), SIDES)
def test_keys_diverge_by_their_angle_in_the_xz_plane(
    placement: str, divergence_deg: float, side: int
) -> None:
    # Definition: each of the two moves by half, about the vertical axis y.
    keys = diverging_keys(placement, divergence_deg, side)
    assert_allclose(angle_between_deg(*keys), divergence_deg, atol=1e-9)
    assert [key.direction[1] for key in keys] == [0, 0]
    assert {key.intensity for key in keys} == {KEY_INTENSITY}
    centre = np.sum([key.direction for key in keys], axis=0)
    centre_deg = np.degrees(np.arctan2(centre[2], centre[0]))
    assert_allclose(centre_deg, CENTRE_ELEVATIONS_DEG[placement], atol=1e-9)


@given(PLACEMENTS, st.floats(0.1, 90))
def test_side_swaps_the_lights_and_names_the_wrong_one(
    placement: str, divergence_deg: float
) -> None:
    key, wrong = diverging_keys(placement, divergence_deg, side=1)
    assert wrong.direction[2] > key.direction[2]  # turned towards the viewer
    assert diverging_keys(placement, divergence_deg, side=-1) == (wrong, key)


@pytest.mark.parametrize(("placement", "signs"), [("front", {1}), ("back", {-1})])
def test_front_and_back_stay_on_their_side(placement: str, signs: set[int]) -> None:
    # Published: the quadrants of Lopez-Moreno 2011, fig. 2.2.
    for divergence_deg in range(0, 90, 10):
        keys = diverging_keys(placement, divergence_deg, side=1)
        assert {int(np.sign(key.direction[2])) for key in keys} == signs
        assert all(key.direction[0] > 0 for key in keys)


def test_ambient_lights() -> None:
    # Published (sec. 2.3): 45 degrees between +z and -x, and +y, each a quarter of the key light.
    first, second = AMBIENT
    assert_allclose(first.direction, np.array([-1, 0, 1]) / np.sqrt(2), atol=1e-12)
    assert_allclose(second.direction, [0, 1, 0], atol=1e-12)
    assert {first.intensity, second.intensity} == {KEY_INTENSITY / 4}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("side", 10, 1), "placement: 'side' given, front, back, front-back accepted"),
        (("front", 91, 1), "divergence_deg: 91 given, 0 to 90 accepted"),
        (("front", float("nan"), 1), "divergence_deg: nan given"),
        (("front", 10, 0), "side: 0 given, -1 or 1 accepted"),
    ],
)
def test_refuses(arguments: tuple[str, float, int], message: str) -> None:
    with pytest.raises(InputError, match=message):
        diverging_keys(*arguments)


def test_examples_in_docstrings_are_true() -> None:
    found = doctest.testmod(rigs)
    assert (found.attempted, found.failed) == (1, 0)
