"""The trials of a fixed design: a deterministic function of study, stimuli and assignment."""

import numpy as np

from algorithms.errors import InputError
from experiments.planning.designs import (
    Shown,
    arrange,
    block_order,
    catch_comparisons,
    drawn_subset,
    in_blocks,
    ordered,
)
from experiments.planning.presentations import Answer, Assignment, Phase, Trial
from experiments.study import Study, chosen
from stimuli.manifest import StimulusSet

__all__ = ["Answer", "Assignment", "Phase", "Trial", "planned_trials"]


def planned_trials(study: Study, stimuli: StimulusSet, assignment: Assignment) -> tuple[Trial, ...]:
    """Return the whole list of a fixed design, practice first.

    Practice presents the first of the set's practice stimuli, the same for everybody; the main
    trials are drawn by the study's seed and the participant's number.

    Raises
    ------
    InputError
        If the design is adaptive: its trials follow from the answers (`course`).
    """
    if study.design.is_adaptive:
        raise InputError(
            f"design.kind: {study.design.kind!r} given; only a fixed design has a list of trials"
        )
    number = assignment.participant_number
    generator = np.random.default_rng([study.design.seed, number])
    practice = arrange(study, chosen(study, stimuli, "practice"))[: study.practice.trials]
    main = _main(study, stimuli, number, generator)
    caught = catch_comparisons(study, stimuli, generator)
    shown: list[tuple[Phase, Shown]] = [("main", together) for together in main]
    for together in caught:
        shown.insert(int(generator.integers(len(shown) + 1)), ("catch", together))
    shown = [*(("practice", together) for together in practice), *shown]
    return tuple(
        Trial(index, phase, together, phase == "practice" and study.practice.feedback)
        for index, (phase, together) in enumerate(shown)
    )


def _main(
    study: Study, stimuli: StimulusSet, number: int, generator: np.random.Generator
) -> list[Shown]:
    main, design = chosen(study, stimuli, "main"), study.design
    if design.one_of_each is not None:
        main = drawn_subset(design, main, generator)
    if design.blocks is None:
        return ordered(arrange(study, main), design.repeats, generator)
    blocks = in_blocks(design.blocks, main)
    order: list[Shown] = []
    for block in block_order(len(blocks), number):
        order += ordered(arrange(study, blocks[block]), design.repeats, generator, order)
    return order
