"""Observers who look at brightness alone: a task that they can solve measures nothing else."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.color import FloatImage, luminance
from algorithms.images import read_image, read_labels
from stimuli.manifest import StimulusSet

Means = NDArray[np.float64]


@dataclass(frozen=True)
class HitRate:
    """How often an observer named the object with the other light, at one level.

    Attributes
    ----------
    level
        Of the factor that the hit rates are split by.
    hits, images
        Right answers, and how many there could have been.
    """

    level: float
    hits: int
    images: int


def mean_luminances(image: FloatImage, regions: NDArray[np.uint8]) -> Means:
    """Return the mean luminance inside each region, by label from 1.

    Parameters
    ----------
    image
        Linear light `(height, width, 3)`.
    regions
        Label image `(height, width)`; every label from 1 to the largest occurs.
    """
    sums = np.bincount(regions.ravel(), weights=luminance(image).ravel())
    return np.asarray(sums[1:] / np.bincount(regions.ravel())[1:])


def most_different(means: Means) -> int:
    """Return the label whose mean differs most from the mean of all the others."""
    others = (means.sum() - means) / (len(means) - 1)
    return int(np.argmax(np.abs(means - others))) + 1


def outlier_hit_rates(stimuli: StimulusSet, level: str) -> tuple[HitRate, ...]:
    """Let the observer pick, in each image, the object whose mean luminance differs most.

    Parameters
    ----------
    stimuli
        A set with regions; its main images that have an answer are shown.
    level
        The factor by which the hit rates are split.
    """
    return _hit_rates(stimuli, level, lambda means: [most_different(row) for row in means])


def experienced_hit_rates(stimuli: StimulusSet, level: str) -> tuple[HitRate, ...]:
    """Let an observer pick who has seen the whole set and knows each object's usual brightness.

    The object's luminance is compared with its own mean over all images, as a ratio, and that ratio
    with the others' in the same image. No participant can do this at first sight.
    """

    def pick(means: Means) -> list[int]:
        ratios = np.log(means / np.exp(np.log(means).mean(axis=0)))
        return [most_different(row) for row in ratios]

    return _hit_rates(stimuli, level, pick)


def observer_details(stimuli: StimulusSet, level: str, *, recurring: bool) -> dict[str, Any]:
    """Return the observers' hit rates as a manifest tells them.

    Parameters
    ----------
    stimuli, level
        As of the observers.
    recurring
        Whether objects recur from image to image; else no observer has experience with them.
    """
    observers = {"outlier": outlier_hit_rates}
    if recurring:
        observers["experienced"] = experienced_hit_rates
    return {
        "luminance_observers": {
            name: [asdict(rate) | {"hit_rate": rate.hits / rate.images} for rate in rates]
            for name, rates in ((name, rate(stimuli, level)) for name, rate in observers.items())
        }
    }


def _hit_rates(
    stimuli: StimulusSet, level: str, pick: Callable[[Means], Sequence[int]]
) -> tuple[HitRate, ...]:
    shown = [
        stimulus
        for stimulus in stimuli.with_role("main")
        if stimulus.answer is not None and stimulus.regions is not None
    ]
    regions = {s.regions: read_labels(stimuli.path(s.regions)) for s in shown if s.regions}
    means = np.array(
        [
            mean_luminances(read_image(stimuli.path(s.file)), regions[s.regions])
            for s in shown
            if s.regions
        ]
    )
    right = np.array([s.answer for s in shown]) == pick(means)
    levels = np.array([float(s.factors[level]) for s in shown])
    return tuple(
        HitRate(float(value), int(right[levels == value].sum()), int((levels == value).sum()))
        for value in np.unique(levels)
    )
