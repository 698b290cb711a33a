"""Cameras: where points appear, and in whose frame lights are told."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from algorithms.errors import InputError
from algorithms.light import Light
from stimuli.camera import Perspective, camera_of, light_in_frame, light_in_scene
from stimuli.engine import Engine

CAMERA = Perspective((1.0, 4.0, 8.0), (0.0, 1.0, 0.0), 40.0, 64, 48)
COORDINATE = st.floats(-9, 9)


def test_frame_is_right_up_and_towards_the_viewer() -> None:
    # Theory: a camera on the z axis that looks at the origin shares the scene's frame.
    assert_allclose(Perspective((0, 0, 5), (0, 0, 0), 40, 64, 48).axes, np.eye(3), atol=1e-12)
    assert_allclose(CAMERA.axes @ CAMERA.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(CAMERA.axes) == pytest.approx(1)
    assert CAMERA.axes[2] @ np.subtract(CAMERA.position, CAMERA.target) > 0


def test_points_appear_where_the_pinhole_puts_them() -> None:
    # Theory: the target in the middle; what lies half the field of view to the right, on the edge.
    right, up, _ = CAMERA.axes
    away = float(np.linalg.norm(np.subtract(CAMERA.position, CAMERA.target)))
    edge = np.tan(np.radians(20)) * away
    points = np.array(CAMERA.target) + np.stack([0 * right, edge * right, edge * up * 48 / 64])
    assert_allclose(CAMERA.project(points), [(32, 24), (64, 24), (32, 0)], atol=1e-9)
    assert_allclose(CAMERA.depth(points), away)
    assert_allclose(CAMERA.distance(points)[1], away / np.cos(np.radians(20)))
    assert CAMERA.pixels_per_unit(away) == pytest.approx(32 / edge)


def test_project_agrees_with_mitsuba(engine: Engine) -> None:  # noqa: ARG001  # sets the variant
    # Another implementation: Mitsuba's own projection of a point onto the film.
    import mitsuba as mi

    point = np.array([0.7, 1.9, -2.0])
    scene = mi.load_dict({"type": "scene", "at": {"type": "sphere"}})
    hit = mi.SurfaceInteraction3f()
    hit.p = mi.Point3f(point.tolist())
    sample, _ = CAMERA.sensor().sample_direction(hit, mi.Point2f(0.5, 0.5))
    assert scene.shapes()
    assert_allclose(np.ravel(sample.uv), CAMERA.project(point), rtol=1e-4)


def test_camera_of_a_scene(engine: Engine) -> None:  # noqa: ARG001
    # Recovery: the camera of a scene that was written with a known one.
    import mitsuba as mi

    scene = mi.load_dict({"type": "scene", "camera": CAMERA.sensor()})
    found = camera_of(scene)
    assert_allclose(found.axes, CAMERA.axes, atol=1e-6)
    assert_allclose(found.position, CAMERA.position, atol=1e-6)
    assert found.field_of_view_deg == pytest.approx(40)
    assert (found.width_px, found.height_px) == (64, 48)
    with pytest.raises(InputError, match="no `perspective` sensor"):
        camera_of(mi.load_dict({"type": "scene", "camera": {"type": "orthographic"}}))
    with pytest.raises(InputError, match="no `perspective` sensor"):
        camera_of(mi.load_dict({"type": "scene"}))


@given(st.floats(0, 359), st.floats(-89, 89), st.tuples(COORDINATE, COORDINATE, COORDINATE))
def test_light_returns_from_the_frame(
    azimuth_deg: float, elevation_deg: float, position: tuple[float, float, float]
) -> None:
    # Property: to the frame of the camera and back is the same light.
    if np.hypot(position[0], position[2]) < 1e-3:
        return
    camera = Perspective(position, (0, 0, 0), 30, 8, 8)
    light = Light(azimuth_deg, elevation_deg, 2.5)
    back = light_in_scene(light_in_frame(light, camera), camera)
    assert_allclose(back.direction, light.direction, atol=1e-9)
    assert back.intensity == light.intensity


def test_light_behind_the_camera_is_in_front_of_the_object() -> None:
    behind = Light.from_direction(np.subtract(CAMERA.position, CAMERA.target))
    assert light_in_frame(behind, CAMERA).elevation_deg == pytest.approx(90, abs=1e-4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"field_of_view_deg": 180.0}, "field_of_view_deg: 180.0 given"),
        ({"field_of_view_deg": 0.0}, "field_of_view_deg: 0.0 given"),
        ({"width_px": 0}, "width_px, height_px: 1 or more"),
        ({"position": (0.0, 9.0, 0.0)}, "target: a point that is not straight above or below"),
        ({"position": (0.0, 1.0, 0.0)}, "target: a point that is not"),
    ],
)
def test_impossible_cameras_are_refused(change: dict[str, object], message: str) -> None:
    arguments: dict[str, object] = {
        "position": (1.0, 4.0, 8.0),
        "target": (0.0, 1.0, 0.0),
        "field_of_view_deg": 40.0,
        "width_px": 64,
        "height_px": 48,
    }
    with pytest.raises(InputError, match=message):
        Perspective(**{**arguments, **change})  # type: ignore[arg-type]
