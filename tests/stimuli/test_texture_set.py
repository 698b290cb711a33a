"""The quick set of experiment 2 as it lies on the disk, and how it is made."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from scipy import ndimage, stats

from algorithms.color import encode_srgb
from algorithms.errors import InputError
from algorithms.images import read_channels, read_image, read_labels
from algorithms.light import Light
from stimuli.engine import choose_engine
from stimuli.light_linking.arrangement import BACKGROUND, COARSE, QUICK
from stimuli.light_linking.luminance_observer import most_different
from stimuli.light_linking.render import make_renderer
from stimuli.manifest import Stimulus, StimulusSet, load
from stimuli.sets import texture
from stimuli.sets.texture import ALBEDO_RATIO, plan
from tests.stimuli.conftest import QUICK_SEED


def truth_of(stimuli: StimulusSet, stimulus: Stimulus) -> dict[str, NDArray[np.float32]]:
    """Return the ground truth of a stimulus by name."""
    return {name: read_channels(stimuli.path(file)) for name, file in stimulus.truth.items()}


def regions_of(stimuli: StimulusSet, stimulus: Stimulus) -> NDArray[np.uint8]:
    """Return a stimulus' label image."""
    assert stimulus.regions is not None
    return read_labels(stimuli.path(stimulus.regions))


def test_manifest_is_complete(quick_texture_set: StimulusSet) -> None:
    quick_texture_set.verify()
    assert load(quick_texture_set.folder).model_dump() == quick_texture_set.model_dump()
    assert quick_texture_set.details["clipped_share"] < 0.001
    for stimulus in quick_texture_set.stimuli:
        target = stimulus.factors["target"]
        assert stimulus.answer == (target if stimulus.factors["divergence_deg"] else None)
        assert stimulus.details["objects"][str(target)] == stimulus.factors["texture"]
        assert set(np.unique(regions_of(quick_texture_set, stimulus))) == set(range(9))


def test_every_image_has_a_geometry_of_its_own(quick_texture_set: StimulusSet) -> None:
    for name in ("distance", "relief", "normal", "albedo", "shading"):
        digests = {quick_texture_set.files[s.truth[name]] for s in quick_texture_set.stimuli}
        assert len(digests) == len(quick_texture_set.stimuli)


def test_ground_truth_is_complete(quick_texture_set: StimulusSet) -> None:
    stimulus = quick_texture_set.stimuli[0]
    truth = truth_of(quick_texture_set, stimulus)
    seen = regions_of(quick_texture_set, stimulus) > 0
    assert (np.isfinite(truth["distance"][..., 0]) == seen).all()
    assert (np.isfinite(truth["relief"][..., 0]) == seen).all()
    assert_allclose(np.linalg.norm(truth["normal"], axis=-1), seen, atol=1e-4)
    assert ((truth["albedo"].max(axis=-1) > 0) == seen).all()
    # Pixels on the edge show some of an object whose centre may lie outside.
    assert not truth["shading"][~ndimage.binary_dilation(seen, iterations=2)].any()


def test_shading_is_the_sum_over_the_recorded_lights(quick_texture_set: StimulusSet) -> None:
    # Theory: from normals and lights Lambert's law gives the shading, but where an object shadows
    # itself: there it is lower, never higher.
    for stimulus in quick_texture_set.stimuli[:3]:
        truth = truth_of(quick_texture_set, stimulus)
        regions = regions_of(quick_texture_set, stimulus)
        for label in range(1, 9):
            inside = ndimage.binary_erosion(regions == label, iterations=2)
            name = "target_key" if label == stimulus.factors["target"] else "key"
            lights = [
                Light(**each) for each in (stimulus.details[name], *stimulus.details["ambient"])
            ]
            expected = sum(
                light.intensity / np.pi * np.maximum(0, truth["normal"][inside] @ light.direction)
                for light in lights
            )
            excess = truth["shading"][inside][:, 0] - expected
            assert (np.abs(excess) < 0.02).mean() > 0.6
            assert np.quantile(excess, 0.98) < 0.05


