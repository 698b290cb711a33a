"""The still life: what stands where, under which light, with which truth."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from algorithms.errors import UnavailableError
from algorithms.images import read_channels, read_labels
from algorithms.light import Light
from stimuli.engine import Engine
from stimuli.manifest import StimulusSet
from stimuli.scenes.still_life_scene import LIGHTINGS, OBJECTS, StillLife, camera
from stimuli.sets import still_life
from stimuli.truth import TRUTH_NAMES

TINY = replace(still_life.QUICK, width_px=72, photons=100_000, samples=64)


def make_tiny(folder: Path, size: still_life.Size = TINY) -> StimulusSet:
    """Make the set with the real code, in tiny pictures."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(still_life, "QUICK", size)
        return still_life.make(folder, seed=3, quick=True, engine="llvm")


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    return make_tiny(tmp_path_factory.mktemp("still-life"))


@pytest.fixture(autouse=True)
def _needs_llvm(llvm: Engine) -> None:
    """Photons need the engine with kernels."""


def test_every_object_is_seen_and_every_lighting_is_there(tiny: StimulusSet) -> None:
    assert [s.factors["lighting"] for s in tiny.stimuli] == ["original", "front", "back"]
    assert dict(tiny.objects) == dict(OBJECTS)
    tiny.verify()
    for stimulus in tiny.stimuli:
        assert stimulus.regions is not None
        labels = read_labels(tiny.path(stimulus.regions))
        assert set(np.unique(labels)) == {0, *OBJECTS}
        assert 0 < stimulus.details["noise_rms_of_255"] <= 1
        assert Light(**stimulus.details["key"]) == LIGHTINGS[str(stimulus.factors["lighting"])]
    assert tiny.details["clipped_share"] < 0.001


def test_distance_relief_and_normals_belong_together(tiny: StimulusSet) -> None:
    # Theory: relief is the depth in pixels; on the glass ball it is a sphere's.
    truth = {
        name: np.squeeze(read_channels(tiny.path(file)))
        for name, file in tiny.stimuli[0].truth.items()
        if name in TRUTH_NAMES
    }
    regions_of_first = tiny.stimuli[0].regions
    assert regions_of_first is not None
    labels = read_labels(tiny.path(regions_of_first))
    ball = labels == next(number for number, name in OBJECTS.items() if name == "glass ball")
    assert (np.isfinite(truth["relief"]) == (labels > 0)).all()
    nearest = np.nanargmax(np.where(ball, truth["relief"], np.nan))
    assert truth["normal"].reshape(-1, 3)[nearest, 2] > 0.9
    # A sphere falls back by its radius (in pixels) from its nearest point to its rim.
    radius_px = np.sqrt(ball.sum() / np.pi)
    assert truth["relief"][ball].max() == pytest.approx(radius_px, rel=0.25)
    assert (truth["distance"][ball] < truth["distance"][labels == 0].max()).all()
    assert np.isfinite(truth["distance"]).all()


def test_lights_come_from_where_they_are_said_to(tiny: StimulusSet) -> None:
    # Theory: the side of a matt round thing that faces the light is the brighter one.
    first = tiny.stimuli[0]
    assert first.regions is not None
    labels = read_labels(tiny.path(first.regions))
    normal = read_channels(tiny.path(first.truth["normal"]))
    lemon = labels == next(number for number, name in OBJECTS.items() if name == "lemon")
    for stimulus in tiny.stimuli:
        light = Light(**stimulus.details["key"])
        shown = read_channels(tiny.path(stimulus.truth["radiance"]))[lemon].mean(axis=-1)
        facing = normal[lemon] @ light.direction
        towards, away = np.quantile(facing, (0.8, 0.2))
        assert shown[facing >= towards].mean() > 1.2 * shown[facing <= away].mean()


def test_glass_throws_caustics_that_a_path_tracer_does_not_find(llvm: Engine) -> None:  # noqa: ARG001
    life = StillLife(np.random.default_rng(1))
    view = camera(TINY.width_px)
    lit = still_life._Lighting(life, "original", view, TINY)
    with_caustics = np.mean([lit.render(seed, 0) for seed in range(4)], axis=0)
    traced = [still_life._trace(lit.scene, view, seed, TINY.samples) for seed in range(4)]
    without = np.mean(traced, axis=0)
    added = (with_caustics - without).mean(axis=-1)
    assert added.min() >= -1e-5
    assert (added > 0.05).sum() > 5


@pytest.mark.slow
def test_same_seed_same_bytes(tiny: StimulusSet, tmp_path: Path) -> None:
    again = make_tiny(tmp_path)
    assert again.digest == tiny.digest


def test_scalar_engine_says_what_is_missing(tmp_path: Path) -> None:
    with pytest.raises(UnavailableError, match="apt install libllvm19"):
        still_life.make(tmp_path, seed=1, quick=True, engine="scalar")
    assert not (tmp_path / "manifest.json").exists()


def test_camera_keeps_its_composition_at_every_size() -> None:
    large, small = camera(1024), camera(320)
    assert large.height_px / large.width_px == small.height_px / small.width_px == 0.75
    points = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]])
    assert np.allclose(large.project(points) / 1024, small.project(points) / 320)
