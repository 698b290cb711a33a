"""The design of experiment 1, before anything is rendered."""

from collections import Counter
from itertools import pairwise, product

import numpy as np
import pytest

from algorithms.light import angle_between_deg
from stimuli.light_linking.materials import TABLE_2_1
from stimuli.light_linking.rigs import AMBIENT
from stimuli.sets.divergence import MAIN_ORDER, PRACTICE_ORDER, Cell, plan

LEVELS_DEG = range(0, 91, 10)
PLACEMENTS = ("front", "back", "front-back")
DIFFUSE, SHINY = "abcf", "degh"


def cells_of(seed: int = 1, *, quick: bool = False, replicates: int = 1) -> tuple[Cell, ...]:
    """Return the plan made from a seed."""
    return plan(np.random.default_rng(seed), quick=quick, replicates=replicates)


def main_cells(seed: int = 1, *, quick: bool = False, replicates: int = 1) -> list[Cell]:
    """Return the main images of a plan."""
    cells = cells_of(seed, quick=quick, replicates=replicates)
    return [cell for cell in cells if cell.role == "main"]


def test_sixty_images_hold_every_combination_once() -> None:
    # Published: 10 divergences x 3 placements x 2 kinds of target (Lopez-Moreno 2011, sec. 2.3).
    found = Counter((c.divergence_deg, c.placement, c.material) for c in main_cells())
    assert found == Counter(product(LEVELS_DEG, PLACEMENTS, ("diffuse", "shiny")))


@pytest.mark.parametrize(("quick", "main"), [(False, 60), (True, 30)])
def test_roles(quick: bool, main: int) -> None:
    cells = cells_of(quick=quick)
    assert Counter(cell.role for cell in cells) == {"main": main, "practice": 3, "example": 1}
    others = [cell for cell in cells if cell.role != "main"]
    assert {cell.divergence_deg for cell in others} == {90}  # plain to see
    assert {cell.placement for cell in others if cell.role == "practice"} == set(PLACEMENTS)


def test_quick_set_keeps_levels_and_balances_finishes() -> None:
    cells = main_cells(quick=True)
    cell_counts = Counter((cell.divergence_deg, cell.placement) for cell in cells)
    assert cell_counts == Counter(product(LEVELS_DEG, PLACEMENTS))
    for placement in PLACEMENTS:
        finishes = Counter(cell.material for cell in cells if cell.placement == placement)
        assert finishes == {"diffuse": 5, "shiny": 5}


@pytest.mark.parametrize("quick", [False, True])
@pytest.mark.parametrize("replicates", [4, 8])
def test_replicates_cross_target_and_level(quick: bool, replicates: int) -> None:
    cells = main_cells(quick=quick, replicates=replicates)
    for level, placement in product(LEVELS_DEG, PLACEMENTS):
        for finish, letters in (("diffuse", DIFFUSE), ("shiny", SHINY)):
            targets = Counter(
                c.target
                for c in cells
                if (c.divergence_deg, c.placement, c.material) == (level, placement, finish)
            )
            assert targets in (Counter(letters * (replicates // 4)), Counter())
    assert {cell.replicate for cell in cells} == set(range(replicates))


def test_target_has_the_finish_of_its_cell() -> None:
    # Published: table 2.1 read column by column.
    for cell in cells_of(replicates=4):
        assert cell.target in (DIFFUSE if cell.material == "diffuse" else SHINY)


def test_no_image_stands_twice() -> None:
    cells = cells_of(replicates=8)
    assert (
        len({cell.id for cell in cells}) == len({cell.image().stem for cell in cells}) == len(cells)
    )


def test_only_the_target_has_another_key_light() -> None:
    for cell in cells_of():
        rigs = dict(zip(cell.order, cell.image().rigs(), strict=True))
        wrong, *ambient = rigs.pop(cell.target)
        ((key, *others),) = set(rigs.values())
        assert ambient == others == list(AMBIENT)
        assert angle_between_deg(key, wrong) == pytest.approx(cell.divergence_deg)


def test_file_name_tells_nothing_about_the_answer() -> None:
    # Property: with the same place in the design, another target has the same file.
    for first, second in zip(cells_of(1), cells_of(2), strict=True):
        assert first.image().stem == second.image().stem


def test_targets_and_sides_are_drawn() -> None:
    # Theory: over many plans each of four targets and each side is as likely as the others.
    cells = [cell for seed in range(40) for cell in main_cells(seed)]
    for letters in (DIFFUSE, SHINY):
        counts = Counter(cell.target for cell in cells if cell.target in letters)
        expected = sum(counts.values()) / 4
        assert all(abs(counts[letter] - expected) < 4 * expected**0.5 for letter in letters)
    turned = sum(cell.side == 1 for cell in cells)
    assert abs(turned - len(cells) / 2) < 2 * len(cells) ** 0.5
    assert main_cells(1) == main_cells(1) != main_cells(2)


@pytest.mark.parametrize("order", [MAIN_ORDER, PRACTICE_ORDER])
def test_no_two_materials_alike_stand_side_by_side(order: str) -> None:
    assert sorted(order) == sorted(TABLE_2_1)
    rows = [order[:4], order[4:]]
    beside = [pair for row in rows for pair in pairwise(row)]
    beside += list(zip(*rows, strict=True))
    for first, second in beside:
        one, other = TABLE_2_1[first], TABLE_2_1[second]
        assert (one.finish, one.pattern) != (other.finish, other.pattern)


def test_practice_stands_in_another_order() -> None:
    assert all(one != other for one, other in zip(MAIN_ORDER, PRACTICE_ORDER, strict=True))
