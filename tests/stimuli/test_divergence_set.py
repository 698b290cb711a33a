"""The quick set of experiment 1 as it lies on the disk."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from PIL import Image
from scipy import ndimage, stats

from algorithms.color import encode_srgb
from algorithms.images import read_channels, read_labels, write_image
from algorithms.light import Light, angle_between_deg
from stimuli.light_linking.arrangement import BACKGROUND, COARSE, QUICK
from stimuli.light_linking.luminance_observer import outlier_hit_rates
from stimuli.light_linking.materials import TABLE_2_1
from stimuli.light_linking.render import Renderer
from stimuli.light_linking.rigs import AMBIENT
from stimuli.manifest import Stimulus, StimulusSet, load
from stimuli.sets import divergence


def digits(path: Path) -> NDArray[np.uint8]:
    """Return a picture's encoded values."""
    with Image.open(path) as picture:
        return np.array(picture)


def regions_of(stimuli: StimulusSet, stimulus: Stimulus) -> NDArray[np.uint8]:
    """Return a stimulus' label image."""
    assert stimulus.regions is not None
    return read_labels(stimuli.path(stimulus.regions))


def test_manifest_lists_every_file(quick_set: StimulusSet) -> None:
    folder = quick_set.folder
    on_disk = {p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.is_file()}
    assert on_disk - {"manifest.json", "recipe.json"} == set(quick_set.files)
    quick_set.verify()
    assert load(folder).model_dump() == quick_set.model_dump()


def test_answers_are_the_targets_and_none_at_zero(quick_set: StimulusSet) -> None:
    assert [quick_set.objects[label] for label in range(1, 9)] == list(divergence.MAIN_ORDER)
    for stimulus in quick_set.stimuli:
        objects = stimulus.details["objects"]
        if stimulus.factors["divergence_deg"] == 0:
            assert stimulus.answer is None
        else:
            assert isinstance(stimulus.answer, int)
            assert objects[str(stimulus.answer)] == stimulus.factors["target"]


def test_lights_are_recorded(quick_set: StimulusSet) -> None:
    for stimulus in quick_set.stimuli:
        key, wrong = (Light(**stimulus.details[name]) for name in ("key", "target_key"))
        level_deg = stimulus.factors["divergence_deg"]
        assert angle_between_deg(key, wrong) == pytest.approx(level_deg)
        assert len(stimulus.details["ambient"]) == 2


def test_regions_are_eight_in_reading_order(quick_set: StimulusSet) -> None:
    for role in ("main", "practice"):
        labels = regions_of(quick_set, quick_set.with_role(role)[0])
        assert set(np.unique(labels)) == set(range(9))
        centres = ndimage.center_of_mass(labels > 0, labels, range(1, 9))
        assert sorted(range(8), key=lambda i: (centres[i][0] > 150, centres[i][1])) == list(
            range(8)
        )
        for label in range(1, 9):
            assert ndimage.label(labels == label)[1] == 1
        areas = np.bincount(labels.ravel())[1:]
        assert areas.min() > 0.6 * areas.max()


def test_objects_keep_clear_of_each_other_and_of_the_border(quick_set: StimulusSet) -> None:
    labels = regions_of(quick_set, quick_set.stimuli[0])
    assert not np.concatenate([labels[[0, -1]].ravel(), labels[:, [0, -1]].ravel()]).any()
    for label in range(1, 9):
        around = ndimage.binary_dilation(labels == label, iterations=4)
        assert set(np.unique(labels[around])) == {0, label}


def test_ground_truth_is_complete(quick_set: StimulusSet) -> None:
    for stimulus in (quick_set.stimuli[0], quick_set.stimuli[-1]):
        seen = regions_of(quick_set, stimulus) > 0
        truth = {name: read_channels(quick_set.path(file)) for name, file in stimulus.truth.items()}
        assert truth.keys() == {"distance", "relief", "normal", "albedo", "shading"}
        assert (np.isfinite(truth["distance"][..., 0]) == seen).all()
        lengths = np.linalg.norm(truth["normal"], axis=-1)
        assert_allclose(lengths, seen, atol=1e-4)
        assert (truth["normal"][seen][:, 2] > -0.2).all()  # towards the viewer, but for the rim
        assert ((truth["albedo"].max(axis=-1) > 0) == seen).all()


