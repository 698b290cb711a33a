"""The design of experiment 2, before anything is rendered."""

from collections import Counter
from itertools import pairwise, product

import numpy as np
import pytest

from algorithms.light import angle_between_deg
from stimuli.light_linking.materials import ROUGHNESS, exponent_of
from stimuli.light_linking.rigs import AMBIENT
from stimuli.sets.texture import (
    ALBEDO_RATIO,
    CHECKERBOARDS,
    HALF_SHININESS,
    LIGHT_ALBEDOS,
    Cell,
    plan,
)

LEVELS_DEG = range(0, 91, 10)


def cells_of(seed: int = 1, *, quick: bool = False, replicates: int = 1) -> tuple[Cell, ...]:
    """Return the plan made from a seed."""
    return plan(np.random.default_rng(seed), quick=quick, replicates=replicates)


def test_forty_images_hold_every_combination_once() -> None:
    # Published: 4 textures x 10 divergences (Lopez-Moreno 2011, sec. 2.4).
    found = Counter((c.texture, c.divergence_deg) for c in cells_of() if c.role == "main")
    assert found == Counter(product(CHECKERBOARDS, LEVELS_DEG))


def test_each_tile_is_half_as_wide_as_the_one_before() -> None:
    # Published: sec. 2.4.
    assert list(CHECKERBOARDS) == ["low", "medium", "medium-high", "high"]
    assert all(second == 2 * first for first, second in pairwise(CHECKERBOARDS.values()))


def test_shininess_is_half_of_experiment_one() -> None:
    # Published: sec. 2.4; the Phong-like exponent is what is halved.
    assert exponent_of(HALF_SHININESS) == pytest.approx(exponent_of(ROUGHNESS) / 2)
    for placed in cells_of()[0].place(1, 8):
        assert placed.material.finish == "shiny"
        assert placed.material.roughness == HALF_SHININESS


@pytest.mark.parametrize(("quick", "main"), [(False, 40), (True, 10)])
def test_roles(quick: bool, main: int) -> None:
    cells = cells_of(quick=quick)
    assert Counter(cell.role for cell in cells) == {"main": main, "practice": 3, "example": 1}
    assert {cell.divergence_deg for cell in cells if cell.role != "main"} == {90}  # plain to see
    main_cells = [cell for cell in cells if cell.role == "main"]
    assert {cell.divergence_deg for cell in main_cells} == set(LEVELS_DEG)
    assert {cell.texture for cell in main_cells} == set(CHECKERBOARDS)


def test_each_checkerboard_stands_on_two_objects() -> None:
    # So that the target's checkerboard does not tell which one it is.
    for cell in cells_of():
        assert Counter(cell.checkerboards) == dict.fromkeys(CHECKERBOARDS, 2)
        assert sorted(cell.light_albedos) == sorted(LIGHT_ALBEDOS)


@pytest.mark.parametrize("replicates", [8, 16])
def test_replicates_cross_target_and_level(replicates: int) -> None:
    cells = [cell for cell in cells_of(replicates=replicates) if cell.role == "main"]
    for texture, level in product(CHECKERBOARDS, LEVELS_DEG):
        targets = Counter(
            c.target for c in cells if (c.texture, c.divergence_deg) == (texture, level)
        )
        assert targets == dict.fromkeys(range(1, 9), replicates // 8)


def test_only_the_target_has_another_key_light() -> None:
    for cell in cells_of():
        rigs = cell.image().rigs()
        wrong, *ambient = rigs.pop(cell.target - 1)
        ((key, *others),) = set(rigs)
        assert ambient == others == list(AMBIENT)
        assert angle_between_deg(key, wrong) == pytest.approx(cell.divergence_deg)
        assert key.elevation_deg == pytest.approx(-wrong.elevation_deg)  # front-back


def test_everything_is_drawn_for_each_image() -> None:
    # Theory: over many plans each place and each side is as likely as the others.
    cells = [cell for seed in range(40) for cell in cells_of(seed) if cell.role == "main"]
    counts = Counter(cell.target for cell in cells)
    expected = len(cells) / 8
    assert all(abs(counts[target] - expected) < 4 * expected**0.5 for target in range(1, 9))
    assert abs(sum(cell.side == 1 for cell in cells) - len(cells) / 2) < 2 * len(cells) ** 0.5
    assert cells_of(1) == cells_of(1) != cells_of(2)


def test_shapes_differ_from_image_to_image_and_within() -> None:
    first, second = (cell.place(1, 8) for cell in cells_of()[:2])
    shapes = [placed.mesh.vertices for placed in (*first, *second)]
    for one, other in pairwise(shapes):
        assert np.abs(one - other).max() > 0.1
    again = cells_of()[0].place(1, 8)
    assert all(
        (a.mesh.vertices == b.mesh.vertices).all() for a, b in zip(first, again, strict=True)
    )


def test_tiles_of_every_object_have_the_same_ratio() -> None:
    for placed, light in zip(cells_of()[0].place(1, 4), cells_of()[0].light_albedos, strict=True):
        dark, lightest = placed.albedo.min(), placed.albedo.max()
        assert lightest == pytest.approx(light)
        assert lightest / dark == pytest.approx(ALBEDO_RATIO)


def test_file_name_tells_nothing_about_the_answer() -> None:
    # Property: with the same place in the design, another target has the same files.
    for first, second in zip(cells_of(1), cells_of(2), strict=True):
        assert first.image().stem == second.image().stem
        assert first.image().scene == second.image().scene
