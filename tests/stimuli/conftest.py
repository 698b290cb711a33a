"""What the tests of the stimuli share: engines, a rendered set, and a way to render one quickly."""

from collections.abc import Callable
from functools import partial
from itertools import product

import numpy as np
import pytest

from stimuli.camera import View
from stimuli.engine import Engine, choose_engine, engine_report
from stimuli.light_linking import arrangement, linked_set
from stimuli.light_linking.render import Renderer, make_renderer
from stimuli.manifest import StimulusSet
from stimuli.sets import divergence, texture
from tests.conftest import require

QUICK_SEED = 2011


@pytest.fixture
def llvm() -> Engine:
    """The engine of the light-linked integrator."""
    works = {status.name: status.works for status in engine_report()}
    require(works["llvm"], "needs a libLLVM (apt install libllvm19)")
    return choose_engine("llvm")


@pytest.fixture(params=["llvm", "scalar"])
def engine(request: pytest.FixtureRequest) -> Engine:
    """Every engine of the processor in turn."""
    if request.param == "llvm":
        request.getfixturevalue("llvm")
    return choose_engine(request.param)


@pytest.fixture(scope="session")
def quick_set(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """The quick set of experiment 1, rendered by the fastest engine."""
    return divergence.make(tmp_path_factory.mktemp("quick"), seed=QUICK_SEED, quick=True)


@pytest.fixture(scope="session")
def _main_renderer() -> Renderer:
    choose_engine()
    generator = np.random.default_rng([QUICK_SEED, 1])
    return make_renderer(divergence.place_letters(divergence.MAIN_ORDER, generator))


@pytest.fixture
def main_renderer(_main_renderer: Renderer) -> Renderer:
    """The renderer of the quick set's main scene, with its engine set."""
    choose_engine()
    return _main_renderer


@pytest.fixture(scope="session")
def quick_texture_set(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """The quick set of experiment 2, rendered by the fastest engine."""
    return texture.make(tmp_path_factory.mktemp("texture"), seed=QUICK_SEED, quick=True)


@pytest.fixture
def make_tiny(tiny: None) -> Callable[..., StimulusSet]:  # noqa: ARG001
    """Make the quick set of experiment 1 with the real code, tiny."""
    return partial(divergence.make, seed=5, quick=True)


@pytest.fixture
def tiny(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make sets of linked lights from coarse meshes in tiny images."""
    monkeypatch.setattr(arrangement, "_texture_size", lambda _: (8, 16))
    monkeypatch.setattr(arrangement, "_MESH_SIZE", (24, 48))
    view = View(width_px=64, height_px=38, radius_px=6.5, samples=4)
    monkeypatch.setattr(linked_set, "COARSE", view)
    for module, name in product((divergence, texture), ("QUICK", "FULL")):
        monkeypatch.setattr(module, name, view)
