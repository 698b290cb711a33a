"""The caustics set: its design, what its methods add to each other, and where light may go."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import ndimage

from algorithms.errors import InputError, UnavailableError
from algorithms.images import read_channels, read_labels
from algorithms.light import Light
from stimuli.engine import Engine
from stimuli.manifest import StimulusSet
from stimuli.scenes.caustic_scene import FIGURES, camera, key_in_frame, key_light, map_corners
from stimuli.sets import caustics
from stimuli.shapes.implicit import surface_of
from stimuli.truth import TRUTH_NAMES

TINY = caustics.Size(64, 64, 16, 60_000, 16)


def make_tiny(folder: Path, *shapes: str) -> StimulusSet:
    """Make the quick set of some objects with the real code, coarse and in tiny pictures."""
    images = [image for image in caustics.design(quick=True) if image.shape in shapes]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(caustics, "design", lambda *, quick: tuple(images))  # noqa: ARG005
        patch.setattr(caustics, "QUICK", TINY)
        patch.setattr(
            "stimuli.shapes.figures.surface_of",
            lambda field, cells, reach=1.05: surface_of(field, cells // 2, reach),
        )
        patch.setattr(caustics, "_SMALL", caustics.Size(48, 4, 4, 20_000, 4))
        return caustics.make(folder, seed=3, quick=True, engine="llvm")


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    return make_tiny(tmp_path_factory.mktemp("caustics"), "doll", "vertebra")


@pytest.fixture(autouse=True)
def _needs_llvm(llvm: Engine) -> None:
    """Photons need the engine with kernels."""


def cells(made: StimulusSet) -> Mapping[tuple[str, int], Mapping[str, Any]]:
    """Return the stimuli of each object and light by method."""
    found: dict[tuple[str, int], dict[str, Any]] = {}
    for stimulus in made.stimuli:
        cell = str(stimulus.factors["object"]), int(stimulus.factors["light_deg"])
        found.setdefault(cell, {})[str(stimulus.factors["method"])] = stimulus
    return found


def radiance(made: StimulusSet, stimulus: Any) -> NDArray[np.float32]:  # noqa: ANN401
    return read_channels(made.path(stimulus.truth["radiance"]))


def test_full_design_crosses_objects_lights_and_methods() -> None:
    # Published: four objects, four lights; each seen by every method (sec. 7.5.1).
    images = caustics.design(quick=False)
    main = [image for image in images if image.role == "main"]
    assert len(main) == 4 * 4 * len(caustics.COMPARED)
    assert {image.light_deg for image in main} == {0, 60, 120, 180}
    assert len({image.shape for image in main}) == 4
    assert len({(image.shape, image.light_deg, image.method) for image in images}) == len(images)
    examples = {image.method for image in images if image.role == "example"}
    assert examples == set(caustics.METHODS)


def test_lights_turn_around_the_vertical_axis_from_the_camera() -> None:
    view = camera(640)
    for light_deg, side in ((0, "front"), (60, "right"), (120, "right"), (180, "behind")):
        # Of the scene: 0 is where the camera stands.
        x, _, z = key_light(light_deg).direction
        assert np.degrees(np.arctan2(x, z)) == pytest.approx(light_deg, abs=1e-6)
        seen = key_in_frame(light_deg, view).direction
        assert {"front": seen[2] > 0.5, "right": seen[0] > 0.3, "behind": seen[2] < 0}[side]


def test_every_image_has_its_truth_and_its_noise(tiny: StimulusSet) -> None:
    tiny.verify()
    numbers = {name: number for number, name in tiny.objects.items()}
    for stimulus in tiny.stimuli:
        assert set(TRUTH_NAMES) < set(stimulus.truth)
        assert {"radiance", "opaque", "transparent"} < set(stimulus.truth)
        labels = read_labels(tiny.path(str(stimulus.regions)))
        assert set(np.unique(labels)) == {0, numbers[str(stimulus.factors["object"])]}
        assert 0 < stimulus.details["noise_rms_of_255"] <= 1
        recorded = Light(**stimulus.details["light"])
        assert recorded == key_in_frame(int(stimulus.factors["light_deg"]), camera(64))


def test_methods_add_light_to_one_picture_and_take_none(tiny: StimulusSet) -> None:
    # Theory: caustics are light that is added to the glass without; what stands around is the same.
    for by_method in cells(tiny).values():
        without = radiance(tiny, by_method["no-caustics"])
        files = {by_method[name].truth["transparent"] for name in caustics.METHODS}
        assert files == {by_method["no-caustics"].truth["radiance"]}
        for method in caustics.COMPARED:
            added = radiance(tiny, by_method[method]) - without
            # Their own noise, and files in half precision.
            assert np.quantile(added, 0.001) > -0.1
            assert added.mean() > 0.002
            assert added.max() > 0.3


def test_two_methods_put_light_in_different_places(tiny: StimulusSet) -> None:
    for by_method in cells(tiny).values():
        first, second = (
            ndimage.uniform_filter(radiance(tiny, by_method[method]).mean(axis=-1), 5)
            for method in ("photon-mapped", "revolved")
        )
        assert np.abs(first - second).max() > 0.05


def test_map_goes_on_the_side_away_from_the_light_within_the_picture() -> None:
    view = camera(640)
    for light_deg in caustics.LIGHTS_DEG:
        corners = map_corners(light_deg)
        away = -key_light(light_deg).direction * [1, 0, 1]
        assert (corners @ away >= -1e-9).all()
        assert (corners[:, 1] == 0).all()
        # The map's lower edge lies at the object; its upper edge, given first, farther away.
        assert ((corners @ away)[:2] > 1).all()
        x, y = view.project(corners).T
        assert ((x > 0) & (x < 640) & (y > 0) & (y < 480)).all()
        # Clockwise in the picture as on the table, mirrored where the light is behind the object.
        area = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2
        assert abs(area) > 2000
        assert np.sign(area) == (-1 if light_deg > 90 else 1)


def test_quick_set_shows_every_kind_of_image() -> None:
    images = caustics.design(quick=True)
    assert {image.method for image in images} == set(caustics.METHODS)
    assert {image.role for image in images} == {"main", "practice", "example"}
    assert {image.shape for image in images} < set(FIGURES)


@pytest.mark.slow
def test_same_seed_same_bytes(tmp_path: Path) -> None:
    first, second = (make_tiny(tmp_path / name, "bull") for name in ("first", "second"))
    assert first.digest == second.digest


def test_bad_requests_are_refused_with_nothing_written(tmp_path: Path) -> None:
    with pytest.raises(UnavailableError, match="apt install libllvm19"):
        caustics.make(tmp_path / "a", seed=1, quick=True, engine="scalar")
    with pytest.raises(InputError, match="seed"):
        caustics.make(tmp_path / "b", seed=-1, quick=True)
    for name in ("a", "b"):
        assert not (tmp_path / name / "manifest.json").exists()
