"""The order into which a participant brings images, and the ranks that it stands for.

The web's front end follows the same rules (`ordering.ts`).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self


@dataclass(frozen=True)
class Order:
    """Images in places, the best in the first.

    Attributes
    ----------
    images
        The image in each place, as its number in the order shown, from 0.
    tied
        The places, from 1, whose image is as good as the one in the place before.

    Examples
    --------
    >>> order = Order.as_shown(4).moved(3, 0)
    >>> order.images, order.ranks()
    ((3, 0, 1, 2), (2, 3, 4, 1))
    >>> order.with_tie_changed(1).ranks()
    (1, 3, 4, 1)
    """

    images: tuple[int, ...]
    tied: frozenset[int] = frozenset()

    @classmethod
    def as_shown(cls, count: int) -> Self:
        """Return the order in which that many images are shown at first."""
        return cls(tuple(range(count)))

    def moved(self, source: int, target: int) -> Self:
        """Return the order with the image of one place put into another; those between shift."""
        images = list(self.images)
        images.insert(target, images.pop(source))
        return replace(self, images=tuple(images))

    def with_tie_changed(self, place: int) -> Self:
        """Return the order with a place tied to the one before it, or not any more."""
        return replace(self, tied=self.tied ^ ({place} & set(range(1, len(self.images)))))

    def rank_of_place(self, place: int) -> int:
        """Return the rank of the image in a place: 1 and the number of better images."""
        while place in self.tied:
            place -= 1
        return place + 1

    def ranks(self) -> tuple[int, ...]:
        """Return the rank of each image in the order shown, 1 for the best."""
        places = {image: place for place, image in enumerate(self.images)}
        return tuple(self.rank_of_place(places[image]) for image in range(len(self.images)))


def is_ranking(ranks: Sequence[int], *, ties: bool) -> bool:
    """Return whether each rank is 1 and the number of better ones, and shared only with `ties`.

    >>> is_ranking((1, 3, 1), ties=True), is_ranking((1, 3, 1), ties=False)
    (True, False)
    """
    consistent = all(rank == 1 + sum(other < rank for other in ranks) for rank in ranks)
    return consistent and (ties or len(set(ranks)) == len(ranks))
