"""Making the set of experiment 1: same bytes, interruption, and going on."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from algorithms.errors import InputError
from algorithms.images import read_image
from stimuli.engine import Engine
from stimuli.manifest import StimulusSet

Make = Callable[..., StimulusSet]


def contents(folder: Path) -> dict[str, bytes]:
    """Return the bytes of every file of a folder."""
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in paths}


def times_ns(folder: Path) -> dict[str, int]:
    """Return when each image was written."""
    return {path.name: path.stat().st_mtime_ns for path in (folder / "images").iterdir()}


def test_same_seed_same_bytes(make_tiny: Make, tmp_path: Path, engine: Engine) -> None:
    one, two = (make_tiny(tmp_path / name, engine=engine) for name in ("one", "two"))
    assert one.engine == engine
    assert contents(one.folder) == contents(two.folder)
    assert one.digest == two.digest


def test_another_seed_gives_other_objects_and_targets(make_tiny: Make, tmp_path: Path) -> None:
    one, other = (make_tiny(tmp_path / str(seed), engine="scalar", seed=seed) for seed in (5, 6))
    truth = one.stimuli[0].truth["normal"]
    assert one.files[truth] != other.files[truth]
    assert one.to_frame()["target"].tolist() != other.to_frame()["target"].tolist()


@pytest.mark.usefixtures("llvm")
def test_engines_give_the_same_factors_answers_and_nearly_the_same_pixels(
    make_tiny: Make, tmp_path: Path
) -> None:
    linked, superposed = (
        make_tiny(tmp_path / engine, engine=engine) for engine in ("llvm", "scalar")
    )
    assert linked.stimuli == superposed.stimuli
    assert linked.exposure == pytest.approx(superposed.exposure, rel=1e-3)
    for stimulus in linked.stimuli:
        one, other = (read_image(made.path(stimulus.file)) for made in (linked, superposed))
        assert np.sqrt(((one - other) ** 2).mean()) < 3e-3


def test_interrupted_set_goes_on_where_it_was(make_tiny: Make, tmp_path: Path) -> None:
    def interrupt(done: int, _total: int) -> None:
        if done == 5:
            raise KeyboardInterrupt

    begun = tmp_path / "begun"
    with pytest.raises(KeyboardInterrupt):
        make_tiny(begun, engine="scalar", progress=interrupt)
    before = times_ns(begun)
    assert len(before) == 5
    assert not (begun / "manifest.json").exists()

    calls: list[tuple[int, int]] = []
    resumed = make_tiny(begun, engine="scalar", progress=lambda *call: calls.append(call))
    after = times_ns(begun)
    assert {name: after[name] for name in before} == before
    assert calls == [(done, len(after)) for done in range(len(after) + 1)]
    whole = make_tiny(tmp_path / "whole", engine="scalar")
    assert contents(begun) == contents(whole.folder)
    assert resumed.digest == whole.digest


def test_only_what_is_altered_or_missing_is_made_again(make_tiny: Make, tmp_path: Path) -> None:
    made = make_tiny(tmp_path / "set", engine="scalar")
    old, before = contents(made.folder), times_ns(made.folder)
    made.path("images/main-003.png").write_bytes(b"altered")
    made.path("images/main-004.png").unlink()
    made.path("truth/main-regions.png").write_bytes(b"altered")
    make_tiny(made.folder, engine="scalar")
    assert contents(made.folder) == old
    after = times_ns(made.folder)
    redone = {name for name in before if after[name] != before[name]}
    # The ground truth that the images share comes with the first of them.
    assert redone == {"main-000.png", "main-003.png", "main-004.png"}


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"seed": -1}, "seed: -1 given, 0 or more accepted"),
        ({"replicates": 0}, "replicates: 0 given, 1 or more accepted"),
        ({"engine": "fast"}, "engine: 'fast' given, cuda, llvm, scalar accepted"),
    ],
)
def test_wrong_arguments_are_refused_before_the_folder_is_made(
    make_tiny: Make, tmp_path: Path, arguments: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        make_tiny(tmp_path / "set", **arguments)
    assert list(tmp_path.iterdir()) == []
