"""The quick set of light probes as it lies on the disk."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray
from PIL import Image
from scipy import ndimage

from algorithms.images import read_channels, read_labels
from algorithms.light import Light
from stimuli.camera import CAMERA_DISTANCE, View
from stimuli.manifest import Stimulus, StimulusSet, load
from stimuli.scenes.probe_objects import PROBES
from stimuli.sets import lightprobes
from stimuli.sets.lightprobes import QUICK, ProbeImage
from tests.stimuli.bodies import pixel_centres

HALF = 2.0**-10
"""The relative rounding of half precision, of a product of two."""


@pytest.fixture(scope="session")
def probes(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """The quick set, rendered by the fastest engine."""
    return lightprobes.make(tmp_path_factory.mktemp("probes"), seed=2011, quick=True)


def truth_of(stimuli: StimulusSet, stimulus: Stimulus) -> dict[str, NDArray[np.float32]]:
    """Return the ground truth of a stimulus by name."""
    return {name: read_channels(stimuli.path(file)) for name, file in stimulus.truth.items()}


def whole_pixels(stimuli: StimulusSet, stimulus: Stimulus) -> NDArray[np.bool_]:
    """Return where nothing but the object is seen."""
    assert stimulus.regions is not None
    inside = read_labels(stimuli.path(stimulus.regions)) == 1
    return np.asarray(ndimage.binary_erosion(inside, iterations=2))


def lights_of(stimulus: Stimulus) -> list[Light]:
    """Return a stimulus' lights as recorded."""
    return [Light(**light) for light in stimulus.details["lights"]]


def is_matt(stimulus: Stimulus) -> bool:
    """Return whether Lambert's law holds."""
    return not stimulus.factors["gloss"] and stimulus.factors["medium"] == "opaque"


def test_manifest_is_complete(probes: StimulusSet) -> None:
    probes.verify()
    assert load(probes.folder).model_dump() == probes.model_dump()
    assert probes.details["clipped_share"] < 0.001
    frame = probes.to_frame()
    assert len(frame) == len(probes.stimuli)
    for stimulus in probes.stimuli:
        names = {"radiance", "shading", "distance", "relief", "normal"}
        opaque = stimulus.factors["medium"] == "opaque"
        assert stimulus.truth.keys() == (names | {"albedo"} if opaque else names)
        assert whole_pixels(probes, stimulus).any()
        with Image.open(probes.path(stimulus.file)) as picture:
            digits = np.array(picture)
        assert (digits[[0, -1]] == 128).all()  # the background


def test_albedo_times_shading_is_the_radiance_of_matt_probes(probes: StimulusSet) -> None:
    # Theory: Lambert's law; where the albedo varies a pixel's mean of the product is not the
    # product of its means.
    for stimulus in filter(is_matt, probes.stimuli):
        truth, whole = truth_of(probes, stimulus), whole_pixels(probes, stimulus)
        product = (truth["albedo"] * truth["shading"])[whole]
        radiance = truth["radiance"][whole]
        if PROBES[str(stimulus.factors["probe"])].material.pattern == "plain":
            assert_allclose(product, radiance, rtol=HALF, atol=1e-6)
        else:
            assert (np.abs(product - radiance) < 4 / 255).mean() > 0.8
            assert abs((product - radiance).mean()) < 0.5 / 255


def test_highlights_have_the_colour_of_the_light(probes: StimulusSet) -> None:
    # Theory: the dichromatic model; what the body's colour does not explain is white.
    for stimulus in probes.stimuli:
        if stimulus.factors["group"] != "gloss":
            continue
        truth, whole = truth_of(probes, stimulus), whole_pixels(probes, stimulus)
        red, _, blue = PROBES[str(stimulus.factors["probe"])].colour
        radiance = truth["radiance"][whole]
        white = (radiance[:, 2] - blue / red * radiance[:, 0]) / (1 - blue / red)
        if stimulus.factors["gloss"]:
            assert white.max() > 0.04
            assert white.min() > -1e-3
        else:
            assert_allclose(white, 0, atol=1e-3)


