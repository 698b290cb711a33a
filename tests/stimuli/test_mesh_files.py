from collections.abc import Callable
from pathlib import Path

import mitsuba as mi
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from algorithms.errors import InputError
from stimuli.shapes import mesh_files, polygons
from stimuli.shapes.displaced_spheres import AbstractShape
from stimuli.shapes.mesh import Mesh, require_closed, to_mitsuba
from stimuli.shapes.mesh_files import read_mesh
from stimuli.shapes.superquadric import superquadric

SHAPE = AbstractShape(np.random.default_rng(8)).mesh(16, 32)
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]

HEADER = """ply
format {order} 1.0
comment made by a test
element vertex {vertices}
property double x
property double y
property double z
{normals}element face {faces}
property list uchar int {corners}
end_header
"""
NORMALS = "property float nx\nproperty float ny\nproperty float nz\n"


def ply_text(mesh: Mesh, corners: str = "vertex_indices") -> bytes:
    """Return a mesh with its normals as an ascii PLY file."""
    header = HEADER.format(
        order="ascii", vertices=len(mesh.vertices), faces=len(mesh.faces), normals=NORMALS,
        corners=corners,
    )  # fmt: skip
    rows = np.column_stack([mesh.vertices, mesh.normals])
    lines = [" ".join(repr(float(value)) for value in row) for row in rows]
    lines += [f"3 {a} {b} {c}" for a, b, c in mesh.faces]
    return (header + "\n".join(lines)).encode()


def ply_binary(vertices: np.ndarray, faces: list[list[int]], order: str) -> bytes:
    """Return polygons as a binary PLY file without normals."""
    name = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    header = HEADER.format(
        order=name, vertices=len(vertices), faces=len(faces), normals="", corners="vertex_index"
    )
    body = vertices.astype(order + "f8").tobytes()
    for face in faces:
        body += bytes([len(face)]) + np.array(face).astype(order + "i4").tobytes()
    return header.encode() + body


def obj_text(mesh: Mesh) -> str:
    """Return a mesh with its texture coordinates and normals as an OBJ file."""
    assert mesh.texture_coordinates is not None
    lines = ["# a test's", "mtllib none.mtl", "o thing"]
    lines += ["v {!r} {!r} {!r}".format(*map(float, row)) for row in mesh.vertices]
    lines += [f"vt {float(u)!r} {float(1 - v)!r}" for u, v in mesh.texture_coordinates]
    lines += ["vn {!r} {!r} {!r}".format(*map(float, row)) for row in mesh.normals]
    lines += ["f " + " ".join(f"{i + 1}/{i + 1}/{i + 1}" for i in face) for face in mesh.faces]
    return "\n".join(lines)


def written(folder: Path, name: str, content: bytes | str) -> Path:
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_reads_back_text(tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path, "a.ply", ply_text(SHAPE)))
    assert_array_equal(mesh.vertices[mesh.faces], SHAPE.vertices[SHAPE.faces])
    assert_allclose(mesh.normals[mesh.faces], SHAPE.normals[SHAPE.faces], atol=1e-12)
    assert mesh.texture_coordinates is None
    # A globe's map has a vertex at either pole that no face uses.
    assert len(mesh.vertices) == len(SHAPE.vertices) - 2


@pytest.mark.parametrize("order", ["<", ">"])
def test_reads_back_binary_polygons(tmp_path: Path, order: str) -> None:
    # Theory: a cube has volume 8; at its corners smooth normals point along the diagonals.
    mesh = read_mesh(written(tmp_path, "cube.PLY", ply_binary(CUBE, SIDES, order)))
    require_closed(mesh, "cube")
    assert len(mesh.faces) == 12
    assert_allclose(mesh.volume, 8)
    assert_allclose(mesh.normals, mesh.vertices / np.sqrt(3))


