"""The set of fog by several methods: its design, and whether each method is what it is called."""

import numpy as np
import pytest

from algorithms.fog import Fog
from experiments.study import check_stimuli, load_study
from stimuli.manifest import StimulusSet
from stimuli.sets import fog_methods
from stimuli.sets.fog_methods import AS_COMPARED, Scene, design, edited

UNLIT = Fog(0.3, airlight=(0.5, 0.5, 0.5), desaturation=0.5)


@pytest.fixture(scope="module")
def scene() -> Scene:
    """Rows of posts that recede over a ramp of distance."""
    generator = np.random.default_rng(4)
    distance = np.repeat(np.linspace(9, 1, 60, dtype=np.float32)[:, None], 80, axis=1)
    image = generator.uniform(0.05, 0.9, (60, 80, 3)).astype(np.float32)
    return Scene(image, distance, UNLIT, image / np.float32(2))


def made(scene: Scene, method: str, preset: str = AS_COMPARED) -> np.ndarray:
    return edited(scene, method, preset, np.random.default_rng(1))


def test_a_scene_has_six_methods_the_presets_and_itself() -> None:
    for name in fog_methods.SCENES:
        stimuli = [each for each in design() if each.factors["scene"] == name]
        compared = [each for each in stimuli if each.factors["preset"] == AS_COMPARED]
        assert len({each.factors["method"] for each in compared}) == len(compared) == 6
        assert [each.role for each in stimuli].count("example") == 1
        assert {each.factors["preset"] for each in stimuli} > set(fog_methods.PRESET_NAMES)
    assert len({each.id for each in design()}) == len(design()) == 20


@pytest.mark.parametrize("study", ["fog-realism", "fog-ranking"])
def test_the_studies_of_fog_accept_it(study: str) -> None:
    stimuli = StimulusSet(
        name="fog-methods",
        generator="test",
        seed=1,
        engine="none",
        versions={},
        parameters={},
        exposure=1.0,
        objects={},
        details={},
        stimuli=design(),
        files={file: "0" * 64 for each in design() for file in (each.file, *each.truth.values())},
    )
    check_stimuli(load_study(study), stimuli)


def test_methods_are_what_they_are_called(scene: Scene) -> None:
    assert (made(scene, "none") == scene.image).all()
    assert (made(scene, "path-traced") == scene.image / 2).all()
    ours, veil, planes = (made(scene, name) for name in ("image-based", "veil", "planes"))
    # Theory: fog takes contrast in proportion to exp(-k z), a veil the same everywhere.
    kept = [image.std(axis=(1, 2)) / scene.image.std(axis=(1, 2)) for image in (ours, veil)]
    assert kept[0][-1] > 3 * kept[0][0]
    assert kept[1].max() < 1.5 * kept[1].min()
    three = fog_methods._planes(scene.distance)
    assert len(np.unique(three)) == 3
    assert (
        np.abs(three - scene.distance).mean()
        < np.abs(np.median(scene.distance) - scene.distance).mean()
    )
    assert not np.allclose(planes, ours)
    cloudy = made(scene, "clouds") - ours
    assert cloudy.min() < -0.02
    assert cloudy.max() > 0.02


def test_presets_scale_distance(scene: Scene) -> None:
    # Theory: their distances are shares of the farthest, so that the unit does not matter.
    far = Scene(scene.image, scene.distance * 100, scene.fog, None)
    preset = fog_methods.PRESET_NAMES[0]
    np.testing.assert_allclose(
        made(scene, "image-based", preset), made(far, "image-based", preset), rtol=1e-4, atol=1e-5
    )
