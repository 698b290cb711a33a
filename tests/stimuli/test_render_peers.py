"""Pictures against other renderers: Mitsuba's own path tracer, and one engine against another."""

from dataclasses import replace

import numpy as np
import pytest

from algorithms.light import Light
from stimuli.camera import View
from stimuli.engine import choose_engine
from stimuli.light_linking.render import make_renderer
from stimuli.light_linking.rigs import AMBIENT, KEY_INTENSITY
from tests.stimuli.bodies import of_table
from tests.stimuli.path_tracer import PathTracer

KEY = Light(0, 20, KEY_INTENSITY)


@pytest.mark.usefixtures("llvm")
@pytest.mark.parametrize("letter", ["a", "e"])
def test_agrees_with_the_path_tracer_within_its_noise(letter: str) -> None:
    # Another implementation: the mean of two noisy pictures is as far from the truth as half of
    # their difference; a bias of ours would come on top.
    view = View(width_px=64, height_px=64, radius_px=28, samples=64)
    objects = [of_table(letter)]
    ours = make_renderer(objects).render(view, [(KEY, *AMBIENT)])
    tracer = PathTracer(objects, [KEY, *AMBIENT], view)
    first, second = (tracer.render(samples=512, seed=seed)[0] for seed in (1, 2))
    # Pixels on the edge have the error of their coverage instead.
    whole = ours.coverage == 1
    error = ((first + second) / 2 - ours.radiance)[whole].mean(axis=-1)
    noise = ((first - second) / 2)[whole].mean(axis=-1)
    assert np.sqrt((error**2).mean()) < 1.15 * np.sqrt((noise**2).mean())
    assert abs(error.mean()) < 4 * noise.std() / np.sqrt(whole.sum())


@pytest.mark.usefixtures("llvm")
@pytest.mark.parametrize("distance", [None, 1.6])
def test_engines_agree(distance: float | None) -> None:
    # Another implementation: eight objects at once by our integrator, against one object and one
    # light at a time by Mitsuba's own.
    view = View(width_px=128, height_px=75, radius_px=13, samples=4)
    keys = [KEY, KEY, Light(0, 70, KEY_INTENSITY), KEY]
    rigs = [(replace(key, distance=distance), *AMBIENT) for key in keys]
    pictures = []
    for engine in ("llvm", "scalar"):
        choose_engine(engine)
        objects = [of_table(letter, (3 * i - 3.6, 0)) for i, letter in enumerate("abd")]
        objects.append(of_table("g", (1.2, 2.4)))
        pictures.append(make_renderer(objects).render(view, rigs))
    linked, superposed = pictures
    # A sample on a triangle's edge may fall to either side.
    assert np.sqrt(((linked.radiance - superposed.radiance) ** 2).mean()) < 1e-3
    assert np.sqrt(((linked.shading - superposed.shading) ** 2).mean()) < 1e-3
    assert (linked.coverage != superposed.coverage).mean() < 1e-3
