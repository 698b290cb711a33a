"""Designs: which images are compared with each other, in which order, by whom."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from algorithms.errors import InputError
from experiments.study import Study, chosen
from experiments.study_parts import Design
from stimuli.manifest import Factor, Stimulus, StimulusSet

Shown = tuple[str, ...]
"""The ids of the images that are shown at once, in their places."""


def arrange(study: Study, stimuli: Sequence[Stimulus]) -> list[Shown]:
    """Return all presentations of a study's design, in the order of the set."""
    by_task = {"two-alternative": _pairs, "ranking": _sets}
    return by_task.get(study.task, _single)(study, stimuli)


def catch_comparisons(
    study: Study, stimuli: StimulusSet, generator: np.random.Generator
) -> list[Shown]:
    """Return a participant's catch trials, drawn from all comparisons that can be one.

    Raises
    ------
    InputError
        If there are fewer than the study says.
    """
    catch, item = study.catch, study.stimuli.item
    if catch is None or item is None:
        return []
    groups = comparisons(study, chosen(study, stimuli, "main"))
    for stimulus in (*stimuli.with_role("main"), *stimuli.with_role("example")):
        name = str(stimulus.factors[item])
        group = groups.get(_within(study, stimulus))
        if group is not None and name in (catch.better, catch.worse):
            group.setdefault(name, stimulus)
    possible: list[Shown] = []
    for group in groups.values():
        if catch.better in group and catch.worse in group:
            wanted = (
                (catch.better, catch.worse) if study.task == "two-alternative" else tuple(group)
            )
            possible.append(tuple(group[name].id for name in wanted))
    if len(possible) < catch.trials:
        raise InputError(
            f"catch.trials: the study says {catch.trials}, {len(possible)} comparisons of the set"
            f" have both {catch.better!r} and {catch.worse!r}"
        )
    drawn = generator.choice(len(possible), size=catch.trials, replace=False)
    return ordered([possible[number] for number in drawn], 1, generator)


def drawn_subset(
    design: Design, stimuli: Sequence[Stimulus], generator: np.random.Generator
) -> tuple[Stimulus, ...]:
    """Draw one stimulus for each level of `one_of_each`, no level of `distinct` twice.

    Where every level of one is there with every level of the other, all such draws are equally
    likely.

    Raises
    ------
    InputError
        If there is no such draw.
    """
    each, distinct = design.one_of_each, design.distinct
    assert each is not None
    assert distinct is not None
    levels = list(dict.fromkeys(stimulus.factors[each] for stimulus in stimuli))
    shuffled = [stimuli[number] for number in generator.permutation(len(stimuli))]

    def draws(taken: tuple[Stimulus, ...]) -> Iterator[tuple[Stimulus, ...]]:
        if len(taken) == len(levels):
            yield taken
            return
        used = {stimulus.factors[distinct] for stimulus in taken}
        for stimulus in shuffled:
            fits = stimulus.factors[each] == levels[len(taken)]
            if fits and stimulus.factors[distinct] not in used:
                yield from draws((*taken, stimulus))

    drawn = next(draws(()), None)
    if drawn is None:
        raise InputError(
            f"design.distinct: there are not enough levels of {distinct} for one stimulus of each"
            f" {each}"
        )
    return drawn


def in_blocks(factor: str, stimuli: Sequence[Stimulus]) -> list[list[Stimulus]]:
    """Group stimuli by the levels of a factor, in the order of the set."""
    blocks: dict[Factor, list[Stimulus]] = {}
    for stimulus in stimuli:
        blocks.setdefault(stimulus.factors[factor], []).append(stimulus)
    return list(blocks.values())


