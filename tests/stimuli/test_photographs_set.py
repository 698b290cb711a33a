"""The set of experiment 3, from rendered photographs."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.ndimage import binary_erosion, distance_transform_edt, shift

from algorithms.color import FloatImage
from algorithms.errors import InputError
from algorithms.images import read_image, read_labels, write_image
from stimuli.manifest import StimulusSet
from stimuli.photographs.cloning import seam_of_255
from stimuli.sets import photographs
from tests.stimuli.photographed import NAMES, TOML, take, write_folder

Taken = tuple[dict[int, FloatImage], np.ndarray]


@pytest.fixture(scope="module")
def taken() -> Taken:
    return take()


@pytest.fixture(scope="module")
def given(tmp_path_factory: pytest.TempPathFactory, taken: Taken) -> Path:
    return write_folder(tmp_path_factory.mktemp("given") / "photos", *taken)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory, given: Path) -> StimulusSet:
    return photographs.make(tmp_path_factory.mktemp("made"), photographs=given)


def test_every_object_under_every_other_light(made: StimulusSet) -> None:
    # Design: Lopez-Moreno 2011, sec. 2.5: a control, single objects, and pairs where wanted.
    table = made.to_frame()
    assert len(table) == 1 + 2 * (3 + 1)
    assert dict(made.objects) == dict(enumerate(NAMES, start=1))
    control = table.iloc[0]
    assert (control.object, control.divergence_deg, control.answer) == ("none", 0, None)
    assert set(table.divergence_deg[1:]) == {20.0, 40.0}
    single = table[table.inserted == 1]
    assert [NAMES[answer - 1] for answer in single.answer] == list(single.object)
    pairs = table[table.inserted == 2]
    assert set(pairs.object) == {"doll+robot"}
    assert all(tuple(answer) == (1, 3) for answer in pairs.answer)


def test_the_control_is_the_reference(made: StimulusSet, given: Path) -> None:
    shown = read_image(made.path(made.stimuli[0].file))
    assert_array_equal(shown, read_image(given / "light-0.png"))


def test_regions_are_the_masks(made: StimulusSet, taken: Taken) -> None:
    for stimulus in made.stimuli:
        assert stimulus.regions is not None
        assert_array_equal(read_labels(made.path(stimulus.regions)), taken[1])


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("turn", [20, 40])
def test_composites_are_the_reference_outside_and_the_source_inside(
    made: StimulusSet, given: Path, taken: Taken, name: str, turn: int
) -> None:
    stimulus = next(
        s
        for s in made.stimuli
        if s.factors["object"] == name and s.factors["photograph"] == f"light-{turn}"
    )
    shown = read_image(made.path(stimulus.file))
    target, source = (read_image(given / f"light-{t}.png") for t in (0, turn))
    mask = taken[1] == stimulus.answer
    outside = (shown == target).all(axis=-1)
    # Outside a narrow band the reference is untouched.
    assert outside[distance_transform_edt(~mask) > made.details["margin_px"]].all()
    # Inside, the gradients are the source's, but for 8-bit steps, and the light is the source's.
    deep = binary_erosion(mask, iterations=4)
    for axis in (0, 1):
        steps = np.diff(shown, axis=axis) - np.diff(source, axis=axis)
        inside = np.delete(deep, -1, axis) & np.delete(deep, 0, axis)
        assert np.abs(steps[inside]).max() < 0.01
    assert stimulus.details["object_change_rms_of_255"] < 1
    assert np.abs(shown - source)[deep].max() < 0.01
    assert np.abs(shown - target)[mask].max() > 0.05  # the light did move
    # The seam is weaker than that of a paste, by the same measure.
    pasted = np.where(mask[..., None], source, target)
    naive = seam_of_255(pasted, target, source, mask)
    assert stimulus.details["seam_of_255"] < 0.6 * naive


def test_pairs_hold_both(made: StimulusSet, given: Path, taken: Taken) -> None:
    pair = next(s for s in made.stimuli if s.factors["inserted"] == 2)
    shown = read_image(made.path(pair.file))
    source = read_image(given / f"{pair.factors['photograph']}.png")
    target = read_image(given / "light-0.png")
    for label, expected in ((1, source), (2, target), (3, source)):
        deep = binary_erosion(taken[1] == label, iterations=4)
        assert_allclose(shown[deep], expected[deep], atol=0.01)


def test_same_photographs_make_the_same_bytes(
    made: StimulusSet, given: Path, tmp_path: Path
) -> None:
    assert photographs.make(tmp_path / "again", photographs=given).digest == made.digest


def test_quick_is_half_the_size(given: Path, tmp_path: Path, made: StimulusSet) -> None:
    quick = photographs.make(tmp_path / "quick", photographs=given, quick=True)
    assert len(quick.stimuli) == len(made.stimuli)
    assert read_image(quick.path(quick.stimuli[3].file)).shape == (55, 130, 3)
    assert quick.stimuli[0].regions is not None
    labels = read_labels(quick.path(quick.stimuli[0].regions))
    assert set(np.unique(labels)) == {0, 1, 2, 3}


def test_linear_photographs_get_one_exposure(taken: Taken, tmp_path: Path) -> None:
    text = TOML.replace('.png" =', '.exr" =').replace(
        'reference = "light-0.png"', 'reference = "light-0.exr"'
    )
    folder = write_folder(tmp_path / "photos", taken[0], taken[1], text)
    for turn, image in taken[0].items():
        write_image(folder / f"light-{turn}.exr", image * np.float32(37))
    made = photographs.make(tmp_path / "set", photographs=folder)
    peak = max(image.max() for image in taken[0].values()) * 37
    assert 1 / peak <= made.exposure < 1.3 / peak
    control = read_image(made.path(made.stimuli[0].file))
    assert_allclose(control, np.minimum(taken[0][0] * 37 * made.exposure, 1), atol=0.005)


def test_lights_are_recorded_where_they_are_known(taken: Taken, tmp_path: Path) -> None:
    text = TOML
    for turn, angle in ((0, 0), (20, 20), (40, -40)):
        text = text.replace(
            f'"light-{turn}.png" = {angle}',
            f'"light-{turn}.png" = {{ azimuth_deg = 0, elevation_deg = {angle} }}',
        )
    folder = write_folder(tmp_path / "photos", *taken, toml=text)
    made = photographs.make(tmp_path / "set", photographs=folder, quick=True)
    last = made.stimuli[2]
    assert last.details["key"]["elevation_deg"] == 0
    assert last.details["target_key"]["elevation_deg"] == -40
    assert last.factors["divergence_deg"] == 40


def spoil(name: str, images: dict[int, FloatImage]) -> dict[int, FloatImage]:
    """Return the photographs with the one at 20 degrees spoilt."""
    other = images[20]
    other = {
        "another size": other[:-1],
        "moved": shift(other, (1, 0, 0), order=1, mode="nearest"),
        "darker": other * np.float32(0.75),
        "bluer": other * np.array([1, 1, 0.7], dtype=np.float32),
        "clipped": np.where(other > np.quantile(other, 0.995), 1, other).astype(np.float32),
    }[name]
    return {**images, 20: other}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("another size", "260 x 109 pixels; the reference's 260 x 110 are accepted"),
        ("moved", r"out of line with the reference by (0\.[89]|1\.\d) pixels"),
        ("darker", "its exposure or white balance differs"),
        ("bluer", "its exposure or white balance differs"),
        ("clipped", "of its pixels are overexposed"),
    ],
)
def test_photographs_that_are_not_alike_are_refused(
    taken: Taken, tmp_path: Path, name: str, message: str
) -> None:
    folder = write_folder(tmp_path / "photos", spoil(name, taken[0]), taken[1])
    with pytest.raises(InputError, match=rf"light-20\.png: .*{message}") as caught:
        photographs.make(tmp_path / "set", photographs=folder)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "set" / "manifest.json").exists()


def test_wider_limits_are_for_those_who_know(taken: Taken, tmp_path: Path) -> None:
    text = "max_exposure_stops = 1.0\n" + TOML
    folder = write_folder(tmp_path / "photos", spoil("darker", taken[0]), taken[1], text)
    made = photographs.make(tmp_path / "set", photographs=folder, quick=True)
    assert made.details["photographs"]["light-20.png"]["exposure_stops"] > 0.25


def test_missing_and_mixed_photographs_are_refused(taken: Taken, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"photographs: a folder .* is needed \(--photographs"):
        photographs.make(tmp_path / "set")
    folder = write_folder(tmp_path / "photos", *taken)
    (folder / "light-20.png").unlink()
    with pytest.raises(InputError, match=r"light-20\.png: cannot be read"):
        photographs.make(tmp_path / "set", photographs=folder)
    text = TOML.replace("light-20.png", "light-20.exr")
    mixed = write_folder(tmp_path / "mixed", taken[0], taken[1], text)
    write_image(mixed / "light-20.exr", taken[0][20])
    with pytest.raises(InputError, match="OpenEXR files only, or PNG and JPEG files only"):
        photographs.make(tmp_path / "set", photographs=mixed)


def test_other_photographs_need_another_folder(taken: Taken, tmp_path: Path) -> None:
    folder = write_folder(tmp_path / "photos", *taken)
    photographs.make(tmp_path / "set", photographs=folder, quick=True)
    write_image(folder / "light-40.png", taken[0][40] * np.float32(0.99))
    with pytest.raises(InputError, match="holds a set made with another parameters"):
        photographs.make(tmp_path / "set", photographs=folder, quick=True)
