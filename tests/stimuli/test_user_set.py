"""Sets of one's own, from Mitsuba dictionaries and XML files, and what is refused."""

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import trompe
from algorithms.color import encode_srgb, luminance
from algorithms.errors import InputError
from algorithms.images import read_channels, read_image, read_labels
from algorithms.light import Light, angle_between_deg
from stimuli import user_set
from stimuli.camera import Perspective
from stimuli.manifest import StimulusSet, load
from stimuli.sets import maker
from stimuli.user_set import SceneImage, make_scene_set

CAMERA = Perspective((0.0, 0.0, 6.0), (0.0, 0.0, 0.0), 30.0, 48, 32)
LIGHT = {"type": "directional", "direction": [0, 0, -1], "irradiance": {"type": "rgb", "value": 2}}
GUIDE = Path(__file__).parents[2] / "docs" / "own-stimuli.md"
XML = """<scene version="3.0.0">
  <sensor type="perspective">
    <float name="fov" value="30"/><string name="fov_axis" value="x"/>
    <transform name="to_world"><lookat origin="0,0,6" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm">
      <integer name="width" value="48"/><integer name="height" value="32"/>
    </film>
  </sensor>
  <emitter type="directional"><vector name="direction" x="0" y="0" z="-1"/></emitter>
  <shape type="sphere" id="ball"/>
</scene>
"""


def ball(albedo: float, **others: Any) -> SceneImage:  # noqa: ANN401
    """Return a ball of some albedo under a light from the viewer."""
    grey = {"type": "diffuse", "reflectance": {"type": "rgb", "value": albedo}}
    scene = {"type": "scene", "light": LIGHT, "ball": {"type": "sphere", "bsdf": grey}}
    given: dict[str, Any] = {
        "id": f"ball-{albedo:g}",
        "scene": scene,
        "factors": {"albedo": albedo},
        "camera": CAMERA,
        "objects": {"ball": 1},
        "answer": 1,
        "lights": [Light(0, 90, 2)],
    }
    return SceneImage(**given | others)


def test_set_of_dictionaries(tmp_path: Path) -> None:
    made = make_scene_set(tmp_path, "balls", [ball(0.2), ball(0.8)], seed=1)
    assert load(tmp_path).model_dump() == made.model_dump()
    made.verify()
    assert made.to_frame()["albedo"].tolist() == [0.2, 0.8]
    dark, bright = (
        read_channels(made.path(stimulus.truth["radiance"])) for stimulus in made.stimuli
    )
    middle = (slice(12, 20), slice(20, 28))
    # Theory: Lambert's law at the point that faces the light, and its albedo.
    assert_allclose(bright[middle].max(), 0.8 / np.pi * 2, rtol=0.02)
    assert_allclose(dark[middle].mean() / bright[middle].mean(), 0.25, rtol=0.01)
    for stimulus, radiance in zip(made.stimuli, (dark, bright), strict=True):
        shown = encode_srgb(read_image(made.path(stimulus.file)))[middle]
        assert_allclose(shown, encode_srgb(radiance[middle] * made.exposure), atol=0.6 / 255)
        assert 0 < stimulus.details["noise_rms_of_255"] <= 1
        assert stimulus.details["lights"] == [
            {"azimuth_deg": 0, "elevation_deg": 90, "intensity": 2, "distance": None}
        ]
        assert stimulus.regions is not None
        assert set(np.unique(read_labels(made.path(stimulus.regions)))) == {0, 1}
    assert 0 < made.details["clipped_share"] < 0.02  # of so few pixels


def test_set_of_an_xml_file_with_its_own_camera(tmp_path: Path) -> None:
    (tmp_path / "ball.xml").write_text(XML, encoding="utf-8")
    image = SceneImage("one", tmp_path / "ball.xml", {"n": 1}, objects={"ball": 1})
    made = make_scene_set(tmp_path / "set", "xml", [image], seed=1)
    distance = read_channels(made.path(made.stimuli[0].truth["distance"]))[..., 0]
    assert_allclose(distance.min(), 5, rtol=1e-3)
    # Another file under the same name is another set.
    (tmp_path / "ball.xml").write_text(XML.replace('"30"', '"31"'), encoding="utf-8")
    with pytest.raises(InputError, match="holds a set made with another parameters"):
        make_scene_set(tmp_path / "set", "xml", [image], seed=1)


class Interrupted(BaseException):
    """Ctrl-C."""


