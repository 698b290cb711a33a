from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from algorithms.files import sha256_of
from algorithms.images import write_image, write_labels
from stimuli.light_linking.luminance_observer import (
    HitRate,
    experienced_hit_rates,
    mean_luminances,
    most_different,
    outlier_hit_rates,
)
from stimuli.manifest import Stimulus, StimulusSet

# Grey levels of four objects in five images; the answers are right where the comments say.
IMAGES = (
    ((0.2, 0.3, 0.2, 0.8), 10, 4),  # the fourth is brightest by far
    ((0.2, 0.3, 0.4, 0.8), 10, 3),  # the fourth is named as always, but the third has changed
    ((0.2, 0.3, 0.2, 0.4), 20, 4),  # the fourth is darker than usual, the second about as bright
    ((0.2, 0.3, 0.2, 0.8), 0, None),  # a control has no answer
    ((0.2, 0.3, 0.2, 0.8), 20, 1),  # nothing to be seen
)


@pytest.fixture
def grey_set(tmp_path: Path) -> StimulusSet:
    """A set of flat grey objects."""
    regions = np.repeat(np.arange(5, dtype=np.uint8), 2)[None, :].repeat(3, axis=0)
    write_labels(tmp_path / "regions.png", regions)
    stimuli = []
    for number, (greys, level, answer) in enumerate(IMAGES):
        values = np.array([0.5, *greys], np.float32)[regions]
        write_image(tmp_path / f"{number}.png", values[..., None].repeat(3, axis=2))
        stimuli.append(
            Stimulus(
                id=str(number),
                file=f"{number}.png",
                factors={"level": level},
                answer=answer,
                regions="regions.png",
            )
        )
    return StimulusSet(
        name="grey",
        generator="test",
        parameters={},
        seed=0,
        engine="none",
        versions={},
        exposure=1,
        files={path.name: sha256_of(path) for path in tmp_path.iterdir()},
        stimuli=tuple(stimuli),
    ).in_folder(tmp_path)


def test_means_by_hand() -> None:
    # By hand: Rec. 709 weights 0.2126, 0.7152 and 0.0722; the background does not count.
    image = np.array([[[1, 0, 0], [0, 1, 0], [0, 0, 1], [9, 9, 9]]], np.float32)
    means = mean_luminances(image, np.array([[1, 1, 2, 0]], np.uint8))
    assert_allclose(means, [(0.2126 + 0.7152) / 2, 0.0722])


def test_most_different_by_hand() -> None:
    # By hand: distances from the mean of the others are 0.333, 0.333, 0.467 and 0.467, and so on.
    assert most_different(np.array([0.5, 0.4, 0.5, 0.9])) == 4
    assert most_different(np.array([0.5, 0.1, 0.5, 0.6])) == 2


def test_outlier_by_hand(grey_set: StimulusSet) -> None:
    # By hand: the fourth object is named in every image.
    assert outlier_hit_rates(grey_set, "level") == (HitRate(10.0, 1, 2), HitRate(20.0, 1, 2))


def test_experienced_by_hand(grey_set: StimulusSet) -> None:
    # By hand, from the geometric means over the four images that have an answer: ratios deviate
    # most for the third object where it is twice as bright, and for the fourth where it is half.
    assert experienced_hit_rates(grey_set, "level") == (HitRate(10.0, 1, 2), HitRate(20.0, 1, 2))