def block_order(blocks: int, participant_number: int) -> tuple[int, ...]:
    """Return in which order a participant sees the blocks: a row of a balanced Latin square.

    Over as many participants as there are rows every block stands equally often in every place,
    and equally often right after every other. There are as many rows as blocks, and twice as many
    where their number is odd.

    References
    ----------
    Williams 1949, Australian Journal of Scientific Research A 2.

    >>> [block_order(4, number) for number in (1, 2, 3, 4)]
    [(0, 3, 1, 2), (1, 0, 2, 3), (2, 1, 3, 0), (3, 2, 0, 1)]
    """
    row = (participant_number - 1) % block_rows(blocks)
    steps = [-(place // 2) - 1 if place % 2 else place // 2 for place in range(blocks)]
    order = tuple((row + step) % blocks for step in steps)
    return order[::-1] if row >= blocks else order


def block_rows(blocks: int) -> int:
    """Return how many orders of blocks there are."""
    return blocks if blocks % 2 == 0 or blocks == 1 else 2 * blocks


def order_rows(study: Study, stimuli: StimulusSet) -> int:
    """Return how many orders of blocks a study has; a participant's number chooses among them."""
    if study.design.blocks is None:
        return 1
    return block_rows(len(in_blocks(study.design.blocks, chosen(study, stimuli, "main"))))


def next_number(taken: Mapping[int, bool], rows: int) -> int:
    """Return the number of the next participant.

    Parameters
    ----------
    taken
        The numbers given so far, and whether their participant has finished.
    rows
        How many orders the design has (`order_rows`).

    Returns
    -------
    Of the numbers that follow the largest one, that with the order that fewest participants have
    finished, and fewest have begun; the first of them.
    """
    first = max(taken, default=0) + 1
    finished = Counter(number % rows for number, done in taken.items() if done)
    begun = Counter(number % rows for number in taken)
    return min(range(first, first + rows), key=lambda n: (finished[n % rows], begun[n % rows]))


def comparisons(
    study: Study, stimuli: Sequence[Stimulus]
) -> dict[tuple[Factor, ...], dict[str, Stimulus]]:
    """Group stimuli by the factors that are equal within a comparison.

    Returns
    -------
    By the levels of `stimuli.within`, the stimuli by the level of `stimuli.item`, as text.

    Raises
    ------
    InputError
        If two stimuli of a group are of the same item.
    """
    item, groups = study.stimuli.item, dict[tuple[Factor, ...], dict[str, Stimulus]]()
    assert item is not None
    for stimulus in stimuli:
        group = groups.setdefault(_within(study, stimulus), {})
        name = str(stimulus.factors[item])
        if name in group:
            raise InputError(
                f"stimuli.within: {stimulus.id!r} and {group[name].id!r} are both {item} {name}"
                " of one comparison; name the factor in which they differ"
            )
        group[name] = stimulus
    return groups


def _within(study: Study, stimulus: Stimulus) -> tuple[Factor, ...]:
    return tuple(stimulus.factors[name] for name in study.stimuli.within)


def _single(_: Study, stimuli: Sequence[Stimulus]) -> list[Shown]:
    return [(stimulus.id,) for stimulus in stimuli]


def _pairs(study: Study, stimuli: Sequence[Stimulus]) -> list[Shown]:
    return [
        (first.id, second.id)
        for group in comparisons(study, stimuli).values()
        for first, second in combinations(group.values(), 2)
    ]


def _sets(study: Study, stimuli: Sequence[Stimulus]) -> list[Shown]:
    return [
        tuple(stimulus.id for stimulus in group.values())
        for group in comparisons(study, stimuli).values()
        if len(group) > 1
    ]


def ordered(
    shown: Sequence[Shown],
    repeats: int,
    generator: np.random.Generator,
    before: Sequence[Shown] = (),
) -> list[Shown]:
    """Return presentations in random order and with random places, balanced over them.

    Parameters
    ----------
    shown
        The images of each presentation.
    repeats
        Rounds; each is shuffled on its own.
    generator
        Where chance comes from.
    before
        What was shown before these.

    Returns
    -------
    In each round half of the pairs (or one more) are turned around, in the next round the other
    half; sets of more images are shuffled. No image follows itself where another presentation is
    left; what is left at the end of a round may leave no choice.
    """
    order = list(before[-1:])
    turned = np.arange(len(shown)) % 2 == 1
    if any(len(together) == 2 for together in shown):
        turned = generator.permutation(turned)
    for _ in range(repeats):
        left = [
            _placed(together, bool(turn), generator)
            for together, turn in zip(shown, turned, strict=True)
        ]
        left = [left[i] for i in generator.permutation(len(left))]
        while left:
            fresh = (n for n, each in enumerate(left) if not order or not {*each} & {*order[-1]})
            order.append(left.pop(next(fresh, 0)))
        turned = ~turned
    return order[len(before[-1:]) :]


def _placed(together: Shown, turned: bool, generator: np.random.Generator) -> Shown:
    if len(together) <= 2:
        return together[::-1] if turned else together
    return tuple(together[i] for i in generator.permutation(len(together)))
