from dataclasses import replace

import mitsuba as mi
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.spatial.transform import Rotation

from stimuli.engine import Engine
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import Mesh, to_mitsuba
from tests.stimuli.bodies import UnitSphere

MATT = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}}
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def tetrahedron(faces: np.ndarray = FACES) -> Mesh:
    """Return a corner of the unit cube, its normals pointing from its centre."""
    normals = CORNERS - 0.25
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(CORNERS, normals, None, faces)


def soup(mesh: Mesh) -> Mesh:
    """Return the mesh with vertices of its own for every corner of every face."""
    corners = mesh.faces.reshape(-1)
    apart = np.arange(len(corners)).reshape(-1, 3)
    return replace(
        mesh, vertices=mesh.vertices[corners], normals=mesh.normals[corners], faces=apart
    )


def test_closed_is_what_has_an_inside() -> None:
    # Definition: two faces at every edge, of like orientation; whatever else is open.
    assert tetrahedron().is_closed
    assert soup(tetrahedron()).is_closed
    assert not tetrahedron(FACES[:3]).is_closed
    assert not tetrahedron(np.vstack([FACES[:3], FACES[3:, ::-1]])).is_closed
    assert not tetrahedron(np.vstack([FACES, FACES[:1]])).is_closed
    assert not tetrahedron(FACES[:0]).is_closed


def test_faces_without_area_do_not_open_a_mesh() -> None:
    sphere = UnitSphere().mesh(8, 16)
    sliver = replace(sphere, faces=np.vstack([sphere.faces, [[0, 1, 20]]]))
    assert sphere.is_closed  # its poles and its seam stand many times
    assert sliver.is_closed


def test_seams_close_after_any_movement() -> None:
    # Property: rounding in a rotation does not tear a seam open.
    mesh = AbstractShape(np.random.default_rng(3)).mesh(32, 64)
    generator = np.random.default_rng(4)
    for rotation in Rotation.random(20, random_state=generator).as_matrix():
        turned = mesh.rotated(rotation).moved(
            generator.normal(size=3), scale=generator.uniform(0.5, 2)
        )
        assert turned.is_closed


def test_volume_of_a_tetrahedron() -> None:
    # Theory: a sixth; turned inside out, its negative; wherever it stands.
    assert_allclose(tetrahedron().volume, 1 / 6)
    assert_allclose(tetrahedron(FACES[:, ::-1]).volume, -1 / 6)
    assert_allclose(tetrahedron().moved(np.array([5.0, -3, 2]), scale=2).volume, 8 / 6)


def test_moved_and_rotated() -> None:
    mesh = tetrahedron()
    moved = mesh.moved(np.array([1.0, 2.0, 3.0]), scale=0.5)
    assert_allclose(moved.vertices, mesh.vertices / 2 + [1, 2, 3])
    assert_array_equal(moved.normals, mesh.normals)
    quarter = Rotation.from_euler("z", 90, degrees=True).as_matrix()
    turned = mesh.rotated(quarter)
    assert_allclose(turned.vertices[1], [0, 1, 0], atol=1e-15)
    assert_allclose(turned.normals, mesh.normals @ quarter.T)


def test_fitted_is_centred_and_of_radius_one() -> None:
    fitted = tetrahedron().moved(np.array([7.0, 8, 9]), scale=3).fitted()
    assert_allclose(fitted.bounding_radius, 1)
    assert_allclose(fitted.vertices.min(axis=0), -fitted.vertices.max(axis=0))


@pytest.mark.parametrize("textured", [True, False])
@pytest.mark.usefixtures("engine")
def test_mitsuba_gets_every_number(textured: bool) -> None:
    sphere = UnitSphere().mesh(8, 16)
    mesh = sphere if textured else replace(sphere, texture_coordinates=None)
    shape = to_mitsuba(mesh, MATT, "ball")
    parameters = mi.traverse(shape)
    assert shape.id() == "ball"
    assert shape.has_vertex_texcoords() == textured
    for key, values in {"vertex_positions": mesh.vertices, "vertex_normals": mesh.normals}.items():
        assert_allclose(np.array(parameters[key]).reshape(-1, 3), values, atol=1e-6)
    assert_array_equal(np.array(parameters["faces"]).reshape(-1, 3), mesh.faces)


@pytest.mark.usefixtures("engine")
def test_mitsuba_gets_what_is_inside_or_shines() -> None:
    sphere = UnitSphere().mesh(8, 16)
    medium = {"type": "homogeneous", "sigma_t": 2.0}
    glass = to_mitsuba(sphere, {"type": "dielectric"}, "glass", interior=medium)
    assert glass.interior_medium() is not None
    lamp = to_mitsuba(sphere, mi.load_dict(MATT), "lamp", emitter={"type": "area"})
    assert lamp.is_emitter()


def test_mitsuba_interpolates_normals(engine: Engine) -> None:
    # Theory: a coarse sphere with smooth normals has the normals of a sphere.
    scene = mi.load_dict({"type": "scene", "s": to_mitsuba(UnitSphere().mesh(24, 48), MATT, "s")})
    for x in (0.1, 0.37, 0.6):
        hit = scene.ray_intersect(mi.Ray3f(mi.Point3f(x, 0.2, 5), mi.Vector3f(0, 0, -1)))
        expected = np.array([x, 0.2, np.sqrt(1 - x**2 - 0.04)])
        normal = np.array(hit.sh_frame.n).reshape(3)
        assert_allclose(normal, expected, atol=0.01, err_msg=engine)
