"""The set of chapter 9: its design, its files, and that its bytes are those of its recipe."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms.errors import InputError, UnavailableError
from algorithms.images import read_channels, read_image, read_labels
from algorithms.light import Light
from stimuli.camera import View
from stimuli.manifest import StimulusSet
from stimuli.scenes import translucent_bodies
from stimuli.scenes.translucent_bodies import SHAPES, mesh_of
from stimuli.sets import translucency
from stimuli.sets.translucency import LIGHTS, MEDIA, RADIUS_MM, design
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import Mesh
from stimuli.translucency.dipole import Dipole
from stimuli.translucency.media import MEASURED


def test_full_design_crosses_objects_media_and_lights() -> None:
    images = design(quick=False)
    crossed = [image for image in images if image.radius_mm == RADIUS_MM]
    assert len(crossed) == len(SHAPES) * len(MEDIA) * len(LIGHTS)
    assert len({(image.shape, image.medium, image.light) for image in crossed}) == len(crossed)
    others = {image.radius_mm for image in images} - {RADIUS_MM}
    assert others == {2.5, 5.0, 20.0}
    assert [image.number for image in images] == list(range(len(images)))
    assert len({image.stimulus().id for image in images}) == len(images)
    assert set(MEDIA) <= set(MEASURED)


def test_quick_design_has_every_kind_of_image() -> None:
    images = design(quick=True)
    assert len(images) < 20
    assert {image.light for image in images} == set(LIGHTS)
    assert len({image.radius_mm for image in images}) == 2
    assert {MEASURED[image.medium].refractive_index for image in images} == {1.3, 1.5}


@pytest.mark.parametrize("shape", SHAPES)
def test_objects_are_closed_and_of_one_size(shape: str) -> None:
    mesh = mesh_of(shape, seed=1)
    assert mesh.is_closed
    assert mesh.bounding_radius == pytest.approx(1, abs=0.01)


def test_light_comes_from_where_the_factor_says() -> None:
    assert LIGHTS["front"].elevation_deg > 0 > LIGHTS["back"].elevation_deg
    assert LIGHTS["side"].elevation_deg == 0


@pytest.fixture
def make_tiny(monkeypatch: pytest.MonkeyPatch, llvm: str) -> Callable[..., StimulusSet]:
    """Make a set by the real code, small, with four images of one coarse object."""
    assert llvm == "llvm"

    def coarse(shape: str, seed: int) -> Mesh:
        assert shape == "heart"
        return AbstractShape(np.random.default_rng(seed)).mesh(24, 48)

    images = design(quick=True)
    kept = tuple(images[index] for index in (0, 2, 3, 12))
    monkeypatch.setattr(translucency, "design", lambda *, quick: kept if quick else images)
    monkeypatch.setattr(translucent_bodies, "mesh_of", coarse)
    view = View(width_px=40, height_px=40, radius_px=18, samples=64)
    monkeypatch.setattr(translucency, "QUICK", view)
    monkeypatch.setattr("stimuli.translucency.renderer.FEWEST_POINTS", 3000)
    monkeypatch.setattr("stimuli.translucency.renderer.MOST_POINTS", 5000)
    return partial(translucency.make, seed=3, quick=True, engine="llvm")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("translucency")


@pytest.fixture
def tiny(make_tiny: Callable[..., StimulusSet], folder: Path) -> StimulusSet:
    """The set, rendered by whichever test comes first."""
    return make_tiny(folder)


def channels(path: Path) -> NDArray[np.floating]:
    """Read one channel as `(height, width)` or three as `(height, width, 3)`."""
    return read_channels(path).squeeze()


def test_every_image_comes_with_its_truth(tiny: StimulusSet) -> None:
    assert tiny.objects == {1: "pebble", 2: "heart", 3: "creature", 4: "rugged"}
    for stimulus in tiny.stimuli:
        truth = {name: channels(tiny.folder / file) for name, file in stimulus.truth.items()}
        assert set(truth) == {
            "radiance", "distance", "relief", "normal", "back_relief", "back_normal",
            "irradiance", "back_irradiance",
        }  # fmt: skip
        assert stimulus.regions is not None
        inside = read_labels(tiny.folder / stimulus.regions) == 2
        assert 0.2 < inside.mean() < 0.8
        assert (np.isfinite(truth["distance"]) == inside).all()
        assert (np.isnan(truth["back_relief"]) == ~inside).all()
        assert (truth["relief"] >= truth["back_relief"])[inside].all()
        assert_allclose(np.linalg.norm(truth["normal"][inside], axis=-1), 1, rtol=1e-5)
        assert (truth["back_normal"][inside, 2] < 0.05).all()
        brighter = truth["irradiance"].sum() > truth["back_irradiance"].sum()
        assert brighter == (stimulus.factors["light"] == "front")
        assert stimulus.details["noise_rms_of_255"] <= 1
        assert [Light(**light) for light in stimulus.details["lights"]] == [
            LIGHTS[str(stimulus.factors["light"])]
        ]


def test_picture_is_the_radiance_as_shown(tiny: StimulusSet) -> None:
    # Another file of the same image: encoded radiance times exposure, inside the object.
    for stimulus in tiny.stimuli:
        radiance = channels(tiny.folder / stimulus.truth["radiance"])
        shown = read_image(tiny.folder / stimulus.file)
        inside = np.isfinite(channels(tiny.folder / stimulus.truth["relief"]))
        whole = inside.copy()
        for axis, step in ((0, 1), (0, -1), (1, 1), (1, -1)):
            whole &= np.roll(inside, step, axis)
        expected = np.clip(radiance * tiny.exposure, 0, 1)
        assert_allclose(shown[whole], expected[whole], atol=0.006)


def test_profiles_are_on_the_objects_own_scale(tiny: StimulusSet) -> None:
    # Theory: in widths of the object R_d grows by the square of the width, so that its integral
    # over the plane, the albedo, stays.
    sizes = {profile["radius_mm"]: profile for profile in tiny.details["profiles"]}
    assert set(sizes) == {RADIUS_MM, 2.5}
    for profile in tiny.details["profiles"]:
        assert profile["width_mm"] == pytest.approx(1.75 * profile["radius_mm"], rel=0.1)
        medium = MEASURED[profile["medium"]]
        distances = np.array(profile["distance_widths"])
        expected = Dipole.of(medium)(distances * profile["width_mm"]) * profile["width_mm"] ** 2
        assert_allclose(profile["reflectance"], expected)
        assert distances[[0, -1]].tolist() == [0, 1]
    assert tiny.details["media"]["marble"]["refractive_index"] == 1.5


def test_same_recipe_same_bytes_even_if_interrupted(
    make_tiny: Callable[..., StimulusSet], tiny: StimulusSet, tmp_path: Path
) -> None:
    def stop(done: int, _total: int) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make_tiny(tmp_path / "part", progress=stop)
    assert not (tmp_path / "part" / "manifest.json").exists()
    assert make_tiny(tmp_path / "part").files == tiny.files


@pytest.mark.usefixtures("llvm")
def test_refuses_what_it_cannot_make(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="seed: -1 given, 0 or more accepted"):
        translucency.make(tmp_path, seed=-1)
    with pytest.raises(UnavailableError, match="translucent objects need llvm or cuda"):
        translucency.make(tmp_path / "scalar", seed=1, quick=True, engine="scalar")
