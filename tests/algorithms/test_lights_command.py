"""The command `trompe lights`."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from algorithms.cli import lights
from algorithms.errors import InputError
from algorithms.images import write_image
from algorithms.light import Light
from tests.algorithms.lit_bodies import ellipsoid, grey, lit

LIGHT = Light(60, 30, 0.8)


@pytest.fixture
def scene(tmp_path: Path) -> tuple[Path, list[Path]]:
    """A picture of two spheres under one light, and a mask of each."""
    mask, normals, _ = ellipsoid(96)
    image = np.tile(grey(np.where(mask, lit(normals, [LIGHT], 0.05), 0.3)), (1, 2, 1))
    write_image(tmp_path / "scene.png", image.astype(np.float32))
    masks = []
    for name, sides in (("left", (mask, ~mask & mask)), ("right", (~mask & mask, mask))):
        masks.append(tmp_path / f"{name}.png")
        Image.fromarray(np.hstack(sides)).convert("L").save(masks[-1])
    return tmp_path / "scene.png", masks


def test_prints_json_and_writes_a_picture(
    scene: tuple[Path, list[Path]], capsys: pytest.CaptureFixture[str]
) -> None:
    image, masks = scene
    lights(image, masks, as_json=True)
    printed = json.loads(capsys.readouterr().out)
    for probe, mask in zip(printed["probes"], masks, strict=True):
        assert probe["mask"] == str(mask)
        (found,) = probe["lights"]
        assert abs(found["azimuth_deg"] - LIGHT.azimuth_deg) < 3
        assert abs(found["elevation_deg"] - LIGHT.elevation_deg) < 6
    (agreement,) = printed["agreement"]
    assert agreement["angle_deg"] < 1
    with Image.open(image.with_name("scene-lights.png")) as picture:
        drawn = np.array(picture)
    # The image stands on the left, and the spheres beside it are bright towards the light.
    assert drawn.shape[1] > drawn.shape[0] * 2
    assert len(np.unique(drawn.reshape(-1, 3), axis=0)) > 100


def test_says_what_it_found(
    scene: tuple[Path, list[Path]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    image, masks = scene
    lights(image, masks, method="voting", out=tmp_path / "other.png")
    said = capsys.readouterr().out
    assert said.count("azimuth") == 2
    assert "degrees apart" in said
    assert (tmp_path / "other.png").is_file()


def test_refusals(scene: tuple[Path, list[Path]], tmp_path: Path) -> None:
    image, masks = scene
    with pytest.raises(InputError, match="method: 'guess' given"):
        lights(image, masks, method="guess")
    with pytest.raises(InputError, match=r"out: .* is an input"):
        lights(image, masks, out=image)
    Image.new("L", (192, 96)).save(tmp_path / "empty.png")
    with pytest.raises(InputError, match=r"empty\.png: mask: it is empty"):
        lights(image, [tmp_path / "empty.png"])
    assert not image.with_name("scene-lights.png").exists()


def test_transparent_pixels_are_no_part_of_an_object(
    scene: tuple[Path, list[Path]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # Property: both spheres under one mask, of which the picture shows one, are that one.
    image, masks = scene
    with Image.open(image) as opaque, Image.open(masks[0]) as mask:
        cut = opaque.convert("RGB")
        cut.putalpha(mask.convert("L"))
    cut.save(tmp_path / "cut.png")
    Image.new("L", cut.size, 255).save(tmp_path / "all.png")
    lights(tmp_path / "cut.png", [tmp_path / "all.png"], as_json=True)
    lights(image, masks[:1], as_json=True)
    found, expected = map(json.loads, capsys.readouterr().out.splitlines())
    assert found["probes"][0]["lights"] == expected["probes"][0]["lights"]
