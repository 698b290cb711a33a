"""Pictures against other renderers: Mitsuba's own path tracer, and one engine against another."""

from collections.abc import Sequence
from typing import Any

import mitsuba as mi
import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.light import Light
from stimuli.engine import choose_engine
from stimuli.render import make_renderer
from stimuli.rigs import AMBIENT, KEY_INTENSITY
from stimuli.scene import View, scene_of
from tests.stimuli.bodies import of_table

KEY = Light(0, 20, KEY_INTENSITY)


def path_traced(
    letter: str, lights: Sequence[Light], view: View, samples: int, seed: int
) -> NDArray[np.float32]:
    """Render an object by Mitsuba's `path` without interreflection, lights chosen at random."""
    emitters = {
        f"light_{number}": {
            "type": "directional",
            "direction": (-light.direction).tolist(),
            "irradiance": {"type": "rgb", "value": light.intensity},
        }
        for number, light in enumerate(lights)
    }
    transform: Any = mi.ScalarTransform4f
    half_width = view.width_px / 2 / view.radius_px
    camera = {
        "type": "orthographic",
        "to_world": transform().look_at(origin=[0, 0, 3], target=[0, 0, 0], up=[0, 1, 0])
        @ transform().scale([half_width, half_width, 1]),
        "film": {
            "type": "hdrfilm",
            "width": view.width_px,
            "height": view.height_px,
            "rfilter": {"type": "box"},
        },
    }
    integrator = {"type": "path", "max_depth": 2, "hide_emitters": True}
    rendered = mi.render(
        mi.load_dict(scene_of([of_table(letter)], [(0, 0)]) | emitters),
        sensor=mi.load_dict(camera),
        integrator=mi.load_dict(integrator),
        spp=samples,
        seed=seed,
    )
    return np.array(rendered)[..., :3]


@pytest.mark.usefixtures("llvm")
@pytest.mark.parametrize("letter", ["a", "e"])
def test_agrees_with_the_path_tracer_within_its_noise(letter: str) -> None:
    # Another implementation: the mean of two noisy pictures is as far from the truth as half of
    # their difference; a bias of ours would come on top.
    view = View(width_px=64, height_px=64, radius_px=28, samples=64)
    ours, coverage = make_renderer([of_table(letter)], AMBIENT).radiance(view, [KEY])
    first, second = (path_traced(letter, [KEY, *AMBIENT], view, 512, seed) for seed in (1, 2))
    # Pixels on the edge have the error of their coverage instead.
    whole = coverage == 1
    error = ((first + second) / 2 - ours)[whole].mean(axis=-1)
    noise = ((first - second) / 2)[whole].mean(axis=-1)
    assert np.sqrt((error**2).mean()) < 1.15 * np.sqrt((noise**2).mean())
    assert abs(error.mean()) < 4 * noise.std() / np.sqrt(whole.sum())


@pytest.mark.usefixtures("llvm")
def test_engines_agree() -> None:
    # Another implementation: eight objects at once by our integrator, against one object and one
    # light at a time by Mitsuba's own.
    view = View(width_px=128, height_px=75, radius_px=13, samples=4)
    keys = [KEY, KEY, Light(0, 70, KEY_INTENSITY), KEY]
    pictures = []
    for engine in ("llvm", "scalar"):
        choose_engine(engine)
        objects = [of_table(letter, (3 * i - 3.6, 0)) for i, letter in enumerate("abd")]
        objects.append(of_table("g", (1.2, 2.4)))
        pictures.append(make_renderer(objects, AMBIENT).radiance(view, keys))
    (linked, linked_coverage), (superposed, superposed_coverage) = pictures
    # A sample on a triangle's edge may fall to either side.
    assert np.sqrt(((linked - superposed) ** 2).mean()) < 1e-3
    assert (linked_coverage != superposed_coverage).mean() < 1e-3
