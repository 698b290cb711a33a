"""Caustics: their pattern follows the shape, their light is added where it is asked for."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.caustics import PRESETS, Caustics, add_caustics, caustic_map
from algorithms.caustics.pattern import direction_of_most_symmetry
from algorithms.color import luminance
from algorithms.depth import silhouette_relief
from algorithms.errors import InputError

Image = NDArray[np.float32]
SHAPE = (90, 120)
QUAD = [(30, 20), (80, 25), (90, 70), (25, 65)]


def ellipse(turned_deg: float, size_px: int = 100, ratio: float = 3) -> NDArray[np.bool_]:
    """Return a mask whose longer axis lies along the angle, counter-clockwise from +x."""
    row, column = np.mgrid[:size_px, :size_px] + 0.5 - size_px / 2
    turn = np.radians(turned_deg)
    along = column * np.cos(turn) - row * np.sin(turn)
    across = column * np.sin(turn) + row * np.cos(turn)
    return np.asarray(along**2 + (across * ratio) ** 2 < (0.45 * size_px) ** 2)


def photograph(seed: int = 1) -> Image:
    """Return a coloured surface with a texture and a gradient."""
    generator = np.random.default_rng(seed)
    texture = generator.uniform(0.8, 1.2, (*SHAPE, 1))
    gradient = np.linspace(0.2, 0.6, SHAPE[1])[None, :, None]
    return np.asarray(texture * gradient * [0.9, 0.6, 0.3], dtype=np.float32)


def spot() -> Image:
    """Return a map that is bright in its middle."""
    row, column = np.mgrid[:64, :64] - 31.5
    return np.asarray(np.exp(-(row**2 + column**2) / 150), dtype=np.float32)


# The pattern.


@pytest.mark.parametrize("turned_deg", [0, 20, 45, 77, 120, 165])
def test_the_direction_of_most_symmetry_is_across_a_long_body(turned_deg: float) -> None:
    mask = ellipse(turned_deg)
    found = direction_of_most_symmetry(silhouette_relief(mask), mask.astype(np.float32))
    # The search steps by a degree; the steps of the outline are worth about another one.
    error = (found - (turned_deg + 90) + 90) % 180 - 90
    assert abs(error) <= 3


@pytest.mark.parametrize("directions", [1, 2, 4, 12, 20])
def test_a_long_body_s_light_gathers_along_its_axis(directions: int) -> None:
    mask = ellipse(0)
    found = caustic_map(silhouette_relief(mask), mask, directions)
    across = found[:, 200:312].mean(axis=1)
    rows = found.shape[0]
    assert abs(np.argmax(across) - rows / 2) < 0.06 * rows


def test_a_mirror_image_of_a_body_casts_a_mirror_image() -> None:
    mask = ellipse(30) | ellipse(110, ratio=5)
    relief = silhouette_relief(mask)
    straight = caustic_map(relief, mask, 20)
    mirrored = caustic_map(relief[:, ::-1], mask[:, ::-1], 20)
    # A direction is found to a degree, and twenty of them are nine degrees apart.
    assert np.corrcoef(straight.ravel(), mirrored[:, ::-1].ravel())[0, 1] > 0.97


@pytest.mark.parametrize("factor", [2, 3])
def test_the_same_body_in_more_pixels_casts_the_same(factor: int) -> None:
    small, large = (ellipse(30, size_px=100 * each, ratio=2) for each in (1, factor))
    one, other = (caustic_map(silhouette_relief(mask), mask, 12) for mask in (small, large))
    rows = min(one.shape[0], other.shape[0])
    assert abs(one.shape[0] - other.shape[0]) <= 0.02 * rows
    assert np.corrcoef(one[:rows].ravel(), other[:rows].ravel())[0, 1] > 0.9


def test_height_and_offset_of_a_relief_change_nothing() -> None:
    mask = ellipse(30, ratio=2)
    relief = silhouette_relief(mask)
    np.testing.assert_allclose(
        caustic_map(3 * relief, mask, 4), caustic_map(relief, mask, 4), atol=1e-3
    )


def test_nothing_outside_the_mask_plays_a_part() -> None:
    mask = ellipse(30, ratio=2)
    relief = silhouette_relief(mask)
    unknown = np.where(mask, relief, np.nan)
    np.testing.assert_array_equal(caustic_map(unknown, mask, 4), caustic_map(relief, mask, 4))


def test_several_numbers_of_directions_give_a_map_each() -> None:
    mask = ellipse(30, ratio=2)
    relief = silhouette_relief(mask)
    both = caustic_map(relief, mask, (1, 12))
    assert both.shape == (2, *caustic_map(relief, mask, 1).shape)
    np.testing.assert_array_equal(both[1], caustic_map(relief, mask, 12))


def test_a_pattern_fills_0_to_1_and_vanishes_along_its_border() -> None:
    mask = ellipse(30, ratio=2)
    found = caustic_map(silhouette_relief(mask), mask, 20)
    assert found.dtype == np.float32
    assert max(found.shape) == 512
    assert found.min() == 0
    assert found.max() == pytest.approx(1)
    border = np.concatenate([found[[0, -1]].ravel(), found[:, [0, -1]].ravel()])
    assert border.max() < 0.02


def test_sharpness_is_a_power() -> None:
    mask = ellipse(30, ratio=2)
    relief = silhouette_relief(mask)
    plain = caustic_map(relief, mask, 4, sharpness=1)
    np.testing.assert_allclose(caustic_map(relief, mask, 4, sharpness=3), plain**3, atol=1e-6)


def test_no_relief_casts_nothing() -> None:
    assert not caustic_map(np.zeros((40, 60)), np.ones((40, 60), bool), 4).any()


# The light.


def test_the_luminance_added_is_the_strength_times_the_map() -> None:
    surface = np.full((*SHAPE, 3), 0.3, np.float32)
    result = add_caustics(surface, spot(), QUAD, 1.5, texture=0)
    assert luminance(result - surface).max() == pytest.approx(1.5 * 0.3, rel=0.02)


def test_maps_add_up() -> None:
    image = photograph()
    maps = np.stack([spot(), np.roll(spot(), 20, axis=1)])
    both = add_caustics(image, maps, QUAD, (0.5, 2.0))
    one, other = (
        add_caustics(image, plane, QUAD, strength) - image
        for plane, strength in zip(maps, (0.5, 2.0), strict=True)
    )
    np.testing.assert_allclose(both, image + one + other, atol=1e-5)


@pytest.mark.parametrize("texture", [0.0, 0.5, 1.0])
def test_the_surface_keeps_its_colour(texture: float) -> None:
    image = photograph()
    result = add_caustics(image, spot(), QUAD, 2.0, texture=texture)
    lit = luminance(result - image) > 0.1
    before, after = (picture / picture.sum(axis=2, keepdims=True) for picture in (image, result))
    assert lit.sum() > 100
    np.testing.assert_allclose(after[lit], before[lit], atol=1e-4)


def test_noise_in_the_dark_gives_light_no_colour() -> None:
    image = photograph()
    image[30:60] *= 1e-3
    image[30:60, ::2] *= [0, 0, 50]  # blue, and still dark
    added = add_caustics(image, spot(), QUAD, 2.0) - image
    red, green, blue = added[40:50, 50:65].mean(axis=(0, 1))
    assert red > green > blue


def test_the_surface_s_texture_shows_in_the_light() -> None:
    image = photograph()
    even = add_caustics(np.full_like(image, 0.3), spot(), QUAD, 2.0)[..., 1] - 0.3
    added = luminance(add_caustics(image, spot(), QUAD, 2.0) - image)
    printed = luminance(add_caustics(image, spot(), QUAD, 2.0, texture=0) - image)
    middle = even > 0.6 * even.max()
    texture = (luminance(image) / np.linspace(0.2, 0.6, SHAPE[1]))[middle]
    shape = even[middle]
    assert np.corrcoef(texture, added[middle] / shape)[0, 1] > 0.8
    np.testing.assert_allclose(printed[middle] / shape, np.mean(printed[middle] / shape), rtol=0.02)


def test_coloured_light_is_as_bright_as_white() -> None:
    image = np.full((*SHAPE, 3), 0.3, np.float32)
    added = add_caustics(image, spot(), QUAD, 1.0, colour=(0.2, 0.4, 0.1), texture=0) - image
    middle = added[..., 1] > 0.1
    np.testing.assert_allclose(added[middle][:, 0] / added[middle][:, 1], 0.5, rtol=1e-3)
    white = add_caustics(image, spot(), QUAD, 1.0, texture=0) - image
    np.testing.assert_allclose(luminance(added), luminance(white), rtol=1e-3, atol=1e-6)


def test_no_light_falls_where_it_is_spared() -> None:
    image = photograph()
    spared = np.zeros(SHAPE, bool)
    spared[:, :60] = True
    result = add_caustics(image, spot(), QUAD, 2.0, spared=spared)
    np.testing.assert_array_equal(result[:, :55], image[:, :55])
    assert luminance(result - image)[:, 62:].max() > 0.1


# Nothing where nothing is asked for.


@pytest.mark.parametrize(
    ("maps", "strength"),
    [(spot(), 0.0), (np.zeros((8, 8)), 1.0), (np.stack([spot(), spot()]), (0.0, 0.0))],
)
def test_no_strength_or_an_empty_map_return_the_input(maps: Image, strength: float) -> None:
    image = photograph()
    np.testing.assert_array_equal(add_caustics(image, maps, QUAD, strength), image)


def test_nothing_changes_outside_of_the_quadrilateral() -> None:
    image = photograph()
    result = add_caustics(image, np.ones((32, 32)), QUAD, 3.0)
    changed = (result != image).any(axis=2)
    rows, columns = np.nonzero(changed)
    assert (columns.min(), columns.max()) >= (25, 80)
    assert columns.max() < 90
    assert rows.min() >= 20
    assert rows.max() < 70


def test_black_and_dazzling_surfaces_stay_finite() -> None:
    image = photograph()
    image[:, 40:60] = 0
    image[50:, 60:] = 1e4
    result = add_caustics(image, spot(), QUAD, 3.0)
    assert result.dtype == np.float32
    assert np.isfinite(result).all()
    assert result.min() >= 0
    assert not add_caustics(np.zeros((*SHAPE, 3)), spot(), QUAD, 3.0).any()


def test_exposure_does_not_matter() -> None:
    image = photograph()
    one = add_caustics(image, spot(), QUAD, 2.0)
    np.testing.assert_allclose(add_caustics(50 * image, spot(), QUAD, 2.0), 50 * one, rtol=5e-3)


def test_the_input_is_left_alone() -> None:
    image = photograph()
    before = image.copy()
    add_caustics(image, spot(), QUAD, 2.0)
    np.testing.assert_array_equal(image, before)


# Settings.


def test_the_thesis_objects_have_the_directions_of_table_7_1() -> None:
    printed = {
        "mill": (1, 20),
        "can": (2,),
        "horse": (4,),
        "elephant": (20,),
        "vase": (1, 12),
        "doll": (1, 12),
        "car": (1, 12),
        "phone": (1, 4),
        "sphere": (1,),
        "skull": (1, 20),
        "vertebrae": (1, 20),
        "dolphin": (1, 20),
        "bull": (1, 20),
    }
    assert {name: preset.directions for name, preset in PRESETS.items()} == printed


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"directions": (0, 20)}, "directions: whole numbers of 1 to 20"),
        ({"directions": (1, 21)}, "directions: whole numbers of 1 to 20"),
        ({"directions": ()}, "directions: whole numbers of 1 to 20"),
        ({"directions": (1.5, 2)}, "directions: whole numbers of 1 to 20"),
        ({"strengths": (1.0,)}, "strength: .* each of 2 maps"),
        ({"strengths": (1.0, -1.0)}, "strength: .* each of 2 maps"),
        ({"strengths": (1.0, np.nan)}, "strength: .* each of 2 maps"),
        ({"sharpness": 0.0}, "sharpness: a finite number of more than 0"),
        ({"texture": 1.1}, "texture: 0..1"),
        ({"colour": (0.0, 0.0, 0.0)}, "colour: three finite numbers"),
        ({"colour": (1.0, 1.0)}, "colour: three finite numbers"),
    ],
)
def test_settings_refuse(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Caustics(**changes)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"image": np.zeros((*SHAPE, 4))}, "image: .height, width, 3."),
        ({"image": np.full((*SHAPE, 3), -0.1)}, "image: finite values of 0 or more"),
        ({"image": np.full((*SHAPE, 3), np.nan)}, "image: finite values of 0 or more"),
        ({"maps": np.zeros(4)}, "maps: .rows, columns."),
        ({"maps": np.full((4, 4), -1.0)}, "maps: finite values of 0 or more"),
        ({"maps": np.full((4, 4), np.inf)}, "maps: finite values of 0 or more"),
        ({"quad": [(30, 20), (90, 70), (80, 25), (25, 65)]}, "quad: four corners"),
        ({"quad": [(30, 20), (80, 25), (190, 70), (25, 65)]}, "quad: four corners"),
        ({"strength": (1.0, 2.0)}, "strength: .* each of 1 maps"),
        ({"strength": -1.0}, "strength: .* each of 1 maps"),
        ({"texture": -0.1}, "texture: 0..1"),
        ({"colour": (1.0, -1.0, 1.0)}, "colour: three finite numbers"),
        ({"spared": np.zeros((3, 3), bool)}, "spared: .90, 120. is accepted"),
    ],
)
def test_adding_refuses(changes: dict[str, Any], message: str) -> None:
    arguments: dict[str, Any] = {"image": photograph(), "maps": spot(), "quad": QUAD} | changes
    with pytest.raises(InputError, match=message):
        add_caustics(**arguments)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"relief": np.zeros((3, 3))}, "mask: .3, 3. is accepted"),
        ({"relief": np.full((100, 100), np.nan)}, "relief: finite values"),
        ({"mask": np.zeros((100, 100), bool)}, "mask: at least one pixel"),
        ({"directions": 0}, "directions: whole numbers of 1 to 20"),
        ({"directions": (1, 30)}, "directions: whole numbers of 1 to 20"),
        ({"directions": ()}, "directions: whole numbers of 1 to 20"),
        ({"sharpness": np.inf}, "sharpness: a finite number"),
    ],
)
def test_maps_refuse(changes: dict[str, Any], message: str) -> None:
    mask = ellipse(0)
    arguments: dict[str, Any] = {"relief": silhouette_relief(mask), "mask": mask} | changes
    with pytest.raises(InputError, match=message):
        caustic_map(**arguments)
