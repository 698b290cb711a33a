import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from algorithms.errors import InputError
from algorithms.files import sha256_of
from stimuli.manifest import MANIFEST_NAME, StimulusSet, load

Edit = Callable[[dict[str, Any]], object]


@pytest.fixture
def copied(drawn_set: StimulusSet, tmp_path: Path) -> StimulusSet:
    """A set whose files may be spoilt."""
    return load(shutil.copytree(drawn_set.folder, tmp_path / "set"))


def rewrite(stimuli: StimulusSet, edit: Edit) -> None:
    """Edit a set's manifest by hand."""
    path = stimuli.folder / MANIFEST_NAME
    manifest = json.loads(path.read_text(encoding="utf-8"))
    edit(manifest)
    path.write_text(json.dumps(manifest), encoding="utf-8")


def test_written_set_is_the_loaded_one(copied: StimulusSet, tmp_path: Path) -> None:
    assert copied.write(tmp_path).folder == tmp_path
    for path in (tmp_path, tmp_path / MANIFEST_NAME):
        assert load(path).model_dump() == copied.model_dump()
        assert load(path).folder == tmp_path
    assert (tmp_path / MANIFEST_NAME).read_bytes() == (copied.folder / MANIFEST_NAME).read_bytes()


def test_digest_is_that_of_the_content(copied: StimulusSet, drawn_set: StimulusSet) -> None:
    assert copied.digest == drawn_set.digest
    rewrite(copied, lambda manifest: manifest.update(seed=manifest["seed"] + 1))
    assert load(copied.folder).digest != drawn_set.digest


def test_copied_set_verifies(copied: StimulusSet) -> None:
    copied.verify()
    assert copied.files["regions.png"] == sha256_of(copied.path("regions.png"))


@pytest.mark.parametrize("which", ["image", "regions"])
def test_missing_file(copied: StimulusSet, which: str) -> None:
    file = copied.stimuli[3].file if which == "image" else "regions.png"
    copied.path(file).unlink()
    with pytest.raises(InputError, match=f"{file}: listed in the set's manifest but missing"):
        copied.verify()


@pytest.mark.parametrize("change", [lambda old: old + b"\0", lambda old: old[:-1], lambda _: b""])
def test_altered_file(copied: StimulusSet, change: Callable[[bytes], bytes]) -> None:
    path = copied.path(copied.stimuli[3].file)
    path.write_bytes(change(path.read_bytes()))
    with pytest.raises(InputError, match=f"{path.name}: altered since the set was made"):
        copied.verify()


def test_exchanged_files(copied: StimulusSet) -> None:
    # Both are files of the set; each holds the other's bytes.
    first, second = (copied.path(stimulus.file) for stimulus in copied.stimuli[:2])
    contents = first.read_bytes(), second.read_bytes()
    first.write_bytes(contents[1])
    second.write_bytes(contents[0])
    with pytest.raises(InputError, match="altered since the set was made"):
        copied.verify()


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (lambda m: m.update(speed=1), "speed: unknown key"),
        (lambda m: m["stimuli"][4].update(size=1), r"stimuli\.4\.size: unknown key"),
        (lambda m: m.pop("seed"), "seed: missing"),
        (lambda m: m.update(stimuli=[]), "stimuli: "),
        (lambda m: m.update(exposure=0), "exposure: "),
        (lambda m: m.update(exposure="bright"), "exposure: "),
        (lambda m: m.update(encoding="gamma"), "encoding: "),
        (lambda m: m.update(format=2), "format: "),
        (lambda m: m["stimuli"][0].update(role="spare"), r"stimuli\.0\.role: "),
        (lambda m: m["stimuli"][1].update(id=m["stimuli"][0]["id"]), "stands twice"),
        (lambda m: m["files"].pop("0003.png"), "'0003.png', used by .* is not listed"),
        (lambda m: m["files"].pop("regions.png"), "'regions.png', used by .* is not listed"),
        (
            lambda m: m["stimuli"][0].update(truth={"depth": "depth.exr"}),
            "'depth.exr', used by .* is not listed",
        ),
        *[
            (lambda m, path=path: m["stimuli"][0].update(file=path), r"stimuli\.0\.file: a path")
            for path in ("../secret.png", "/etc/passwd", "images/../../secret.png", "a\\b", "")
        ],
        (lambda m: m["files"].update({"../secret.png": "0"}), "files.*: a path relative to"),
    ],
)
def test_broken_entry_is_named_in_one_line(copied: StimulusSet, edit: Edit, message: str) -> None:
    rewrite(copied, edit)
    with pytest.raises(InputError, match=message) as caught:
        load(copied.folder)
    assert str(caught.value).startswith(f"{copied.folder / MANIFEST_NAME}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"\xff\xfe", b'"manifest"'])
def test_broken_json(tmp_path: Path, content: bytes) -> None:
    (tmp_path / MANIFEST_NAME).write_bytes(content)
    with pytest.raises(InputError, match=MANIFEST_NAME) as caught:
        load(tmp_path)
    assert "\n" not in str(caught.value)


def test_no_manifest(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cannot be read .*; `trompe stimuli make` makes a set"):
        load(tmp_path)


def test_table_has_a_row_a_stimulus(drawn_set: StimulusSet) -> None:
    table = drawn_set.to_frame()
    assert table["stimulus"].tolist() == [stimulus.id for stimulus in drawn_set.stimuli]
    row = table.iloc[7]
    stimulus = drawn_set[row["stimulus"]]
    assert (row["answer"], row["role"], row["file"]) == (
        stimulus.answer,
        stimulus.role,
        stimulus.file,
    )
    assert {name: row[name] for name in stimulus.factors} == dict(stimulus.factors)


def test_stimuli_by_id_and_role(drawn_set: StimulusSet) -> None:
    assert all(drawn_set[stimulus.id] is stimulus for stimulus in drawn_set.stimuli)
    with pytest.raises(KeyError):
        drawn_set["none"]
    roles = [drawn_set.with_role(role) for role in ("main", "practice", "example")]
    assert sum(roles, ()) == drawn_set.stimuli


def test_set_without_folder_says_so(drawn_set: StimulusSet) -> None:
    loose = StimulusSet.model_validate(drawn_set.model_dump())
    with pytest.raises(InputError, match="this set has no folder yet"):
        loose.path("regions.png")
