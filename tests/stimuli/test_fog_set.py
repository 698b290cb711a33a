"""The fog set: what is in it, and whether its fog does what fog does."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.images import read_channels, read_labels
from algorithms.light import Light
from stimuli.manifest import Stimulus, StimulusSet
from stimuli.scenes import fog_scene
from stimuli.sets import fog

DENSITIES = {"clear": 0.0, "light": 0.05}
"""Ten times as dense as in the real set, so that little is left of what is far away."""


def make_tiny(folder: Path) -> StimulusSet:
    """Make the set with the real code, from coarse meshes in tiny and noisy images."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fog, "QUICK", fog.Size(80, 0.12))
        patch.setattr(fog, "EXTINCTIONS_PER_M", DENSITIES)
        patch.setattr(fog, "NOISE_LIMITS", {"clear": 8.0, "fog": 10.0})
        patch.setattr(fog_scene, "LAMP_RADIANCE", (9.0, 6.0, 3.0))
        return fog.make(folder, seed=7, quick=True)


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    return make_tiny(tmp_path_factory.mktemp("fog"))


def channels(made: StimulusSet, stimulus: Stimulus, name: str) -> NDArray[np.float64]:
    return np.squeeze(read_channels(made.path(stimulus.truth[name]))).astype(np.float64)


def test_a_density_an_image_with_its_fog_its_noise_and_its_lights(tiny: StimulusSet) -> None:
    clear, foggy = tiny.stimuli
    assert clear.factors == {"density": "clear", "extinction_per_m": 0.0}
    assert foggy.factors == {"density": "light", "extinction_per_m": 0.05}
    assert clear.details["fog"] is None
    assert foggy.details["fog"]["extinction"] == 0.05
    assert foggy.details["fog"]["asymmetry"] == 0.7
    assert 0 < clear.details["noise_rms_of_255"] <= 8
    assert 0 < foggy.details["noise_rms_of_255"] <= 10
    assert Light(**{key: tiny.details["sun"][key] for key in ("azimuth_deg", "elevation_deg")})
    distances = [lamp["distance"] for lamp in tiny.details["lamps"]]
    assert distances == sorted(distances)
    tiny.verify()


def test_every_object_is_seen(tiny: StimulusSet) -> None:
    stimulus = tiny.stimuli[0]
    assert stimulus.regions is not None
    labels = read_labels(tiny.path(stimulus.regions))
    assert set(np.unique(labels)) == {0, *fog_scene.OBJECTS}
    assert tiny.objects == dict(fog_scene.OBJECTS)


def test_lane_recedes_and_the_sky_is_infinitely_far(tiny: StimulusSet) -> None:
    distance = channels(tiny, tiny.stimuli[0], "distance")
    way = channels(tiny, tiny.stimuli[0], "fog_way")
    middle = distance.shape[1] // 2
    lane = distance[-20:, middle]
    assert (np.diff(lane) < 0).all()
    assert 2 < lane[-1] < 8
    assert np.isinf(distance[0]).any()
    assert (way <= distance + 1e-3).all()
    assert np.isfinite(way).all()


def test_things_fade_into_the_airlight_with_distance(tiny: StimulusSet) -> None:
    # Theory: of what sets a small thing off from the airlight, exp(-sigma_t way) is left; a large
    # area loses less, since what leaves one line of sight forwards enters the next one, but no
    # less than with the reduced extinction (1 - g) sigma_t of similarity theory.
    clear, foggy = (channels(tiny, stimulus, "radiance") for stimulus in tiny.stimuli)
    way, distance = (channels(tiny, tiny.stimuli[1], name) for name in ("fog_way", "distance"))
    airlight = np.array(tiny.stimuli[1].details["airlight"])
    left = []
    for nearest, farthest in ((2, 12), (12, 25), (25, 40), (40, 60), (60, 120)):
        band = (way > nearest) & (way < farthest) & np.isfinite(distance)
        before, after = clear[band] - airlight, foggy[band] - airlight
        left.append((before * after).sum() / (before**2).sum())  # a regression averages the noise
        lowest, highest = (np.exp(-share * 0.05 * way[band]).mean() for share in (1, 0.3))
        assert lowest < left[-1] < highest
    assert (np.diff(left) < 0).all()


@pytest.mark.slow
def test_same_recipe_makes_the_same_bytes(tiny: StimulusSet, tmp_path: Path) -> None:
    assert make_tiny(tmp_path / "again").files == tiny.files
