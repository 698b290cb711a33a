"""Light detection against bodies shaded by hand, and what it refuses."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms import Light, angle_between_deg, detect_lights
from algorithms.errors import InputError
from tests.algorithms.lit_bodies import ellipsoid, grey, lit

METHODS: tuple[Literal["fitting", "voting"], ...] = ("fitting", "voting")
MASK, NORMALS, POSITIONS = ellipsoid(128)
LIGHT = Light(130, 30, 0.8)
IMAGE = grey(lit(NORMALS, [LIGHT], 0.05))


# Recovery: the model's own assumptions hold, so only sampling errs, by about a degree.


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=12, deadline=None, derandomize=True)
@given(azimuth_deg=st.floats(0, 359), elevation_deg=st.floats(-40, 75), ambient=st.floats(0, 0.3))
def test_one_light_on_a_sphere(
    method: Literal["fitting", "voting"],
    azimuth_deg: float,
    elevation_deg: float,
    ambient: float,
) -> None:
    light = Light(azimuth_deg, elevation_deg, 0.8)
    found = detect_lights(grey(lit(NORMALS, [light], ambient)), MASK, method)
    assert len(found.lights) == 1
    assert angle_between_deg(found.lights[0], light) < 4
    assert_allclose(found.lights[0].intensity, 0.8, rtol=0.1)
    assert_allclose(found.ambient, ambient, atol=0.04)
    assert found.confidence > 0.95


def test_a_light_from_the_viewer() -> None:
    # No azimuth shows along the outline; the interior decides.
    light = Light(20, 88)
    found = detect_lights(grey(lit(NORMALS, [light])), MASK)
    assert len(found.lights) == 1
    assert angle_between_deg(found.lights[0], light) < 5


@pytest.mark.parametrize("axes", [(1.0, 0.6, 0.8), (0.5, 1.0, 0.65)])
def test_one_light_on_an_ellipsoid(axes: tuple[float, float, float]) -> None:
    mask, normals, _ = ellipsoid(160, axes)
    found = detect_lights(grey(lit(normals, [LIGHT], 0.1)), mask)
    assert angle_between_deg(found.lights[0], LIGHT) < 6


@pytest.mark.parametrize("turn_deg", [0, 37, 200])
@pytest.mark.parametrize("separation_deg", [60, 110, 180])
def test_two_lights(turn_deg: float, separation_deg: float) -> None:
    lights = [Light(turn_deg, 10, 0.8), Light(turn_deg + separation_deg, 30, 0.5)]
    found = detect_lights(grey(lit(NORMALS, lights, 0.05)), MASK)
    assert len(found.lights) == 2
    for ours, light in zip(found.lights, lights, strict=True):
        assert angle_between_deg(ours, light) < 8


@pytest.mark.parametrize("axes", [(1.0, 1.0, 1.0), (1.0, 0.6, 0.8)])
def test_a_light_and_a_weak_one_50_degrees_apart(axes: tuple[float, float, float]) -> None:
    mask, normals, _ = ellipsoid(128, axes)
    lights = [Light(37, 10, 0.9), Light(87, 30, 0.3)]
    found = detect_lights(grey(lit(normals, lights, 0.05)), mask)
    assert len(found.lights) == 2
    for ours, light in zip(found.lights, lights, strict=True):
        assert angle_between_deg(ours, light) < 8


@pytest.mark.parametrize("elevation_deg", [60, 68])
def test_what_a_table_throws_back_is_no_second_light(elevation_deg: float) -> None:
    # Below an object lit from the front: half of all directions, from under it and behind.
    thrown_back = 0.2 * (1 - NORMALS[..., 1]) / 2 * (1 - NORMALS[..., 2])
    image = grey(lit(NORMALS, [Light(80, elevation_deg, 0.9)]) + thrown_back)
    assert len(detect_lights(image, MASK).lights) == 1


def test_three_lights() -> None:
    lights = [Light(90, 0, 1.0), Light(180, 45, 0.9), Light(315, -45, 0.8)]  # as in table 3.2
    found = detect_lights(grey(lit(NORMALS, lights)), MASK)
    assert len(found.lights) == 3
    for light in lights:
        assert min(angle_between_deg(ours, light) for ours in found.lights) < 12


@pytest.mark.parametrize(("distance", "low", "high"), [(1.5, 1.2, 2.0), (2.0, 1.5, 2.8)])
def test_a_near_light_has_a_distance(distance: float, low: float, high: float) -> None:
    light = Light(40, 20, 0.8, distance)
    found = detect_lights(grey(lit(NORMALS, [light], 0.02, POSITIONS)), MASK)
    assert len(found.lights) == 1
    assert found.lights[0].distance is not None
    assert low < found.lights[0].distance < high
    assert angle_between_deg(found.lights[0], light) < 8


# Properties.


def test_a_quarter_turn_of_the_image_turns_the_lights() -> None:
    image = grey(lit(NORMALS, [Light(20, 15, 0.9), Light(140, 40, 0.5)]))
    before, after = (detect_lights(np.rot90(i), np.rot90(MASK)) for i in (image, np.rot90(image)))
    for first, second in zip(before.lights, after.lights, strict=True):
        turned = Light(first.azimuth_deg + 90, first.elevation_deg)
        assert angle_between_deg(turned, second) < 3


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("unit", [1e-3, 40.0])
def test_the_unit_of_the_image_is_that_of_the_intensities(
    method: Literal["fitting", "voting"], unit: float
) -> None:
    one, other = (detect_lights(IMAGE * factor, MASK, method) for factor in (1.0, unit))
    assert_allclose(other.lights[0].intensity, unit * one.lights[0].intensity, rtol=1e-3)
    assert angle_between_deg(one.lights[0], other.lights[0]) < 0.2


def test_what_lies_outside_the_mask_does_not_matter() -> None:
    other = IMAGE.copy()
    other[~MASK] = np.nan
    assert detect_lights(other, MASK).lights == detect_lights(IMAGE, MASK).lights


def test_a_bright_background_does_not_bleed_in() -> None:
    # An antialiased edge mixes background into the outline's pixels.
    mask, normals, _ = ellipsoid(512)
    fine = np.where(mask, lit(normals, [LIGHT]), 5.0)
    mixed = fine.reshape(128, 4, 128, 4).mean(axis=(1, 3))
    half = mask.reshape(128, 4, 128, 4).mean(axis=(1, 3)) > 0.5
    found = detect_lights(mixed, half)
    assert len(found.lights) == 1
    assert angle_between_deg(found.lights[0], LIGHT) < 5


def test_highlights_texture_and_noise_are_outvoted() -> None:
    generator = np.random.default_rng(5)
    shading = lit(NORMALS, [LIGHT], 0.05)
    texture = 1 + 0.3 * np.sign(np.sin(0.5 * np.arange(128)))[:, None]
    halfway = LIGHT.direction + np.array([0, 0, 1])
    gloss = np.maximum(NORMALS @ (halfway / np.linalg.norm(halfway)), 0) ** 80
    noise = generator.normal(0, 0.03, shading.shape)
    found = detect_lights(shading * texture + gloss + noise, MASK)
    assert len(found.lights) == 1
    assert angle_between_deg(found.lights[0], LIGHT) < 8
    assert found.confidence < 0.97


def test_the_same_picture_gives_the_same_lights() -> None:
    assert detect_lights(IMAGE, MASK) == detect_lights(IMAGE, MASK)


# Stated rules.


def test_luminance_alone_is_accepted() -> None:
    assert_allclose(
        detect_lights(IMAGE[..., 0], MASK).lights[0].direction,
        detect_lights(IMAGE, MASK).lights[0].direction,
        atol=1e-6,
    )


def test_of_several_components_the_largest_is_used() -> None:
    mask = MASK.copy()
    mask[:4, :4] = True
    found = detect_lights(IMAGE, mask)
    assert angle_between_deg(found.lights[0], LIGHT) < 4
    assert "2 components" in found.remarks[0]


def test_clipped_pixels_are_left_out() -> None:
    bright = grey(lit(NORMALS, [LIGHT], 0.05))
    clipped = np.minimum(bright, 0.7)
    found = detect_lights(clipped, MASK)
    assert angle_between_deg(found.lights[0], LIGHT) < 6
    assert "clipped" in found.remarks[0]


def test_an_object_may_be_cut_off_by_the_border() -> None:
    cut = np.s_[:, 40:]
    found = detect_lights(IMAGE[cut], MASK[cut])
    assert angle_between_deg(found.lights[0], LIGHT) < 15
    assert "cut off" in found.remarks[0]


def changed(place: tuple[int, int], value: float) -> NDArray[np.float64]:
    image = IMAGE.copy()
    image[place] = value
    return image


@pytest.mark.parametrize(
    ("image", "mask", "message"),
    [
        (IMAGE, MASK[:-1], "mask: .* height and width"),
        (IMAGE, np.zeros_like(MASK), "mask: it is empty"),
        (IMAGE, np.ones_like(MASK), "mask: it touches the image's border on all sides"),
        (IMAGE, np.pad(np.ones((5, 5), bool), ((60, 63), (60, 63))), "mask: the object is 5 x 5"),
        (IMAGE * 0, MASK, "image: the object is black"),
        (np.ones_like(IMAGE), MASK, "image: .* saturated"),
        (changed((64, 64), np.nan), MASK, "image: finite values"),
        (changed((64, 64), np.inf), MASK, "image: finite values"),
        (np.dstack([IMAGE, MASK]), MASK, "image: it has an alpha channel"),
        (IMAGE[..., :2], MASK, "image: .height, width, 3. or .height, width."),
        (IMAGE.astype(complex), MASK, "image: numbers are accepted"),
    ],
)
def test_bad_input_is_refused_in_one_line(
    image: NDArray[np.float64], mask: NDArray[np.bool_], message: str
) -> None:
    with pytest.raises(InputError, match=message) as caught:
        detect_lights(image, mask)
    assert "\n" not in str(caught.value)


def test_an_unknown_method_is_refused() -> None:
    with pytest.raises(InputError, match="method: 'guess' given"):
        detect_lights(IMAGE, MASK, "guess")  # type: ignore[arg-type]
