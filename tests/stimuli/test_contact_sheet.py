from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from algorithms.errors import InputError
from algorithms.files import sha256_of
from stimuli.contact_sheet import caption, draw_contact_sheet, write_contact_sheet
from stimuli.manifest import Stimulus, StimulusSet

COLORS = ((255, 0, 0), (0, 255, 0), (0, 0, 255))


@pytest.fixture
def flat_set(tmp_path: Path) -> StimulusSet:
    """Three images of one colour each, 40 x 20."""
    stimuli = []
    for number, color in enumerate(COLORS):
        Image.new("RGB", (40, 20), color).save(tmp_path / f"{number}.png")
        stimuli.append(
            Stimulus(
                id=str(number),
                file=f"{number}.png",
                factors={"divergence_deg": 10 * number, "placement": "front"},
                answer=number or None,
            )
        )
    return StimulusSet(
        name="flat",
        generator="test",
        parameters={},
        seed=0,
        engine="none",
        versions={},
        exposure=1,
        files={path.name: sha256_of(path) for path in tmp_path.iterdir()},
        stimuli=tuple(stimuli),
    ).in_folder(tmp_path)


def test_images_stand_in_order_with_their_captions(flat_set: StimulusSet) -> None:
    # By hand: thumbnails of 80 x 40, a caption of 34 and margins of 12 pixels.
    sheet = np.array(draw_contact_sheet(flat_set, columns=2, thumbnail_px=80))
    assert sheet.shape == (12 + 2 * (40 + 34 + 12), 12 + 2 * (80 + 12), 3)
    for color, (top, left) in zip(COLORS, [(12, 12), (12, 104), (98, 12)], strict=True):
        assert (sheet[top : top + 40, left : left + 80] == color).all()
        line = sheet[top + 42 : top + 58, left : left + 80]
        assert (line.min(axis=-1) < 100).sum() > 20  # ink
    assert (sheet[98:, 104:] == sheet[0, 0]).all()  # the fourth place is empty


def test_caption_holds_factors_and_answer(flat_set: StimulusSet) -> None:
    assert [caption(stimulus) for stimulus in flat_set.stimuli[:2]] == [
        "0, front\nmain, no answer",
        "10, front\nmain, answer 1",
    ]


def test_sheet_is_written(flat_set: StimulusSet, tmp_path: Path) -> None:
    write_contact_sheet(tmp_path / "sheet.png", flat_set, columns=3, thumbnail_px=40)
    drawn = draw_contact_sheet(flat_set, columns=3, thumbnail_px=40)
    with Image.open(tmp_path / "sheet.png") as written:
        assert (np.asarray(written) == np.asarray(drawn)).all()


def test_refuses(flat_set: StimulusSet) -> None:
    with pytest.raises(InputError, match="columns: 0 given, 1 or more accepted"):
        draw_contact_sheet(flat_set, columns=0, thumbnail_px=80)
    with pytest.raises(InputError, match="thumbnail_px: 8 given, 16 or more accepted"):
        draw_contact_sheet(flat_set, columns=2, thumbnail_px=8)
    flat_set.path("1.png").unlink()
    with pytest.raises(InputError, match=r"1\.png: cannot be read"):
        draw_contact_sheet(flat_set, columns=2, thumbnail_px=80)
