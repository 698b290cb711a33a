import io
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from algorithms.errors import InputError
from algorithms.images import read_labels
from experiments.web.exhibits import Exhibits, label_runs, png_size_px, region_runs, shown_png
from stimuli.manifest import StimulusSet


def test_ids_differ_by_stimulus_session_and_secret(drawn_set: StimulusSet) -> None:
    exhibits = [Exhibits(drawn_set, secret) for secret in ("one", "two")]
    ids = {
        each.image_id(session, stimulus)
        for each in exhibits
        for session in ("a.P0001.1", "a.P0002.1")
        for stimulus in drawn_set.stimuli
    }
    assert len(ids) == 4 * len(drawn_set.stimuli)


def test_ids_are_the_same_after_a_restart(drawn_set: StimulusSet) -> None:
    stimulus = drawn_set.stimuli[0]
    first, second = (Exhibits(drawn_set, "secret") for _ in range(2))
    assert first.image_id("s", stimulus) == second.image_id("s", stimulus)
    assert second.find_image("s", first.image_id("s", stimulus)) is not None
    assert second.find_image("other", first.image_id("s", stimulus)) is None


def test_equal_region_maps_share_one_id(drawn_set: StimulusSet) -> None:
    exhibits = Exhibits(drawn_set, "secret")
    assert len({exhibits.regions_id("s", stimulus) for stimulus in drawn_set.stimuli}) == 1


@given(
    arrays(np.uint8, array_shapes(min_dims=2, max_dims=2, max_side=12), elements=st.integers(0, 3))
)
def test_run_lengths_give_the_labels_back(labels: np.ndarray) -> None:
    runs = label_runs(labels)
    flat = np.repeat([label for label, _ in runs], [length for _, length in runs])
    np.testing.assert_array_equal(flat.reshape(labels.shape), labels)
    assert all(left != right for (left, _), (right, _) in pairwise(runs))


def test_region_runs_are_those_of_the_label_file(drawn_set: StimulusSet) -> None:
    path = drawn_set.path("regions.png")
    told, labels = region_runs(path), read_labels(path)
    assert (told["height_px"], told["width_px"]) == labels.shape
    assert told["runs"] == label_runs(labels)


def test_a_png_without_its_description_has_the_same_pixels(tmp_path: Path) -> None:
    pixels = np.arange(60, dtype=np.uint8).reshape(4, 5, 3)
    notes = PngInfo()
    notes.add_text("answer", "e")
    Image.fromarray(pixels).save(tmp_path / "a.png", pnginfo=notes, dpi=(72, 72))
    content = (tmp_path / "a.png").read_bytes()
    shown = shown_png(content)
    assert b"answer" in content
    assert b"answer" not in shown
    with Image.open(io.BytesIO(shown)) as image:
        np.testing.assert_array_equal(np.array(image), pixels)
    assert png_size_px(tmp_path / "a.png") == (5, 4)


def test_only_png_images_are_served(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(b"\xff\xd8\xff")
    with pytest.raises(InputError, match="PNG images only"):
        png_size_px(tmp_path / "a.jpg")
    with pytest.raises(InputError, match="cannot be read"):
        png_size_px(tmp_path / "none.png")
