"""Where images lie in a window, against exact arithmetic."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from algorithms.errors import InputError
from experiments.lab.geometry import Area, fit, fit_grid

SIDES = st.integers(min_value=1, max_value=4000)
HALF = Fraction(1, 2)


@given(SIDES, SIDES, SIDES, SIDES, st.integers(0, 50), st.data())
def test_a_pixel_of_the_window_shows_the_image_pixel_under_its_centre(
    image_width: int, image_height: int, width: int, height: int, top: int, data: st.DataObject
) -> None:
    """Theory: the centre of the window's pixel, carried back by the exact scale."""
    placement = fit(image_width, image_height, Area(0, top, width, height))
    x = data.draw(st.integers(-2, width + 2))
    y = data.draw(st.integers(top - 2, top + height + 2))
    area = placement.area
    column = math.floor((x + HALF - area.left_px) * Fraction(image_width, area.width_px))
    row = math.floor((y + HALF - area.top_px) * Fraction(image_height, area.height_px))
    inside = 0 <= column < image_width and 0 <= row < image_height
    assert placement.image_pixel(x, y) == ((row, column) if inside else None)


@given(SIDES, SIDES, SIDES, SIDES)
def test_an_image_stays_inside_its_area_and_is_never_enlarged(
    image_width: int, image_height: int, width: int, height: int
) -> None:
    """Property: inside, centred to a pixel, and touching a side unless shown at its own size."""
    area = fit(image_width, image_height, Area(3, 7, width, height)).area
    assert area.width_px <= min(width, image_width)
    assert area.height_px <= min(height, image_height)
    left, right = area.left_px - 3, 3 + width - area.left_px - area.width_px
    assert 0 <= right - left <= 1
    full_size = (area.width_px, area.height_px) == (image_width, image_height)
    assert full_size or area.width_px >= width - 1 or area.height_px >= height - 1


@given(SIDES, SIDES, SIDES, SIDES)
def test_points_of_the_image_and_pixels_of_the_window_agree(
    image_width: int, image_height: int, width: int, height: int
) -> None:
    """Property: the image's corners go to the corners of its area."""
    placement = fit(image_width, image_height, Area(0, 0, width, height))
    area = placement.area
    assert placement.window_point(0, 0) == (area.left_px, area.top_px)
    right, bottom = placement.window_point(image_width, image_height)
    assert math.isclose(right, area.left_px + area.width_px)
    assert math.isclose(bottom, area.top_px + area.height_px)


@given(SIDES, SIDES, SIDES, SIDES, SIDES, st.integers(1, 4))
def test_a_width_that_is_asked_for_is_kept_to_the_pixel_or_refused(
    image_width: int, image_height: int, width: int, height: int, wanted: int, count: int
) -> None:
    """Property: so wide, in proportion and within the area; refused only where it does not fit."""
    available = Area(3, 7, width, height)
    fitting = wanted <= min(Fraction(width), Fraction(height * image_width, image_height))
    if fitting:
        area = fit(image_width, image_height, available, wanted).area
        assert area.width_px == wanted
        assert area.height_px == max(1, int(Fraction(image_height * wanted, image_width)))
        assert 3 <= area.left_px <= 3 + width - area.width_px
        assert 7 <= area.top_px <= 7 + height - area.height_px
    else:
        with pytest.raises(InputError, match=r"^display: images .* do not fit"):
            fit(image_width, image_height, available, wanted)
    try:
        areas = fit_grid([(image_width, image_height)] * count, available, width_px=wanted)
    except InputError:
        assert count > 1 or not fitting
    else:
        assert [area.width_px for area in areas] == [wanted] * count
        assert all(area.left_px >= 3 and area.top_px >= 7 for area in areas)
        assert max(area.left_px + area.width_px for area in areas) <= 3 + width
