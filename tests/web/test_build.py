"""The build of the front end, and the wheel that carries it."""

import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from hatch_build import BUNDLE, FRONTEND, STAMP, build_bundle, sources_digest

ROOT = Path(__file__).parents[2]


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A repository with a front end that cannot be built."""
    (tmp_path / FRONTEND / "src").mkdir(parents=True)
    (tmp_path / FRONTEND / "src" / "main.ts").write_text("export {};\n")
    (tmp_path / FRONTEND / "package.json").write_text('{"name": "frontend", "version": "0.1.0"}')
    return tmp_path


@pytest.mark.parametrize("changed", ["src/main.ts", "src/new.ts", "package.json"])
def test_a_changed_source_asks_for_a_new_build(tree: Path, changed: str) -> None:
    before = sources_digest(tree / FRONTEND)
    (tree / FRONTEND / changed).write_text("changed")
    assert sources_digest(tree / FRONTEND) != before


@pytest.mark.parametrize("changed", ["tests/main.test.ts", "node_modules/idb/index.js"])
def test_what_is_no_source_does_not(tree: Path, changed: str) -> None:
    before = sources_digest(tree / FRONTEND)
    path = tree / FRONTEND / changed
    path.parent.mkdir(parents=True)
    path.write_text("changed")
    assert sources_digest(tree / FRONTEND) == before


def test_a_bundle_that_is_up_to_date_is_kept(tree: Path) -> None:
    (tree / BUNDLE).mkdir(parents=True)
    (tree / BUNDLE / STAMP).write_text(sources_digest(tree / FRONTEND))
    assert build_bundle(tree) is False


def test_a_failing_build_says_why_in_one_line_and_leaves_nothing(tree: Path) -> None:
    with pytest.raises(SystemExit) as caught:
        build_bundle(tree)
    said = str(caught.value)
    assert said.startswith("front end: `npm ci --omit=dev` in experiments/web/frontend failed: ")
    assert "\n" not in said
    assert not (tree / BUNDLE).exists()


@pytest.mark.slow
def test_the_wheel_has_the_bundle_and_nothing_that_only_makes_it(tmp_path: Path) -> None:
    # Built from a copy: other tests read the tree meanwhile.
    copy = tmp_path / "tree"
    unneeded = shutil.ignore_patterns(
        ".*cache", ".git", ".venv", "node_modules", "build", "*.sqlite*"
    )
    shutil.copytree(ROOT, copy, ignore=unneeded)
    command = [sys.executable, "-m", "pip", "wheel", ".", "--no-deps", "--no-build-isolation"]
    done = subprocess.run(
        [*command, "--wheel-dir", str(tmp_path)],
        cwd=copy,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    (wheel,) = tmp_path.glob("trompe-*.whl")
    names = zipfile.ZipFile(wheel).namelist()
    tops = {name.split("/")[0] for name in names if ".dist-info" not in name}
    assert tops == {"algorithms", "stimuli", "experiments", "analysis", "trompe.py"}
    bundle = {name.removeprefix("experiments/web/bundle/") for name in names if "/bundle/" in name}
    assert {"index.html", "researcher.html"} <= bundle
    assert any(name.startswith("assets/") and name.endswith(".js") for name in bundle)
    assert "experiments/studies/lights-synthetic.toml" in names
    unwanted = [name for name in names if name.endswith(".ts") or "node_modules" in name]
    assert unwanted == []