def test_light_tile_in_shadow_is_as_luminous_as_dark_tile_in_light(
    quick_texture_set: StimulusSet,
) -> None:
    # Published: sec. 2.4; medians, as highlights are not the tiles' own luminance.
    ratios = []
    for stimulus in quick_texture_set.with_role("main"):
        truth = truth_of(quick_texture_set, stimulus)
        regions = regions_of(quick_texture_set, stimulus)
        shown = read_image(quick_texture_set.path(stimulus.file))[..., 0]
        albedo = truth["albedo"][..., 0]
        of_one_tile = ndimage.maximum_filter(albedo, 3) - ndimage.minimum_filter(albedo, 3) < 1e-3
        for label in range(1, 9):
            inside = (regions == label) & of_one_tile
            name = "target_key" if label == stimulus.factors["target"] else "key"
            cosine = truth["normal"] @ Light(**stimulus.details[name]).direction
            light = albedo > np.sqrt(ALBEDO_RATIO) * albedo[inside].min()
            clear_in_shadow = shown[inside & light & (cosine < 0)]
            dark_in_light = shown[inside & ~light & (cosine > 0)]
            if min(clear_in_shadow.size, dark_in_light.size) > 30:
                ratios.append(np.median(clear_in_shadow) / np.median(dark_in_light))
    assert len(ratios) > 30
    # Between objects it varies by a third: far from equal would be the ratio of the albedos, 4.
    assert 0.8 < np.exp(np.mean(np.log(ratios))) < 1.25


def test_finest_checkerboard_does_not_alias_at_the_quick_size() -> None:
    # Against many samples: the project's limit for noise, inside the objects that have the finest
    # checkerboard.
    choose_engine()
    cells = plan(np.random.default_rng([QUICK_SEED, 0]), quick=True, replicates=1)
    image, renderer = cells[1].image(), make_renderer(cells[1].place(QUICK_SEED, 2))
    regions = renderer.ground_truth(QUICK).regions
    finest = [label for label, name in enumerate(image.objects, start=1) if name == "high"]
    pictures = []
    for view in (QUICK, replace(QUICK, samples=256)):
        made = renderer.render(view, image.rigs())
        pictures.append(encode_srgb(made.radiance + (1 - made.coverage[..., None]) * BACKGROUND))
    difference = 255 * (pictures[0] - pictures[1])[np.isin(regions, finest)]
    assert np.sqrt((difference**2).mean()) < 1.5
    assert abs(difference.mean()) < 0.1


@pytest.mark.slow
def test_brightness_alone_does_not_give_the_answer() -> None:
    # Theory: an observer at chance (1/8) has more hits than this in one set of a thousand.
    choose_engine()
    cells = plan(np.random.default_rng(4), quick=True, replicates=5)
    hits = []
    for cell in cells:
        if cell.role != "main" or not cell.divergence_deg:
            continue
        objects = cell.place(4, 8)
        made = make_renderer(objects).render(COARSE, cell.image().rigs())
        means = []
        for placed in objects:
            left, top, right, bottom = COARSE.box_px(placed.centre)
            box = slice(top, bottom), slice(left, right)
            means.append(made.radiance[box].sum() / made.coverage[box].sum())
        hits.append(most_different(np.array(means)) == cell.target)
    assert len(hits) == 45
    assert stats.binom.sf(sum(hits) - 1, len(hits), 1 / 8) > 1e-3


@pytest.mark.usefixtures("tiny", "llvm")
def test_same_seed_same_bytes_and_engines_agree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(texture, "plan", lambda *given, **named: plan(*given, **named)[:2])
    make = partial(texture.make, seed=5, quick=True)
    one, two = (make(tmp_path / name, engine="llvm") for name in ("one", "two"))
    assert one.files == two.files
    assert one.digest == two.digest
    scalar = make(tmp_path / "scalar", engine="scalar")
    assert scalar.stimuli == one.stimuli
    for stimulus in scalar.stimuli:
        pictures = [read_image(made.path(stimulus.file)) for made in (one, scalar)]
        assert np.sqrt(((pictures[0] - pictures[1]) ** 2).mean()) < 3e-3


def test_wrong_arguments_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="replicates: 0 given, 1 or more accepted"):
        texture.make(tmp_path / "set", seed=1, replicates=0)
    assert list(tmp_path.iterdir()) == []