def test_reads_back_polygons_of_many_lengths(tmp_path: Path) -> None:
    faces = [SIDES[0][:3], [SIDES[0][0], SIDES[0][2], SIDES[0][3]], *SIDES[1:]]
    mesh = read_mesh(written(tmp_path, "cube.ply", ply_binary(CUBE, faces, "<")))
    require_closed(mesh, "cube")
    assert_allclose(mesh.volume, 8)
    assert_allclose(mesh.normals, mesh.vertices / np.sqrt(3))


def test_reads_back_obj(tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path, "a.obj", obj_text(SHAPE)))
    assert SHAPE.texture_coordinates is not None
    assert mesh.texture_coordinates is not None
    # Vertices may stand in another order, but each face has the same corners.
    for name in ("vertices", "normals", "texture_coordinates"):
        was, now = getattr(SHAPE, name)[SHAPE.faces], getattr(mesh, name)[mesh.faces]
        assert_allclose(now, was, atol=1e-12)
    require_closed(mesh, "shape")


def test_obj_counts_from_behind_and_may_lack_parts(tmp_path: Path) -> None:
    lines = ["v 0 0 0 1.0", "v 1 0 0", "v 0 1 0", "vn 0 0 1", "f -3//1 -2//1 -1//1", "s off"]
    lines += ["v 0 0 1", "f 1//1 2//-1 \\", " 4//1"]
    mesh = read_mesh(written(tmp_path, "a.obj", "\r\n".join(lines).replace("\\\r", "\\")))
    assert mesh.texture_coordinates is None
    assert_array_equal(mesh.vertices[mesh.faces[0]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    assert_array_equal(mesh.vertices[mesh.faces[1]], [[0, 0, 0], [1, 0, 0], [0, 0, 1]])
    assert_allclose(mesh.normals, np.broadcast_to([0, 0, 1], (4, 3)))


@pytest.mark.usefixtures("engine")
def test_agrees_with_mitsuba_in_both_directions(tmp_path: Path) -> None:
    # Another implementation: its writer of PLY, its reader of OBJ.
    path = tmp_path / "out.ply"
    to_mitsuba(SHAPE, {"type": "diffuse"}, "s").write_ply(str(path))
    mesh = read_mesh(path)
    assert_allclose(mesh.vertices[mesh.faces], SHAPE.vertices[SHAPE.faces], atol=1e-6)
    assert_allclose(mesh.normals[mesh.faces], SHAPE.normals[SHAPE.faces], atol=1e-6)
    obj = written(tmp_path, "a.obj", obj_text(SHAPE))
    ours, theirs = read_mesh(obj), mi.load_dict({"type": "obj", "filename": str(obj)})
    parameters = mi.traverse(theirs)
    corners = np.array(parameters["faces"]).reshape(-1, 3)
    assert ours.texture_coordinates is not None
    for key, values in (
        ("vertex_positions", ours.vertices),
        ("vertex_normals", ours.normals),
        ("vertex_texcoords", ours.texture_coordinates),
    ):
        table = np.array(parameters[key]).reshape(-1, values.shape[1])
        assert_allclose(values[ours.faces], table[corners], atol=1e-6)


def test_normals_are_weighted_by_angle_across_seams(tmp_path: Path) -> None:
    # Theory: on a sphere of uneven triangles they come close to the surface's own; the seam's and
    # the poles' vertices agree with their doubles.
    ball = superquadric((1, 1), rows=24, columns=48)
    mesh = read_mesh(
        written(tmp_path, "a.ply", ply_binary(ball.vertices, ball.faces.tolist(), "<"))
    )
    cosines = np.einsum("ij,ij->i", mesh.normals, mesh.vertices)
    assert np.degrees(np.arccos(np.clip(cosines, -1, 1)).max()) < 0.5
    assert_allclose(mesh.normals[mesh.vertices[:, 1] == 1], [[0, 1, 0]] * 48, atol=1e-9)


def test_what_is_inside_out_is_turned(tmp_path: Path) -> None:
    sides = [side[::-1] for side in SIDES]
    mesh = read_mesh(written(tmp_path, "a.ply", ply_binary(CUBE, sides, "<")))
    require_closed(mesh, "cube")
    assert_allclose(mesh.normals, mesh.vertices / np.sqrt(3))


def test_normals_on_the_wrong_side_are_turned(tmp_path: Path) -> None:
    wrong = Mesh(SHAPE.vertices, -SHAPE.normals, None, SHAPE.faces)
    mesh = read_mesh(written(tmp_path, "a.ply", ply_text(wrong)))
    assert_allclose(mesh.normals[mesh.faces], SHAPE.normals[SHAPE.faces], atol=1e-12)


def test_normals_that_say_nothing_are_computed(tmp_path: Path) -> None:
    normals = SHAPE.normals.copy()
    normals[100:110] = 0
    normals[200] = np.nan
    mesh = read_mesh(
        written(tmp_path, "a.ply", ply_text(Mesh(SHAPE.vertices, normals, None, SHAPE.faces)))
    )
    assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1)
    corners, expected = mesh.normals[mesh.faces], SHAPE.normals[SHAPE.faces]
    assert np.einsum("ijk,ijk->ij", corners, expected).min() > 0.98


def test_glass_needs_a_closed_mesh(tmp_path: Path) -> None:
    mesh = read_mesh(written(tmp_path, "a.ply", ply_binary(CUBE, SIDES[:5], "<")))
    with pytest.raises(InputError, match=r"^glass: a closed surface is accepted; 4 of 30 edges"):
        require_closed(mesh, "glass")


def changed(old: str, new: str) -> bytes:
    text = ply_text(SHAPE).decode()
    assert old in text
    return text.replace(old, new, 1).encode()


FIRST = f"0.0 {float(SHAPE.vertices[0, 1])!r} 0.0 "
BAD_PLY = {
    "empty": (b"", "not a PLY file"),
    "another format": (b"\x89PNG\r\n\x1a\n" + bytes(100), "not a PLY file"),
    "no end": (ply_text(SHAPE)[:200], "not a PLY file"),
    "unknown order": (changed("ascii", "big_endian"), "header's line 'format big_endian"),
    "unknown type": (changed("double x", "quad x"), "header's line 'property quad x'"),
    "negative count": (changed("vertex 561", "vertex -561"), "header's line 'element vertex -561'"),
    "too many": (changed("vertex 561", "vertex 5000001"), "vertex: at most 5000000"),
    "far too many": (changed("face 960", "face 99999999999999999999"), "face: at most 5000000"),
    "more than there are": (changed("face 960", "face 961"), "shorter than its header says"),
    "no vertices": (changed("element vertex", "element corner"), "vertex element"),
    "no faces": (changed("element face", "element side"), "face element"),
    "faces without corners": (changed("vertex_indices", "colours"), "face element"),
    "not a number": (changed(FIRST, "0.0 high 0.0 "), "not the numbers"),
    "not finite": (changed(FIRST, "0.0 inf 0.0 "), "vertices: finite positions"),
    "not known": (changed(FIRST, "0.0 nan 0.0 "), "vertices: finite positions"),
    "out of range": (changed("3 0 33 34", "3 0 33 561"), "faces: indices of the 561"),
    "negative index": (changed("3 0 33 34", "3 0 33 -1"), "faces: indices of the 561"),
    "part of an index": (changed("3 0 33 34", "3 0 33 34.5"), "faces: indices of the 561"),
    "two corners": (changed("3 0 33 34", "2 0 33"), "faces: three or more corners"),
    "negative length": (changed("3 0 33 34", "-3 0 33 34"), "lists: lengths of 0 or more"),
    "endless length": (changed("3 0 33 34", "4e18 0 33 34"), "shorter than its header says"),
    "infinite length": (changed("3 0 33 34", "inf 0 33 34"), "not the numbers"),
    "no face at all": (ply_binary(CUBE, [], "<"), "faces: one or more"),
    "no area": (ply_binary(CUBE, [[0, 1, 1], [0, 0, 2]], "<"), "faces: some with an area"),
    "a line": (ply_binary(CUBE * [1, 0, 0], [[0, 4, 7]], "<"), "faces: some with an area"),
    "cut": (ply_binary(CUBE, SIDES, "<")[:-3], "shorter than its header says"),
}  # fmt: skip
BAD_OBJ = {
    "empty": (b"", "one or more are accepted; there are none"),
    "another format": (bytes(range(256)) * 10, "one or more are accepted; there are none"),
    "no faces": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "one or more are accepted; there are none"),
    "not a number": (b"v 0 0 0\nv 1 zero 0\n", "line 2: damaged"),
    "too short": (b"v 0 0 0\nv 1 0\n", "line 2: damaged"),
    "not finite": (b"v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "vertices: finite positions"),
    "out of range": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "faces: indices of vertices above"),
    "from 0": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "faces: indices of vertices above"),
    "too far behind": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "indices of vertices above"),
    "no such normal": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n", "indices of vertices"),
    "two corners": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "three or more corners"),
    "not an index": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n", "line 4: damaged"),
    "four parts": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1/1 2 3\n", "line 4: damaged"),
    "a line": (b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "faces: some with an area"),
}


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        pytest.param(f"bad{suffix}", content, message, id=f"{suffix[1:]}: {case}")
        for suffix, cases in ((".ply", BAD_PLY), (".obj", BAD_OBJ))
        for case, (content, message) in cases.items()
    ],
)
def test_bad_files_are_refused_in_one_line(
    tmp_path: Path, name: str, content: bytes, message: str
) -> None:
    path = written(tmp_path, name, content)
    with pytest.raises(InputError) as caught:
        read_mesh(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert message in text
    assert "\n" not in text


def test_refuses_what_cannot_be_a_mesh_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match=r"none\.ply: cannot be read \(No such file"):
        read_mesh(tmp_path / "none.ply")
    with pytest.raises(InputError, match=r"a mesh file ending in \.ply or \.obj is accepted"):
        read_mesh(tmp_path / "mesh.stl")
    (tmp_path / "folder.ply").mkdir()
    with pytest.raises(InputError, match="cannot be read"):
        read_mesh(tmp_path / "folder.ply")
    monkeypatch.setattr(mesh_files, "MAX_BYTES", 1000)
    with pytest.raises(InputError, match="at most"):
        read_mesh(written(tmp_path, "big.ply", ply_text(SHAPE)))


def test_refuses_too_many_faces_before_the_last(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(polygons, "MAX_FACES", 900)
    with pytest.raises(InputError, match="faces: at most 900 are accepted, not 901"):
        read_mesh(written(tmp_path, "big.obj", obj_text(SHAPE)))


@pytest.mark.parametrize(
    ("name", "make"), [("a.ply", ply_text), ("a.obj", lambda mesh: obj_text(mesh).encode())]
)
@settings(
    max_examples=60,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(place=st.floats(0, 1), patch=st.binary(max_size=8), cut=st.booleans())
def test_damage_is_refused_or_harmless(
    tmp_path: Path,
    name: str,
    make: Callable[[Mesh], bytes],
    place: float,
    patch: bytes,
    cut: bool,
) -> None:
    # Property: whatever the bytes, a sound mesh comes out or one line; nothing else is raised.
    content = make(superquadric((1, 1), rows=4, columns=8))
    at = int(place * len(content))
    damaged = content[:at] + patch + (b"" if cut else content[at + len(patch) :])
    try:
        mesh = read_mesh(written(tmp_path, name, damaged))
    except InputError as error:
        assert "\n" not in str(error)  # noqa: PT017
    else:
        assert np.isfinite(mesh.vertices).all()
        assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1)
