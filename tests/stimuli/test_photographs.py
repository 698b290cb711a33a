"""The description of a folder of photographs, and the checks of what is in it."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image
from scipy.ndimage import shift

from algorithms.color import FloatImage
from algorithms.errors import InputError
from stimuli.photographs.checks import check_alike, check_clipping, exposure_stops, shift_px
from stimuli.photographs.folder import read_folder
from tests.stimuli.bodies import pixel_centres
from tests.stimuli.photographed import NAMES, TOML, VIEW, take, write_folder

Taken = tuple[dict[int, FloatImage], np.ndarray]


@pytest.fixture(scope="module")
def taken() -> Taken:
    return take()


@pytest.fixture
def folder(tmp_path: Path, taken: Taken) -> Path:
    return write_folder(tmp_path / "photos", *taken)


def masks_of(labels: np.ndarray) -> list[np.ndarray]:
    """Return each object's mask."""
    return [labels == number for number in range(1, labels.max() + 1)]


def test_reads_a_description(folder: Path, taken: Taken) -> None:
    given = read_folder(folder)
    described = given.description
    assert given.others == ["light-20.png", "light-40.png"]
    assert described.divergence_deg("light-0.png", "light-40.png") == 40
    assert described.divergence_deg("light-20.png", "light-40.png") == 60
    assert described.light("light-0.png") is None
    masks = given.masks(taken[1].shape)
    assert tuple(masks) == NAMES
    assert (masks["venus"] == (taken[1] == 2)).all()
    assert {path.name for path in given.files} == {
        "light-0.png", "light-20.png", "light-40.png", "objects.png"
    }  # fmt: skip


def test_angles_go_round(folder: Path) -> None:
    text = TOML.replace('"light-0.png" = 0', '"light-0.png" = 350')
    (folder / "photographs.toml").write_text(text, encoding="utf-8")
    described = read_folder(folder).description
    assert described.divergence_deg("light-0.png", "light-20.png") == 30


def test_reads_directions_and_single_masks(folder: Path, taken: Taken) -> None:
    text = """
    reference = "light-0.png"
    [photographs]
    "light-0.png" = { azimuth_deg = 0, elevation_deg = 0 }
    "light-40.png" = { azimuth_deg = 0, elevation_deg = 40 }
    [objects]
    venus = "venus.png"
    """
    (folder / "photographs.toml").write_text(text, encoding="utf-8")
    Image.fromarray(np.where(taken[1] == 2, 255, 0).astype(np.uint8)).save(folder / "venus.png")
    given = read_folder(folder)
    assert_allclose(given.description.divergence_deg("light-0.png", "light-40.png"), 40)
    light = given.description.light("light-40.png")
    assert light is not None
    assert light.elevation_deg == 40
    assert (given.masks(taken[1].shape)["venus"] == (taken[1] == 2)).all()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[objects]", "[things]", "objects: missing"),
        ("pairs", "couples", "couples: unknown key"),
        ("reference = ", "reference = 3 #", "reference: "),
        ('reference = "light-0.png"', 'reference = "dark.png"', "'dark.png' is not one of the"),
        ('"light-20.png" = 20\n"light-40.png" = -40', "", "photographs: "),
        ('"light-20.png" = 20', '"light-20.png" = 360.2', "have the same light"),
        ('"light-20.png" = 20', '"light-20.png" = "left"', "photographs.light-20.png"),
        ('"light-20.png" = 20', '"light-20.png" = nan', "photographs.light-20.png"),
        ('"light-20.png" = 20', '"../light-20.png" = 20', "without '..'"),
        ('"light-20.png" = 20', '"light-20.png" = {azimuth_deg=0, elevation_deg=0}', "for all or"),
        ('labels = "objects.png"', "", "labels: a label image is needed"),
        ("doll = 1", "doll = 2", "objects: 2 stands for two of them"),
        ("doll = 1", "doll = 0", "objects.doll"),
        ("doll = 1", "DOLL = 1", "objects.DOLL"),
        ('"robot"]]', '"rabbit"]]', "pairs: two objects by name"),
        ('"robot"]]', '"doll"]]', "pairs: two objects by name"),
        ("reference", "max_shift_px = 0\nreference", "max_shift_px"),
        ("reference", "width_px = 9\nreference", "width_px"),
        ("[objects]", "[objects", "not a TOML file"),
    ],
)
def test_refuses_a_wrong_description(folder: Path, old: str, new: str, message: str) -> None:
    assert old in TOML
    (folder / "photographs.toml").write_text(TOML.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_folder(folder)
    assert message in str(caught.value)
    assert str(caught.value).startswith(f"{folder / 'photographs.toml'}: ")
    assert "\n" not in str(caught.value)


def test_refuses_a_folder_without_description(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"photographs\.toml: cannot be read \(No such file"):
        read_folder(tmp_path)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda labels: labels[1:], r"objects\.png: object 'doll': 260 x 110 pixels are accepted"),
        (lambda labels: np.where(labels == 2, 0, labels), "object 'venus': its mask is empty"),
        (lambda labels: np.roll(labels, 60, axis=1), "its mask touches the border"),
    ],
)
def test_refuses_wrong_masks(
    folder: Path, taken: Taken, change: Callable[[np.ndarray], np.ndarray], message: str
) -> None:
    Image.fromarray(change(taken[1]).astype(np.uint8)).save(folder / "objects.png")
    with pytest.raises(InputError, match=message):
        read_folder(folder).masks(taken[1].shape)