def test_few_pixels_are_clipped_and_the_background_is_one_grey(quick_set: StimulusSet) -> None:
    pictures = [digits(quick_set.path(stimulus.file)) for stimulus in quick_set.stimuli]
    clipped = np.mean([(picture == 255).any(axis=-1).mean() for picture in pictures])
    assert clipped < 0.001
    assert quick_set.details["clipped_share"] == pytest.approx(clipped)
    # The objects fill the scale: an exposure far too low would clip nothing either.
    assert max(int(picture.max()) for picture in pictures) == 255
    for picture in pictures:
        assert (picture[[0, -1]] == 128).all()


def shown(
    renderer: Renderer, stimuli: StimulusSet, keys: list[Light], path: Path
) -> NDArray[np.uint8]:
    """Render with the set's one exposure, and return the encoded values."""
    made = renderer.render(QUICK, [(key, *AMBIENT) for key in keys])
    background = (1 - made.coverage[..., None]) * np.float32(BACKGROUND)
    write_image(path, made.radiance * np.float32(stimuli.exposure) + background)
    return digits(path)


@pytest.mark.parametrize("placement", ["front", "back", "front-back"])
@pytest.mark.parametrize("level_deg", [0, 10, 40, 90])
def test_answer_is_the_object_under_another_light(
    quick_set: StimulusSet,
    main_renderer: Renderer,
    tmp_path: Path,
    placement: str,
    level_deg: int,
) -> None:
    # Recovery: rendered again under its key light alone, at the one exposure of the set, the image
    # differs inside the answer's region and nowhere else.
    (stimulus,) = (
        s
        for s in quick_set.with_role("main")
        if (s.factors["placement"], s.factors["divergence_deg"]) == (placement, level_deg)
    )
    keys = [Light(**stimulus.details["key"])] * 8
    consistent = shown(main_renderer, quick_set, keys, tmp_path / "consistent.png")
    changed = (consistent != digits(quick_set.path(stimulus.file))).any(axis=-1)
    if stimulus.answer is None:
        assert not changed.any()
        return
    inside = regions_of(quick_set, stimulus) == stimulus.answer
    assert changed[inside].mean() > 0.05
    # Pixels on the edge belong to the region by their centre or not, but show some of the object.
    assert not changed[~ndimage.binary_dilation(inside, iterations=2)].any()


def test_matt_objects_are_as_bright_as_the_manifest_says(quick_set: StimulusSet) -> None:
    # Theory: from what the set records (normals, albedo, lights, exposure) Lambert's law gives the
    # digits of a matt object, but where it shadows itself: there they are lower, never higher.
    for stimulus in quick_set.with_role("main"):
        labels = regions_of(quick_set, stimulus)
        truth = {name: read_channels(quick_set.path(file)) for name, file in stimulus.truth.items()}
        found = digits(quick_set.path(stimulus.file))[..., 0].astype(float)
        for label, letter in quick_set.objects.items():
            if TABLE_2_1[letter].finish == "shiny":
                continue
            inside = ndimage.binary_erosion(labels == label, iterations=2)
            name = "target_key" if letter == stimulus.factors["target"] else "key"
            recorded = (stimulus.details[name], *stimulus.details["ambient"])
            lights = [Light(**each) for each in recorded]
            irradiance = sum(
                light.intensity * np.maximum(0, truth["normal"][inside] @ light.direction)
                for light in lights
            )
            radiance = truth["albedo"][inside][:, 0] / np.pi * irradiance
            excess = found[inside] - 255 * encode_srgb(quick_set.exposure * radiance)
            assert (np.abs(excess) < 2).mean() > 0.65
            # Where a fold hides another one, a pixel shows something of both.
            assert np.quantile(excess, 0.99) < 10


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2010, 2011])
def test_brightness_alone_does_not_give_the_answer(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Theory: an observer at chance (1/8) has more hits than this in one set of a thousand, or at
    # one of nine levels in one set of a hundred.
    # Small pictures by the scalar engine, which adds up what few lights give: the quickest way.
    monkeypatch.setattr(divergence, "QUICK", COARSE)
    stimuli = divergence.make(tmp_path, seed=seed, quick=True, replicates=4, engine="scalar")
    rates = outlier_hit_rates(stimuli, "divergence_deg")
    assert [rate.level for rate in rates] == list(range(10, 91, 10))
    hits, images = (sum(getattr(rate, name) for rate in rates) for name in ("hits", "images"))
    assert images == 108
    assert stats.binom.sf(hits - 1, images, 1 / 8) > 1e-3
    for rate in rates:
        assert stats.binom.sf(rate.hits - 1, rate.images, 1 / 8) > 1e-2 / len(rates)
