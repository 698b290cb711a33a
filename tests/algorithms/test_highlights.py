"""Highlights, against images that were put together from a surface and a highlight."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from algorithms.errors import InputError
from algorithms.highlights import highlight_threshold, separate_highlights, specular_free
from algorithms.light import Light
from tests.algorithms.lit_bodies import ellipsoid, lit

RED = np.array([0.7, 0.25, 0.15])
LIGHT = Light(120, 40)
MASK, NORMALS, _ = ellipsoid(96)
SHADING = lit(NORMALS, [LIGHT], 0.1)
HALFWAY = LIGHT.direction + np.array([0, 0, 1])
GLOSS = np.maximum(NORMALS @ (HALFWAY / np.linalg.norm(HALFWAY)), 0) ** 60
MATT = SHADING[..., None] * RED
SHINY = MATT + 0.6 * GLOSS[..., None]
COLOURS = st.tuples(*[st.floats(0.2, 1)] * 3).map(np.array)


@given(COLOURS, st.floats(0, 5), COLOURS)
def test_a_highlight_does_not_reach_the_specular_free_image(
    surface: np.ndarray, strength: float, light: np.ndarray
) -> None:
    # Theory: the dichromatic model.
    with_it = specular_free(surface + strength * light, light)
    assert_allclose(with_it, specular_free(surface, light), atol=1e-9)


@given(COLOURS, COLOURS, st.floats(0, 6.28))
def test_the_choice_of_axes_does_not_matter(
    surface: np.ndarray, light: np.ndarray, turn: float
) -> None:
    # Theory: two axes perpendicular to the light's, turned by any angle, give the same length.
    axis = light / np.linalg.norm(light)
    first = np.cross(axis, [0.3, -0.5, 0.8])
    first /= np.linalg.norm(first)
    first = Rotation.from_rotvec(turn * axis).apply(first)
    parts = np.hypot(surface @ first, surface @ np.cross(axis, first))
    assert_allclose(specular_free(surface, light), parts, atol=1e-9)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(st.floats(0.1, 3))
def test_it_is_proportional_to_the_shading(factor: float) -> None:
    assert_allclose(specular_free(factor * MATT), factor * specular_free(MATT), atol=1e-9)


def test_separation_finds_the_matt_surface() -> None:
    # Recovery, where the highlight is strong: nine tenths of it go.
    parts = separate_highlights(SHINY, MASK)
    bright = MASK & (GLOSS > 0.3)
    left = np.abs(parts.diffuse - MATT)[bright].mean()
    assert left < 0.1 * np.abs(SHINY - MATT)[bright].mean()
    assert_allclose(parts.diffuse + parts.specular, SHINY, atol=1e-5)


def test_a_matt_surface_stays_as_it_is() -> None:
    parts = separate_highlights(MATT, MASK)
    assert np.abs(parts.specular).max() < 0.01


def test_two_colours_keep_their_own() -> None:
    halves = np.where(np.arange(96)[None, :, None] < 48, RED, RED[::-1])
    matt = SHADING[..., None] * halves
    parts = separate_highlights(matt + 0.6 * GLOSS[..., None], MASK)
    bright = MASK & (GLOSS > 0.3)
    assert np.abs(parts.diffuse - matt)[bright].mean() < 0.1 * 0.6 * GLOSS[bright].mean()


def test_a_coloured_light_is_allowed_for() -> None:
    light = np.array([1.2, 1.0, 0.8])
    matt = MATT * light
    parts = separate_highlights(matt + 0.6 * GLOSS[..., None] * light, MASK, light)
    bright = MASK & (GLOSS > 0.3)
    assert np.abs(parts.diffuse - matt)[bright].mean() < 0.1 * 0.6 * GLOSS[bright].mean()


def test_a_grey_surface_and_the_outside_are_left_alone() -> None:
    grey = np.repeat((SHADING + GLOSS)[..., None], 3, axis=2)
    assert np.abs(separate_highlights(grey, MASK).specular).max() == 0
    assert np.abs(separate_highlights(SHINY, MASK).specular[~MASK]).max() == 0


def test_the_threshold_lies_between_surface_and_highlight() -> None:
    generator = np.random.default_rng(3)
    surface = generator.uniform(0.2, 0.5, 20_000)
    highlight = generator.uniform(0.5, 2.0, 600)
    assert 0.45 < highlight_threshold(np.concatenate([surface, highlight])) < 0.58


def test_bad_input_is_refused() -> None:
    with pytest.raises(InputError, match="luminance: one or more finite"):
        highlight_threshold([])
    with pytest.raises(InputError, match="light_colour"):
        specular_free(MATT, (1, 1, 0))
    with pytest.raises(InputError, match=r"image: \(height, width, 3\)"):
        specular_free(MATT[..., :2])
    with pytest.raises(InputError, match="image: finite"):
        separate_highlights(np.full((4, 4, 3), np.nan))
    with pytest.raises(InputError, match="mask"):
        separate_highlights(MATT, MASK[:-1])
