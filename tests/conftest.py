"""What tests of several rooms share: small stimulus sets, stores, and what may be missing."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from experiments.storage.store import Store
from experiments.study import Study, load_study
from stimuli.manifest import StimulusSet
from tests.drawn_set import draw_set
from tests.postgres import Cluster, programs, running_cluster

# Speed lives in benchmarks; the same examples every time, so that a failure stays one.
settings.register_profile("trompe", deadline=None, derandomize=True)
settings.load_profile("trompe")


def require(present: object, what: str) -> None:
    """Skip a test for what this machine lacks; in CI nothing may be lacking."""
    if not present:
        if os.environ.get("CI") == "true":
            pytest.fail(f"{what}: must be there in CI")
        pytest.skip(what)


@pytest.fixture(scope="session")
def chromium() -> str:
    """The path of the system's Chromium."""
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    require(path, "needs Chromium (apt install chromium)")
    assert path is not None
    return path


@pytest.fixture(scope="session")
def drawn_set(tmp_path_factory: pytest.TempPathFactory) -> StimulusSet:
    """A stimulus set of the form of `divergence`, drawn in a moment instead of rendered."""
    return draw_set(tmp_path_factory.mktemp("drawn"))


@pytest.fixture(scope="session")
def study() -> Study:
    """The ready-made study of experiment 1."""
    return load_study("lights-synthetic")


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    """An empty response store."""
    with Store.open(tmp_path / "responses.sqlite") as opened:
        yield opened


@pytest.fixture(scope="session")
def cluster() -> Iterator[Cluster]:
    """A running PostgreSQL."""
    found = programs()
    require(found, "needs PostgreSQL (apt install postgresql)")
    assert found is not None
    with running_cluster(found) as running:
        yield running


@pytest.fixture
def postgres_url(cluster: Cluster) -> str:
    """The URL of an empty PostgreSQL database."""
    return cluster.new_database()


@pytest.fixture
def write_study(tmp_path: Path) -> Callable[[str, str], Path]:
    """Write the ready-made study with one text replaced by another."""
    source = Path(__file__).parents[1] / "experiments" / "studies" / "lights-synthetic.toml"

    def write(old: str, new: str) -> Path:
        text = source.read_text(encoding="utf-8")
        assert old in text
        path = tmp_path / "study.toml"
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
        return path

    return write
