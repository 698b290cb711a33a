"""Edits of files, and the records that repeat them."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image
from skimage.data import coffee, stereo_motorcycle

from algorithms.color import srgb_digits
from algorithms.edits.before_after import before_after
from algorithms.edits.record import repeat, run
from algorithms.edits.request import Request, changed, perform, settings_from
from algorithms.errors import InputError
from algorithms.fog import PRESETS, Fog
from algorithms.images import read_image, write_channels, write_image

FIELD = {"field_of_view_deg": 50.0, "seed": 1}
CUP_QUAD = [[330.0, 250.0], [560.0, 250.0], [580.0, 380.0], [320.0, 380.0]]


def fog_request(image: Path, fog: Fog, **distance: Any) -> Request:  # noqa: ANN401  # any source
    parameters = {"fog": asdict(fog), "distance": distance, "scaled": False, **FIELD}
    return Request("fog", image, {}, parameters)


@pytest.fixture
def cup(tmp_path: Path) -> Request:
    """A real photograph, and caustics beside the cup in it."""
    Image.fromarray(coffee()).save(tmp_path / "coffee.png")
    y, x = np.mgrid[:400, :600]
    disc = (x - 290) ** 2 / 160**2 + (y - 170) ** 2 / 130**2 < 1
    Image.fromarray(disc).save(tmp_path / "mask.png")
    settings = {"directions": [4], "strengths": [1.5]}
    parameters = {"caustics": settings, "quad": CUP_QUAD, "depth_scale": 1.0}
    inputs = {"mask": tmp_path / "mask.png"}
    return Request("caustics", tmp_path / "coffee.png", inputs, parameters)


def test_a_record_repeats_the_same_bytes(tmp_path: Path, cup: Request) -> None:
    record = run(cup, tmp_path / "edited.png")
    before = (tmp_path / "edited.png").read_bytes()
    (tmp_path / "edited.png").unlink()
    path, same = repeat(record)
    assert same
    assert path.read_bytes() == before
    moved, same = repeat(record, tmp_path / "again.png")
    assert same
    assert moved.read_bytes() == before
    assert (tmp_path / "edited-before-after.png").is_file()


def test_a_record_knows_changed_inputs(tmp_path: Path, cup: Request) -> None:
    record = run(cup, tmp_path / "edited.png", compare=False)
    assert not (tmp_path / "edited-before-after.png").exists()
    Image.fromarray(np.ones((400, 600), bool)).save(tmp_path / "mask.png")
    with pytest.raises(InputError, match=r"mask: mask\.png has changed since"):
        repeat(record)
    for content in (b"{}", b"[1]", b"no"):
        record.write_bytes(content)
        with pytest.raises(InputError, match="not the record of an edit"):
            repeat(record)


def test_caustics_stay_within_their_place(cup: Request) -> None:
    edited = perform(cup)
    changed_px = np.argwhere(np.abs(edited.after - edited.before).max(axis=2) > 0)
    assert len(changed_px) > 1000
    assert (changed_px.min(axis=0) >= [249, 319]).all()
    assert (changed_px.max(axis=0) <= [381, 581]).all()


def test_an_edit_never_overwrites_its_inputs(cup: Request) -> None:
    content = cup.image.read_bytes()
    for out in (cup.image, cup.inputs["mask"]):
        with pytest.raises(InputError, match=r"out: .* is an input; another file is accepted"):
            run(cup, out)
    assert cup.image.read_bytes() == content


def test_high_dynamic_range_and_alpha_pass_through(tmp_path: Path) -> None:
    bright = np.random.default_rng(1).uniform(0, 40, (12, 16, 3)).astype(np.float32)
    write_image(tmp_path / "in.exr", bright)
    source = {"recede": [8.0, 12.0, 8.0, 0.0, 1.0, 9.0]}
    run(fog_request(tmp_path / "in.exr", Fog(extinction=0.0), **source), tmp_path / "same.exr")
    assert_allclose(read_image(tmp_path / "same.exr"), bright)
    run(fog_request(tmp_path / "in.exr", Fog(extinction=0.3), **source), tmp_path / "out.hdr")
    assert read_image(tmp_path / "out.hdr").max() > 1
    alpha = np.linspace(0, 1, 12 * 16, dtype=np.float32).reshape(12, 16)
    write_image(tmp_path / "in.png", bright / np.float32(40), alpha)
    run(fog_request(tmp_path / "in.png", Fog(extinction=0.3), **source), tmp_path / "out.png")
    with Image.open(tmp_path / "out.png") as picture, Image.open(tmp_path / "in.png") as given:
        assert (np.asarray(picture)[..., 3] == np.asarray(given)[..., 3]).all()
        assert (np.asarray(picture)[..., :3] != np.asarray(given)[..., :3]).any()


def test_distance_comes_from_a_file_or_from_layers(tmp_path: Path) -> None:
    # Theory: without relighting and glow, fog is L exp(-k z) + A (1 - exp(-k z)).
    left, _, disparity = stereo_motorcycle()
    Image.fromarray(left[:60, :80]).save(tmp_path / "left.png")
    np.savez(tmp_path / "disparity.npz", disparity[:60, :80])
    unlit = Fog(0.4, desaturation=0.0, shadow_lift=0.0, highlight_attenuation=0.0, glow=0.0)
    fog = replace(unlit, airlight=(0.5, 0.5, 0.5))
    stereo = {"focal_px": 994.978, "baseline": 0.193001, "offset_px": 31.086}
    request = fog_request(tmp_path / "left.png", fog, stereo=stereo)
    found = perform(
        Request("fog", request.image, {"depth": tmp_path / "disparity.npz"}, request.parameters)
    )
    row, column = np.argwhere(np.isfinite(disparity[:60, :80]))[77]
    distance = 0.193001 * 994.978 / (disparity[row, column] + 31.086)
    clear = np.exp(-0.4 * distance)
    airlight = found.after[row, column] - clear * found.before[row, column]
    assert airlight / (1 - clear) == pytest.approx(airlight.mean() / (1 - clear), rel=1e-3)
    half = np.zeros((60, 80), bool)
    half[:, 40:] = True
    Image.fromarray(half).save(tmp_path / "half.png")
    request = fog_request(tmp_path / "left.png", fog, layers=[0.0], background=1.0)
    layered = perform(
        Request("fog", request.image, {"layer-1": tmp_path / "half.png"}, request.parameters)
    )
    assert_allclose(layered.after[half], layered.before[half])
    assert (layered.after[~half] != layered.before[~half]).any()


def test_refuses_inputs(tmp_path: Path, cup: Request) -> None:
    Image.fromarray(np.ones((4, 4), bool)).save(tmp_path / "small.png")
    write_channels(tmp_path / "small.exr", np.ones((4, 4), np.float32))
    write_channels(tmp_path / "holes.exr", np.full((400, 600), np.nan, np.float32))
    small, mask = {"mask": tmp_path / "small.png"}, cup.inputs["mask"]
    for inputs, message in (
        (small, r"small\.png: 4 x 4 pixels given, the image's 600 x 400 accepted"),
        ({"mask": mask, "depth": tmp_path / "small.exr"}, r"small\.exr: 4 x 4 pixels given"),
        ({"mask": mask, "depth": tmp_path / "holes.exr"}, "known all over the object"),
    ):
        with pytest.raises(InputError, match=message):
            perform(Request("caustics", cup.image, inputs, cup.parameters))
    with pytest.raises(InputError, match="at most 1000 pixels are accepted"):
        perform(cup, max_pixels=1000)
    with pytest.raises(InputError, match="edit: 'blur' given, fog, caustics, transparent accepted"):
        Request("blur", cup.image)
    with pytest.raises(InputError, match="a depth file, layers or a receding plane are needed"):
        perform(fog_request(cup.image, Fog(extinction=1.0)))
    write_image(tmp_path / "dark.exr", np.full((4, 4, 3), -1, np.float32))
    with pytest.raises(InputError, match=r"dark\.exr: finite pixels of 0 or more"):
        perform(fog_request(tmp_path / "dark.exr", Fog(extinction=1.0)))


def test_settings_change_by_name() -> None:
    fog = changed(
        PRESETS["house-left"], ["extinction=2", "airlight=0.1,0.2,0.3", "scattering=none"]
    )
    assert (fog.extinction, fog.airlight, fog.scattering) == (2.0, (0.1, 0.2, 0.3), None)
    assert fog.noise_octaves == PRESETS["house-left"].noise_octaves
    through_json = settings_from(Fog, json.loads(json.dumps(asdict(fog))))
    assert through_json == fog
    for assignment, message in (
        ("extincton=2", "extincton: no such setting; extinction, scattering"),
        ("extinction", "set: 'extinction' given, NAME=VALUE accepted"),
        ("extinction=-1", "^extinction: a finite number of 0 or more is accepted"),
        ("extinction=a", "^extinction: Input should be a valid number"),
    ):
        with pytest.raises(InputError, match=message):
            changed(fog, [assignment])


def test_before_and_after_stand_side_by_side() -> None:
    dark = np.full((30, 40, 3), 0.2, np.float32)
    sheet = np.asarray(before_after(dark, dark * 2))
    assert sheet.shape == (30, 88, 3)
    assert (sheet[:, :40] == srgb_digits(dark)).all()
    assert (sheet[:, 48:] == srgb_digits(dark * 2)).all()
    bright = np.asarray(before_after(dark * 50, dark * 50))
    assert (bright[:, :40] == 255).all()  # shown as bright as a display can, not beyond
