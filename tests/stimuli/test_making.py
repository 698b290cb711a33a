"""Folders in which a set is begun, and what they may hold."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from algorithms.errors import InputError
from stimuli.engine import choose_engine
from stimuli.making import Recipe, current_versions, digests, open_set_folder
from stimuli.manifest import StimulusSet
from tests.drawn_set import draw_set

RECIPE = Recipe("drawn", "tests.draw", {"quick": True}, 5, "llvm", {"mitsuba": "3.9.1"})


@pytest.fixture
def begun(tmp_path: Path) -> Path:
    """A folder in which the recipe's set has been begun."""
    folder = tmp_path / "set"
    assert open_set_folder(folder, RECIPE) is None
    return folder


def test_same_recipe_opens_the_folder_again(begun: Path) -> None:
    before = (begun / "recipe.json").read_bytes()
    open_set_folder(begun, RECIPE)
    assert (begun / "recipe.json").read_bytes() == before
    assert json.loads(before)["seed"] == RECIPE.seed


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (replace(RECIPE, seed=6), r"another seed \(5, not 6\)"),
        (replace(RECIPE, engine="scalar"), r"another engine \(llvm, not scalar\)"),
        (replace(RECIPE, parameters={"quick": False}), "another parameters"),
        (replace(RECIPE, versions={"mitsuba": "3.9.2"}), "another versions .*3.9.1.*, not .*3.9.2"),
        (replace(RECIPE, name="texture"), r"another name \(drawn, not texture\)"),
    ],
)
def test_folder_of_another_set_is_refused(begun: Path, other: Recipe, message: str) -> None:
    (begun / "image.png").write_bytes(b"done")
    with pytest.raises(InputError, match=f"holds a set made with {message}") as caught:
        open_set_folder(begun, other)
    assert str(caught.value).startswith(f"{begun}: ")
    assert "\n" not in str(caught.value)
    assert (begun / "image.png").read_bytes() == b"done"


@pytest.mark.parametrize("content", ["", "[]", "null", '"recipe"'])
def test_broken_recipe_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "recipe.json").write_text(content, encoding="utf-8")
    with pytest.raises(InputError, match=r"holds a set made with a broken recipe\.json"):
        open_set_folder(tmp_path, RECIPE)


def test_folder_of_other_things_is_refused(tmp_path: Path) -> None:
    thesis = tmp_path / "thesis.txt"
    thesis.write_text("years of work", encoding="utf-8")
    with pytest.raises(InputError, match="holds other files; choose a new or empty folder"):
        open_set_folder(tmp_path, RECIPE)
    with pytest.raises(InputError, match="not a folder that can be written to"):
        open_set_folder(thesis, RECIPE)
    assert [path.read_text(encoding="utf-8") for path in tmp_path.iterdir()] == ["years of work"]


def test_what_a_killed_writer_left_is_removed(begun: Path) -> None:
    (begun / "images").mkdir()
    for name in ("images/.main-005.png.x7", ".manifest.json.ab", "images/main-004.png"):
        (begun / name).write_bytes(b"half")
    (begun / ".hidden.folder").mkdir()
    open_set_folder(begun, RECIPE)
    names = {path.relative_to(begun).as_posix() for path in begun.rglob("*")}
    assert names == {"recipe.json", "images", "images/main-004.png", ".hidden.folder"}


def test_a_finished_set_is_taken_as_it_is(begun: Path) -> None:
    made: StimulusSet = draw_set(begun)
    assert open_set_folder(begun, RECIPE) == made


def test_altered_files_of_a_finished_set_are_removed(begun: Path) -> None:
    made: StimulusSet = draw_set(begun)
    altered, missing, sound = (made.path(stimulus.file) for stimulus in made.stimuli[:3])
    altered.write_bytes(b"altered")
    missing.unlink()
    assert open_set_folder(begun, RECIPE) is None
    assert (altered.exists(), missing.exists(), sound.exists()) == (False, False, True)


def test_digests_are_those_of_the_manifest(begun: Path) -> None:
    made = draw_set(begun)
    assert digests(begun) == made.files


def test_versions_name_what_renders() -> None:
    versions = current_versions(choose_engine("scalar"))
    assert versions.keys() == {"trompe", "mitsuba", "drjit", "numpy", "pillow"}
    assert versions["mitsuba"].startswith("3.")


@pytest.mark.usefixtures("llvm")
def test_versions_name_the_code_generator() -> None:
    # Other code generators may round otherwise.
    assert current_versions("llvm")["libllvm"]
