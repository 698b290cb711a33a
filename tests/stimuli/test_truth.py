"""Ground truth of a perspective scene against geometry."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from numpy.typing import NDArray

from algorithms.errors import InputError
from algorithms.images import read_channels, read_labels
from stimuli.camera import Perspective
from stimuli.shapes.mesh import Value
from stimuli.truth import GroundTruth, ground_truth, regions_file, truth_files, write_truth

pytestmark = pytest.mark.usefixtures("engine")

CAMERA = Perspective((1.0, 4.0, 8.0), (0.0, 1.0, 0.0), 40.0, 96, 72)
CENTRE = np.array([0.0, 1.0, 0.0])
NUMBERS = {"ball": 7, "glass": 2}


def scene_of_balls(**others: dict[str, Any]) -> Value:
    """Return two unit balls on a ground, one of them of glass."""
    import mitsuba as mi

    flat = mi.ScalarTransform4f().rotate([1, 0, 0], -90) @ mi.ScalarTransform4f().scale(50)
    red = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.6, 0.2, 0.1]}}
    balls = {
        "ball": {"type": "sphere", "center": CENTRE.tolist(), "bsdf": red},
        "glass": {"type": "sphere", "center": [2, 1, 0], "bsdf": {"type": "dielectric"}},
        "ground": {"type": "rectangle", "to_world": flat},
    }
    return mi.load_dict({"type": "scene", **balls, **others})


@pytest.fixture
def truth() -> GroundTruth:
    """The ground truth of the two balls."""
    return ground_truth(scene_of_balls(), CAMERA, NUMBERS)


def rays() -> NDArray[np.float64]:
    """Return the unit directions through the pixels' centres `(height, width, 3)`."""
    rows, columns = np.mgrid[: CAMERA.height_px, : CAMERA.width_px] + 0.5
    x = (columns - CAMERA.width_px / 2) / CAMERA.focal_length_px
    y = (CAMERA.height_px / 2 - rows) / CAMERA.focal_length_px
    directions = np.stack([x, y, -np.ones_like(x)], axis=-1) @ CAMERA.axes
    return np.asarray(directions / np.linalg.norm(directions, axis=-1, keepdims=True))


def ball_distance(centre: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where each pixel's ray first meets a unit ball; infinite where it does not."""
    towards = centre - np.array(CAMERA.position)
    along = rays() @ towards
    inside = along**2 - towards @ towards + 1
    return np.where(inside > 0, along - np.sqrt(np.maximum(inside, 0)), np.inf)


def test_distance_and_regions(truth: GroundTruth) -> None:
    # Theory: the first crossing of a ray with a ball or the ground.
    down = rays()[..., 1]
    ground = np.where(down < 0, -CAMERA.position[1] / np.minimum(down, -1e-9), np.inf)
    balls = np.stack([ball_distance(CENTRE), ball_distance(np.array([2.0, 1.0, 0.0]))])
    expected = np.minimum(ground, balls.min(axis=0))
    assert_allclose(truth.distance, expected, rtol=1e-4)
    labels = np.where(balls.min(axis=0) < ground, np.array([7, 2])[balls.argmin(axis=0)], 0)
    assert (truth.regions == labels).mean() > 0.999
    assert set(np.unique(truth.regions)) == {0, 2, 7}


def test_normals_are_in_the_frame_of_the_camera(truth: GroundTruth) -> None:
    points = np.array(CAMERA.position) + rays() * truth.distance[..., None].astype(np.float64)
    ball = truth.regions == 7
    expected = (points[ball] - CENTRE) @ CAMERA.axes.T
    assert_allclose(truth.normal[ball], expected, atol=2e-3)
    # Seen in perspective, all that is visible faces the eye.
    assert (np.sum((rays()[ball] @ CAMERA.axes.T) * truth.normal[ball], axis=-1) < 0.02).all()
    assert_allclose(truth.albedo[ball], np.tile([0.6, 0.2, 0.1], (ball.sum(), 1)), rtol=1e-5)


def test_relief_is_in_pixels_and_larger_when_nearer(truth: GroundTruth) -> None:
    ball = truth.regions == 7
    points = np.array(CAMERA.position) + rays() * truth.distance[..., None].astype(np.float64)
    depth = CAMERA.depth(points[ball])
    scale = CAMERA.focal_length_px / depth.mean()
    assert_allclose(truth.relief[ball], (depth.max() - depth) * scale, atol=0.02)
    assert np.nanmin(truth.relief) == 0
    assert np.isnan(truth.relief[truth.regions == 0]).all()


def test_hidden_objects_and_unknown_shapes_are_refused() -> None:
    hidden = scene_of_balls(behind={"type": "sphere", "center": [0, 1, 0], "radius": 0.5})
    with pytest.raises(InputError, match="objects: 'behind' lies outside the view or is hidden"):
        ground_truth(hidden, CAMERA, {"behind": 1})
    away = scene_of_balls(far={"type": "sphere", "center": [0, 1, 90]})
    with pytest.raises(InputError, match="objects: 'far' lies outside the view"):
        ground_truth(away, CAMERA, {"far": 1})
    with pytest.raises(InputError, match="objects: shape 'bull' is not in the scene"):
        ground_truth(scene_of_balls(), CAMERA, {"bull": 1})


def test_truth_is_written_once_and_read_back(tmp_path: Path, truth: GroundTruth) -> None:
    write_truth(tmp_path, "balls", lambda: truth)
    assert (read_labels(tmp_path / regions_file("balls")) == truth.regions).all()
    for name, file in truth_files("balls").items():
        read = np.squeeze(read_channels(tmp_path / file))
        assert_allclose(read, np.squeeze(getattr(truth, name)))

    def fail() -> GroundTruth:
        raise AssertionError("measured again")

    write_truth(tmp_path, "balls", fail)
