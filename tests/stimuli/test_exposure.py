"""One exposure for a whole set."""

from pathlib import Path

import numpy as np
import pytest

from algorithms.errors import InputError
from algorithms.images import read_image
from stimuli.exposure import clipped_share, exposure_for, write_shown


def test_exposure_clips_the_share_that_is_asked_for(tmp_path: Path) -> None:
    # Definition, over all images together and by the brightest channel.
    generator = np.random.default_rng(4)
    images = [generator.exponential(scale, (200, 250, 3)) for scale in (0.1, 7.0)]
    exposure = exposure_for(images, share=0.01)
    over = [(image * exposure >= 1).any(axis=-1).mean() for image in images]
    assert np.mean(over) == pytest.approx(0.01, rel=0.05)
    files = [tmp_path / f"{index}.png" for index in range(2)]
    for file, image in zip(files, images, strict=True):
        write_shown(file, image.astype(np.float32), exposure)
    # Rounding to 8 bits brings what is just below the top up to it.
    assert np.mean(over) <= clipped_share(files) <= 1.1 * np.mean(over)


def test_background_shows_where_nothing_covers_it(tmp_path: Path) -> None:
    radiance = np.zeros((2, 2, 3), np.float32)
    radiance[0] = 0.5
    coverage = np.array([[1, 1], [0, 0.5]], np.float32)
    write_shown(tmp_path / "x.png", radiance, 1.0, coverage, background=0.2)
    shown = read_image(tmp_path / "x.png")[..., 0]
    assert shown == pytest.approx(np.array([[0.5, 0.5], [0.2, 0.1]]), abs=0.005)


@pytest.mark.parametrize("images", [[], [np.zeros((3, 3, 3))]])
def test_refuses_the_dark(images: list[np.ndarray]) -> None:
    with pytest.raises(InputError, match="is there no light"):
        exposure_for(images)