def test_shading_comes_from_the_recorded_lights(probes: StimulusSet) -> None:
    # Theory: Lambert's law and the inverse-square law, from recorded lights, normals and
    # distances; where the object shadows itself the shading is lower, never higher.
    for stimulus in probes.stimuli:
        if stimulus.factors["area_radius_deg"] or stimulus.details["ambient_irradiance"]:
            continue
        truth, whole = truth_of(probes, stimulus), whole_pixels(probes, stimulus)
        z = CAMERA_DISTANCE - truth["distance"][..., 0]
        points = np.stack([*pixel_centres(QUICK), z], axis=-1)[whole]
        expected = np.zeros(len(points))
        for light in lights_of(stimulus):
            way, strength = light.direction, np.full(len(points), light.intensity)
            if light.distance is not None:
                way = light.distance * light.direction - points
                length = np.linalg.norm(way, axis=-1)
                way, strength = way / length[:, None], strength * (light.distance / length) ** 2
            cosine = (truth["normal"][whole] * way).sum(axis=-1)
            expected += strength / np.pi * np.maximum(0, cosine)
        excess = truth["shading"][whole][:, 0] - expected
        assert (np.abs(excess) < 0.03).mean() > 0.75, stimulus.id
        assert np.quantile(excess, 0.98) < 0.06, stimulus.id


def test_nearest_points_are_equally_bright_at_all_distances(probes: StimulusSet) -> None:
    # Theory: what the intensities were chosen for; the object reaches the unit sphere nearly.
    brightest = [
        truth_of(probes, stimulus)["shading"].max()
        for stimulus in probes.stimuli
        if stimulus.factors["group"] == "distance"
    ]
    assert len(brightest) > 3
    assert all(0.4 < value <= 1.01 for value in brightest)


def test_wider_light_has_softer_shading(probes: StimulusSet) -> None:
    images = [s for s in probes.stimuli if s.factors["area_radius_deg"]]
    steepness = {
        (s.factors["area_radius_deg"], s.factors["probe"]): np.quantile(
            np.abs(np.gradient(truth_of(probes, s)["shading"][..., 0], axis=1))[
                whole_pixels(probes, s)
            ],
            0.98,
        )
        for s in images
    }
    small, large = lightprobes.AREA_RADII_DEG
    for probe in ("O1", "O3"):
        assert steepness[large, probe] < steepness[small, probe]


def test_translucent_probes_are_smoother_and_their_noise_is_known(probes: StimulusSet) -> None:
    images = [s for s in probes.stimuli if s.factors["medium"] != "opaque"]
    assert images
    shares = {}
    for stimulus in images:
        assert stimulus.details["noise_rms_of_255"] <= 1
        truth, whole = truth_of(probes, stimulus), whole_pixels(probes, stimulus)
        dark = whole & (truth["shading"][..., 0] == 0)
        if dark.any():
            green = truth["radiance"][..., 1]
            shares[stimulus.id, stimulus.factors["radius_mm"]] = green[dark].mean() / green.max()
    # Where no light falls some comes through, and more so in smaller bodies.
    by_size = {radius: [v for (_, r), v in shares.items() if r == radius] for _, radius in shares}
    means = [np.mean(by_size[radius]) for radius in sorted(by_size, reverse=True)]
    assert len(means) > 1
    assert all(first < second for first, second in pairwise(means))


TINY = View(width_px=40, height_px=40, radius_px=18, samples=4)


def few(*_: object, **__: object) -> list[ProbeImage]:
    """Return a design of four images."""
    key = Light(20, 30, np.pi)
    images = (
        ProbeImage("single", "O1", (key,), ambient=0.2),
        ProbeImage("distance", "O1", (replace(key, distance=2.0),)),
        ProbeImage("area", "O1", (key,), area_radius_deg=20),
        ProbeImage("translucent", "O1", (key,), radius_mm=20),
    )
    return [replace(image, number=number) for number, image in enumerate(images)]


@pytest.mark.usefixtures("llvm")
def test_same_seed_same_bytes_and_engines_agree(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lightprobes, "design", few)
    monkeypatch.setattr(lightprobes, "QUICK", TINY)
    monkeypatch.setattr(lightprobes, "_COARSE", TINY)
    monkeypatch.setattr(lightprobes, "_QUICK_COARSENESS", 8)
    one, two = (
        lightprobes.make(tmp_path / name, seed=3, quick=True, engine="llvm")
        for name in ("one", "two")
    )
    assert one.files == two.files
    assert one.digest == two.digest
    scalar = lightprobes.make(tmp_path / "scalar", seed=3, quick=True, engine="scalar")
    assert "translucent" in scalar.details["left_out"][-1]
    assert scalar.stimuli == one.stimuli[:3]
    for stimulus in scalar.stimuli:
        first, second = (truth_of(made, stimulus)["radiance"] for made in (one, scalar))
        # Many lights are dealt out to the samples by one engine alone.
        assert np.sqrt(((first - second) ** 2).mean()) < 1e-2