def test_refuses_masks_that_overlap(folder: Path, taken: Taken) -> None:
    Image.fromarray(taken[1]).save(folder / "robot.png")
    text = TOML.replace("robot = 3", 'robot = "robot.png"')
    (folder / "photographs.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="object 'robot': its mask overlaps that of 'doll'"):
        read_folder(folder).masks(taken[1].shape)


@pytest.mark.parametrize("turn", [0, 20, 40])
@pytest.mark.parametrize("moved", [(0.0, 0.0), (1.0, 0.0), (0.0, -2.0), (3.0, 4.0)])
def test_finds_a_shift_under_another_light(
    taken: Taken, turn: int, moved: tuple[float, float]
) -> None:
    # Recovery: of a known displacement, whatever the light.
    away = shift(taken[0][turn], (*moved, 0), order=1, mode="nearest")
    assert_allclose(shift_px(taken[0][0], away), np.hypot(*moved), atol=0.3)


@pytest.mark.parametrize("turn", [20, 40])
@pytest.mark.parametrize("stops", [-0.5, -1 / 3, 1 / 3])
def test_finds_a_third_of_a_stop_under_another_light(taken: Taken, turn: int, stops: float) -> None:
    images, masks = taken[0], masks_of(taken[1])
    assert exposure_stops(images[turn], images[0], masks) < 0.2
    other = images[turn] * np.float32(2**stops)
    assert exposure_stops(other, images[0], masks) > 0.25
    tinted = images[turn] * np.array([1, 1, 2**stops], dtype=np.float32)
    assert exposure_stops(tinted, images[0], masks) > 0.2


def test_surfaces_that_face_the_light_tell_the_exposure() -> None:
    # Theory: the 98th percentile of a Lambertian sphere's cosines, and their mean.
    x, y = pixel_centres(VIEW)
    inside = x**2 + y**2 < 1
    z = np.sqrt(np.maximum(0, 1 - x**2 - y**2))
    front, side = (
        np.repeat(np.maximum(0, np.sin(angle) * x + np.cos(angle) * z)[..., None], 3, axis=2)
        for angle in (0, np.pi / 2)
    )
    assert exposure_stops(front.astype(np.float32), side.astype(np.float32), [inside]) < 0.2
    assert np.log2(front[inside].mean() / side[inside].mean()) > 1.5


def test_checks_say_what_is_wrong(taken: Taken) -> None:
    images, masks = taken[0], masks_of(taken[1])
    limits = {"max_shift_px": 0.75, "max_exposure_stops": 0.25}
    measured = check_alike("b.png", images[20], images[0], masks, **limits)
    assert measured["shift_px"] < 0.3
    with pytest.raises(InputError, match=r"^b\.png: its exposure .* by 0\.[3-6]\d stops"):
        check_alike("b.png", images[20] * np.float32(0.72), images[0], masks, **limits)
    away = np.roll(images[20], 2, axis=1)
    with pytest.raises(
        InputError, match=r"^b\.png: out of line with the reference by (1\.9|2\.\d) pixels"
    ):
        check_alike("b.png", away, images[0], masks, **limits)
    check_clipping("b.png", images[20])
    with pytest.raises(InputError, match=r"^b\.png: \d+\.\d\d% of its pixels are overexposed"):
        check_clipping("b.png", np.minimum(images[20] * 3, 1))