def test_interrupted_set_goes_on_with_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    images = [ball(albedo) for albedo in (0.2, 0.5, 0.8)]
    whole = make_scene_set(tmp_path / "whole", "balls", images, seed=1)
    made: list[str] = []

    def count(then: Callable[[user_set._Make, Path], Any], last: int) -> None:
        def make(self: user_set._Make, folder: Path) -> Any:  # noqa: ANN401
            if len(made) == last:
                raise Interrupted
            made.append(self.view.image.id)
            return then(self, folder)

        monkeypatch.setattr(user_set._Make, "__call__", make)

    real = user_set._Make.__call__
    count(real, 2)
    with pytest.raises(Interrupted):
        make_scene_set(tmp_path / "parts", "balls", images, seed=1)
    assert not (tmp_path / "parts" / "manifest.json").exists()
    (tmp_path / "parts" / "images" / "ball-0.5.png").unlink()  # lost: it is made again
    count(real, 99)
    resumed = make_scene_set(tmp_path / "parts", "balls", images, seed=1)
    assert made == ["ball-0.2", "ball-0.5", "ball-0.5", "ball-0.8"]
    assert resumed.digest == whole.digest
    make_scene_set(tmp_path / "parts", "balls", images, seed=1)
    assert len(made) == 4


def test_full_disk_leaves_no_half_written_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    images = [ball(0.2), ball(0.8)]
    opened: list[int] = []

    def fdopen(descriptor: int, mode: str) -> IO[bytes]:
        opened.append(descriptor)
        if len(opened) < 12:  # within the second image
            return open_descriptor(descriptor, mode)
        os.close(descriptor)
        return Path("/dev/full").open("wb")

    open_descriptor = os.fdopen
    with monkeypatch.context() as patch:
        patch.setattr(os, "fdopen", fdopen)
        with pytest.raises(InputError, match=r"cannot be written \(No space left on device\)"):
            make_scene_set(tmp_path, "balls", images, seed=1)
    left = {path.name for path in tmp_path.rglob("*") if path.is_file()}
    assert "ball-0.2.png" in left
    assert "ball-0.8.png" not in left
    assert "manifest.json" not in left
    assert not [name for name in left if name.startswith(".")]
    made: StimulusSet = make_scene_set(tmp_path, "balls", images, seed=1)
    made.verify()


@pytest.mark.parametrize(
    ("image", "message"),
    [
        ({"scene": {"type": "scene", "ball": {"type": "sphere"}}}, "'x': no light; one emitter"),
        ({"objects": {"cube": 1}}, "objects: shape 'cube' is not in the scene"),
        ({"scene": {"type": "sphere"}}, "'x': Mitsuba's 'scene' at the top is accepted"),
        ({"scene": {"type": "scene", "x": {"type": "cubus"}}}, "'x': Mitsuba cannot load it"),
        ({"scene": Path("missing.xml")}, "missing.xml: cannot be read"),
        ({"camera": None}, "camera: the scene has no `perspective` sensor, and none is given"),
        (
            {"camera": Perspective((0, 0, 6), (9, 0, 6), 30, 48, 32)},
            "images: one or more with light in them",
        ),
    ],
)
def test_scenes_that_cannot_be_rendered_are_refused(
    tmp_path: Path, image: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message) as caught:
        make_scene_set(tmp_path, "x", [ball(0.5, id="x", **image)], seed=1)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "manifest.json").exists()


def test_empty_sets_and_negative_seeds_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="images: one or more are accepted"):
        make_scene_set(tmp_path, "x", [], seed=1)
    with pytest.raises(InputError, match="seed: -1 given, 0 or more accepted"):
        make_scene_set(tmp_path, "x", [ball(0.5)], seed=-1)


def test_the_set_of_the_guide_is_made_by_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)
    own = tmp_path / "ball.py"
    own.write_text(code, encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        trompe.main(["stimuli", "make", str(own), str(tmp_path / "set"), "--quick", "--json"])
    assert ended.value.code == 0
    assert '"set": "ball"' in capsys.readouterr().out
    made = load(tmp_path / "set")
    # Recovery: where the light is said to be is where the ball is brightest.
    for stimulus in made.stimuli:
        light = Light(**stimulus.details["lights"][0])
        radiance = luminance(read_channels(made.path(stimulus.truth["radiance"])))
        normal = read_channels(made.path(stimulus.truth["normal"]))
        brightest = normal[radiance > np.quantile(radiance, 0.995)].mean(axis=0)
        assert angle_between_deg(Light.from_direction(brightest), light) < 6


def test_files_that_are_no_sets_are_refused(tmp_path: Path) -> None:
    own = tmp_path / "own.py"
    with pytest.raises(InputError, match=r"own\.py: no such file"):
        maker(str(own))
    own.write_text("x = 1\n", encoding="utf-8")
    with pytest.raises(InputError, match="has no function `make`"):
        maker(str(own))
    own.write_text("def make(folder, *, seed): pass\n", encoding="utf-8")
    with pytest.raises(InputError, match="replicates: not an option of the set"):
        maker(str(own), {"replicates": 2})
