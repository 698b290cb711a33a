"""Regions: reading, numbering and outlining them."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from experiments.regions import numeral_places, outline

BOXES = st.tuples(*[st.integers(0, 39)] * 2, *[st.integers(1, 30)] * 2)


def regions_of(boxes: list[tuple[int, int, int, int]]) -> np.ndarray:
    """Label rectangles (top, left, height, width) in turn; later ones cover earlier ones."""
    regions = np.zeros((60, 60), np.uint8)
    for label, (top, left, height, width) in enumerate(boxes, start=1):
        regions[top : top + height, left : left + width] = label
    return regions


def uncovered(regions: np.ndarray, centre: tuple[float, float], size: int) -> bool:
    """Whether a numeral's square lies within the image and on no region."""
    left, top = (int(np.floor(middle - size / 2)) for middle in centre)
    inside = left >= 0 and top >= 0 and left + size <= 60 and top + size <= 60
    return inside and not regions[top : top + size, left : left + size].any()


@given(st.lists(BOXES, min_size=1, max_size=6))
def test_every_region_has_one_numeral_and_below_is_taken_where_it_is_free(
    boxes: list[tuple[int, int, int, int]],
) -> None:
    """Property, against the rule: the first free place of the list, which begins below."""
    regions = regions_of(boxes)
    places = numeral_places(regions, size_px=6, gap_px=1)
    assert set(places) == set(np.unique(regions)) - {0}
    for label, place in places.items():
        rows, columns = np.nonzero(regions == label)
        below = ((columns.min() + columns.max() + 1) / 2, rows.max() + 1 + 4.0)
        if uncovered(regions, below, 6):
            assert place == below


def test_a_numeral_without_room_below_goes_above() -> None:
    """Property: at the image's lower edge, and over a neighbour, there is no room."""
    at_the_edge = regions_of([(50, 20, 10, 10)])
    assert numeral_places(at_the_edge, 6, 1) == {1: (25.0, 46.0)}
    over_a_neighbour = regions_of([(20, 20, 10, 10), (30, 20, 30, 10)])
    assert numeral_places(over_a_neighbour, 6, 1)[1] == (25.0, 16.0)


@given(st.lists(BOXES, min_size=1, max_size=3), st.integers(1, 5))
def test_an_outline_is_what_lies_within_its_thickness_of_the_region(
    boxes: list[tuple[int, int, int, int]], thickness_px: int
) -> None:
    """Theory: the distance to the nearest pixel of the region, one pixel at a time."""
    regions = regions_of(boxes)
    label = len(boxes)
    members = np.argwhere(regions == label)
    pixels = np.argwhere(np.ones_like(regions, bool))
    squared = ((pixels[:, None, :] - members[None, :, :]) ** 2).sum(axis=2).min(axis=1)
    expected = (squared > 0) & (squared <= thickness_px**2)
    np.testing.assert_array_equal(outline(regions, label, thickness_px).ravel(), expected)
